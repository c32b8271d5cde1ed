"""Loads that jump inside triangles: what is missed is told, and about as much as it is."""

import dataclasses
import re

import numpy as np
import pytest

import kshell as ks
from kshell.scene.jump_rules import PARTS, beyond_parts, rules
from kshell.scene.jumps import missed_forces, rough_words
from tests.scene.fabricated import square_mesh

EVERY = np.arange(128)


def told(load):
    return rough_words(load, missed_forces(load, square_mesh(8), EVERY, 2)[0], 2)


@pytest.mark.parametrize(
    "value", [3.0, "1 + x", "sin(pi*x)*sin(pi*y)", "exp(-3*x)", "1*(x > 0.5)", "1/(0.3 + x)"]
)
def test_smooth_loads_and_jumps_along_edges_are_silent(value):
    assert told(ks.Pressure(value)) == ""


@pytest.mark.parametrize(
    "value", ["1*(x > 0.31)", "1*(x > 0.3)*(x < 0.45)*(y > 0.41)", "exp(-8000*((x-0.4)**2+(y-0.4)**2))"]
)
def test_jumps_and_peaks_inside_are_told(value):
    for load in (ks.Pressure(value), ks.Traction((0, value, 0)), ks.Snow(value)):
        words = told(load)
        assert "changes faster inside triangles" in words


@pytest.mark.parametrize("strip", [1e-4, 1e-3, 3e-3, 0.122, 0.124, 0.1249])
def test_jumps_beside_edges_are_about_what_they_add(strip):
    """Of edges 0.125 apart; no rule of the elements has a point in strips narrower than 2e-3."""
    mesh = square_mesh(8)
    share = missed_forces(ks.Pressure(f"1*(x > {0.5 - strip})"), mesh, EVERY, 2)[0]
    missed = min(strip, 0.125 - strip) / (0.5 + strip)
    assert missed / 3.0 < share < 4.0 * missed
    top = mesh.groups["top"].members
    share = missed_forces(ks.LineForce("top", (0, 0, f"1*(x > {0.5 - strip})")), mesh, top, 1)[0]
    assert missed / 3.0 < share < 6.0 * missed


def strip_load(edge):
    """Deflection of the centre of the supported unit square, D = 1, under 1 where x > edge: Navier's series."""
    m, n = np.arange(1, 400)[:, None], np.arange(1, 400, 2)
    load = 4 * (np.cos(m * np.pi * edge) - np.cos(m * np.pi)) / (m * np.pi) * 2 / (n * np.pi)
    shape = np.sin(m * np.pi / 2) * np.sin(n * np.pi / 2)
    return float((load * shape / (np.pi**4 * (m**2 + n**2) ** 2)).sum())


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("options", [{}, {"element": "hhj"}, {"tolerance": 5e-3}])
@pytest.mark.parametrize("edge", [0.499, 0.497, 0.378])
def test_intervals_know_of_jumps_beside_edges(edge, options):
    result = jumping(8, f"1*(x > {edge})", **options)
    stiffness = 210e9 * 0.01**3 / (12 * (1 - 0.3**2))
    half = result.error["probes"]["centre"]["u"]["half_width"][2]
    assert abs(result.probes["centre"]["u"][2] - strip_load(edge) / stiffness) <= half
    assert result.error["estimate"] <= options.get("tolerance", 0.1)


def test_what_is_told_is_about_what_is_missed():
    scene = ks.Scene(
        mesh=square_mesh(8),
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.SimplySupported(["left", "right", "bottom", "top"])],
        loads=[ks.Pressure("1*(x > 0.31)*(y > 0.43)")],
    )
    result = ks.solve(scene, large_deflection=False, error="off")
    (words,) = [words for words in result.warnings if "inside triangles" in words]
    told = float(re.search(r"about ([\d.e-]+) %", words)[1]) / 100
    total = -sum(reaction["force"][2] for reaction in result.reactions.values())
    missed = abs(total / (0.69 * 0.57) - 1)
    assert missed < 5 * told
    assert told < 0.2


def test_loads_in_time_and_of_heat_are_left_alone():
    assert told(ks.Temperature(gradient="1*(x > 0.31)", expansion=1e-5)) == ""
    assert told(ks.Pressure("0*x")) == ""


def test_line_loads_that_jump_inside_edges_are_told():
    mesh = square_mesh(8)
    load = ks.LineForce("top", (0, 0, "1*(x > 0.42)"))
    share, of_edges = missed_forces(load, mesh, mesh.groups["top"].members, 1)
    assert 0.01 < share < 0.2
    assert np.count_nonzero(of_edges) == 1
    assert "inside edges" in rough_words(load, share, 1)
    assert missed_forces(ks.LineForce("top", (0, 0, "exp(x)")), mesh, mesh.groups["top"].members, 1)[0] == 0.0


def jumping(n, value, **options):
    scene = ks.Scene(
        mesh=square_mesh(n),
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.SimplySupported(["left", "right", "bottom", "top"])],
        loads=[ks.Pressure(value)],
        probes={"centre": (0.5, 0.5, 0)},
    )
    return ks.solve(scene, large_deflection=False, **options)


JUMP, ALIGNED = (
    "1*(x > 0.31)*(y > 0.43)",
    1.975481e-3,
)  # w D of the unit square, by two elements on graded meshes


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize(
    ("n", "options"),
    [
        (3, {}),
        (5, {}),
        (4, {"element": "morley"}),
        (4, {"tolerance": 1e-2}),
        (4, {"element": "hhj", "tolerance": 2e-2}),
    ],
)
def test_intervals_know_what_is_missed(n, options):
    """Without the share of the loads some of these intervals are 100 times too narrow."""
    result = jumping(n, JUMP, **options)
    stiffness = 210e9 * 0.01**3 / (12 * (1 - 0.3**2))
    found = result.error["probes"]["centre"]["u"]
    assert found["kind"] == "estimated"
    assert abs(result.probes["centre"]["u"][2] * stiffness - ALIGNED) <= found["half_width"][2] * stiffness
    assert result.error["budget"]["loads"] > 0.0
    if "tolerance" in options:
        assert result.error["estimate"] <= options["tolerance"]


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
def test_a_load_that_cannot_be_integrated_is_not_known():
    result = jumping(8, "1/(x - 0.6)")
    assert result.error["estimate"] > 0.5
    assert jumping(8, "1/(x + 0.6)").error["estimate"] < 0.01


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("options", [{}, {"tolerance": 6e-3}])
def test_springs_that_jump_inside_triangles_are_as_loads_are(options):
    """2.905896e-4 on a mesh whose edges lie along the jump; the interval was 4e-4 wide, 6e-3 away from it."""
    scene = ks.Scene(
        mesh=square_mesh(8),
        thickness=1.0,
        material=ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3),
        supports=[
            ks.SimplySupported(["left", "right", "bottom", "top"]),
            ks.Elastic("plate", stiffness="5000*(x > 0.31)"),
        ],
        loads=[ks.Pressure(1.0)],
        probes={"centre": (0.5, 0.5, 0)},
    )
    result = ks.solve(scene, large_deflection=False, **options)
    off = abs(result.probes["centre"]["u"][2] - 2.905896e-4)
    assert off <= result.error["probes"]["centre"]["u"]["half_width"][2]
    assert result.error["estimate"] < 0.1
    if options:
        assert result.error["estimate"] <= 6e-3
    else:
        assert any("elastic" in words and "inside triangles" in words for words in result.warnings)


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("element", ["argyris", "hhj", "morley"])
@pytest.mark.parametrize("left", [1e-1, 1e-3, -1e-4])
def test_loads_that_nearly_cancel_are_missed_as_if_alone(element, left):
    """What is left of the deflection is less than what is missed of each load."""
    whole, part = strip_load(0.0), strip_load(0.41)
    against = -(1.0 - left) * part / whole
    scene = ks.Scene(
        mesh=square_mesh(6),
        thickness=1.0,
        material=ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3),
        supports=[ks.SimplySupported(["left", "right", "bottom", "top"])],
        loads=[ks.Pressure("1*(x > 0.41)"), ks.Pressure(against)],
        probes={"centre": (0.5, 0.5, 0)},
    )
    result = ks.solve(scene, large_deflection=False, element=element)
    half = result.error["probes"]["centre"]["u"]["half_width"][2]
    assert abs(result.probes["centre"]["u"][2] - left * part) <= half < part
    alone = ks.solve(
        dataclasses.replace(scene, loads=scene.loads[:1]), large_deflection=False, element=element
    )
    assert half <= 3.0 * alone.error["probes"]["centre"]["u"]["half_width"][2]


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("waves", [7, 41, 61])
def test_waves_that_a_mesh_does_not_see(waves):
    """61 half waves on 8 edges move the plate of the mesh by 10,000 times as much as they should."""
    result = jumping(8, f"sin({waves}*pi*x)*sin(pi*y)")
    stiffness = 210e9 * 0.01**3 / (12 * (1 - 0.3**2))
    true = np.sin(waves * np.pi / 2) / (np.pi**4 * (waves**2 + 1) ** 2) / stiffness
    off = abs(result.probes["centre"]["u"][2] - true)
    assert off <= result.error["probes"]["centre"]["u"]["half_width"][2]


def rough_share(text, n, words_only):
    mesh = square_mesh(n)
    return missed_forces(ks.Pressure(text), mesh, np.arange(2 * n * n), 2, words_only=words_only)[0]


@pytest.mark.parametrize(
    "text",
    [
        "exp(x)*cos(3*y)",
        "sin(3*x)*sin(3*y)",
        "sin(pi*8*x)*sin(pi*8*y) + 0.2",
        "exp(-8000*((x-0.4)**2+(y-0.4)**2))",
        "1 + exp(-3000*((x-0.52)**2+(y-0.47)**2))",
        "1 + 1e-3*cos(200*x)",
        "1 + 0.1*exp(-(x/0.1)**2)",
        "1*(x > 0.31)",
        "sinh(4*x - 2)",
    ],
)
@pytest.mark.parametrize("n", [1, 2, 8])
def test_words_alone_are_those_of_a_full_look(text, n):
    """Nothing that is worth a word hides: what parts may miss of a smooth formula is bounded."""
    full, words = rough_share(text, n, False), rough_share(text, n, True)
    assert abs(full - words) <= 1e-3
    said = [rough_words(ks.Pressure(text), share, 2) for share in (full, words)]
    assert bool(said[0]) == bool(said[1])


@pytest.mark.parametrize("k", [2, 3])
@pytest.mark.parametrize(
    "text", ["exp(x)*cos(3*y)", "sin(6*x + 1)", "exp(-9*((x-0.3)**2+y**2))", "x**7", "x**6*0"]
)
def test_what_parts_miss_is_bounded(k, text):
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.4, 0.8, 0.0]])[:k]
    _, parts, fine = rules(k)
    value = ks.Pressure(text)
    exact, found = (
        float(shares @ value.at(places @ corners)) for places, shares in (rule_of(fine, k), parts)
    )
    assert abs(exact - found) <= float(beyond_parts(text, corners[None])[0]) * (1 + 1e-9) + 1e-15


def rule_of(rule, k):
    """The rule on the parts of parts of each part."""
    places, shares = rule
    for _ in range(2):
        places = np.einsum("qk,pkb->pqb", places, PARTS[k]).reshape(-1, k)
        shares = np.tile(shares, 4) / 4
    return places, shares


def test_tolerances_know_in_full_what_is_missed_with_errors_off():
    """Errors of a tolerance count it, whether others are asked for or not."""
    scene = ks.Scene(
        mesh=square_mesh(2),
        material=ks.Isotropic(1e4, 0.3),
        thickness=0.1,
        supports=[ks.Clamped("top")],
        loads=[ks.Pressure("exp(x)*cos(3*y)")],
    )
    asked = [ks.solve(scene, tolerance=0.05, error=error).error for error in ("auto", "off")]
    assert asked[0]["budget"] == asked[1]["budget"]
