"""Derivatives of the displacement that jump across lines inside a chart."""

import dataclasses
import warnings
from itertools import pairwise

import numpy as np
import pytest

import kshell as ks
from kshell.shell.chart.discretisation import ArgyrisDiscretisation
from kshell.shell.chart.nodes import Nodes
from tests.plate.plates import disk
from tests.plate.test_jumps import halves, levy

PLANE = ks.geometry.Plane()


def strip(load, wobble=0.2, **changes):
    """A cantilever strip of two thicknesses, nu = 0: E t = 2400 and 1200, D = 8 and 1."""
    scene = {
        "mesh": halves(8, 2, 2.0, 0.5, wobble),
        "chart": PLANE,
        "thickness": {"A": 0.2, "B": 0.1},
        "material": ks.Isotropic(E=12e3, nu=0.0),
        "supports": [ks.Clamped("left")],
        "loads": [ks.LineForce("right", load)],
        "probes": {"tip": (2, 0.25, 0), "A": (1 - 1e-6, 0.25, 0), "B": (1 + 1e-6, 0.25, 0)},
        "solve": {"large_deflection": False},
    }
    return ks.Scene(**(scene | changes))


def scene(mesh, **changes):
    """A square of thickness 0.1 on a plane chart, D = 1 with nu = 0.3."""
    material = ks.Isotropic(E=12e3 * (1 - 0.3**2), nu=0.3)
    given = {"mesh": mesh, "chart": PLANE, "thickness": 0.1, "material": material}
    return ks.Scene(**(given | {"solve": {"large_deflection": False}} | changes))


@pytest.mark.parametrize("element", ["argyris", "koiter"])
def test_a_step_of_thickness_bends_and_stretches_as_by_statics(element):
    for load, key, tip, expected in (
        ((0, 0, 1e-3), "M", 2, 1e-3 * (1 / 3 + 7 / 24)),
        ((1.0, 0, 0), "N", 0, 1 / 2400 + 1 / 1200),
    ):
        result = ks.solve(strip(load), element=element)
        assert result.probe("tip")["u"][tip] == pytest.approx(expected, rel=1e-8)
        size = -1e-3 if key == "M" else 1.0
        for side in "AB":
            assert result.probe(side)[key][0] == pytest.approx(size, rel=2e-6)
        assert result.balance < 1e-9
        assert result.reactions["left"]["force"] == pytest.approx(-0.5 * np.array(load), abs=1e-12)
        assert result.external_work == pytest.approx(result.strain_energy, rel=1e-9)


def test_auto_has_argyris_elements_for_small_deflections_and_koiter_for_large_ones():
    small = ks.solve(strip((0, 0, 1e-6)), large_deflection="auto")
    assert small.model["element"] == "argyris"
    assert not small.model["large_deflection"]
    assert not [words for words in small.warnings if "lines inside" in words]
    large = ks.solve(strip((0, 0, 1.0)), large_deflection="auto")
    assert large.model["element"] == "koiter"
    assert large.model["large_deflection"]
    assert any("for small deflections only" in words for words in large.model["reasons"])
    asked = ks.solve(strip((0, 0, 1.0)), large_deflection=True)
    assert asked.model["element"] == "koiter"
    assert asked.probe("tip")["u"] == pytest.approx(large.probe("tip")["u"], rel=1e-6)


@pytest.mark.parametrize("options", [{"large_deflection": True}, {"analysis": "buckling"}])
def test_argyris_elements_asked_for_are_refused_beyond_small_deflections(options):
    with pytest.raises(ks.InputError, match=r"small deflections only.*take element = \"koiter\""):
        ks.solve(strip((0, 0, 1e-3)), element="argyris", **{"large_deflection": "auto", **options})


def test_argyris_elements_asked_for_say_that_the_answer_is_linear():
    with pytest.warns(ks.KshellWarning, match="the answer is linear all the same"):
        result = ks.solve(strip((0, 0, 1.0)), element="argyris", large_deflection="auto")
    assert result.probe("tip")["u"][2] == pytest.approx(1 / 3 + 7 / 24, rel=1e-8)


def test_modes_of_a_stepped_strip():
    found = [
        ks.modes(
            strip((0, 0, 1.0), material=ks.Isotropic(E=12e3, nu=0.0, density=1.0)), count=3, element=name
        )
        for name in ("argyris", "koiter")
    ]
    values = [[mode["value"] for mode in result.eigen] for result in found]
    assert values[0] == pytest.approx(values[1], rel=3e-4)


def test_a_supported_edge_that_meets_the_step():
    probes = {"a": (0.25, 0.5, 0), "c": (0.5, 0.5, 0), "b": (0.75, 0.5, 0)}
    edges = [ks.SimplySupported("edge")]
    given = scene(
        halves(8, wobble=0.1),
        thickness={"A": 0.1, "B": 0.05},
        supports=edges,
        loads=[ks.Pressure(1.0)],
        probes=probes,
    )
    result = ks.solve(given)
    assert result.model["element"] == "argyris"
    for name, (x, y, _) in probes.items():
        assert result.probe(name)["u"][2] == pytest.approx(levy(x, y, (1.0, 0.125)), rel=5e-7)


def test_free_curvatures_of_overlapping_parts_leave_no_forces():
    """They fit together: M = 0 beside lines that cross."""
    corner = [ks.Fixed((0, 0, 0), "xyz"), ks.Fixed((1, 0, 0), "yz"), ks.Fixed((0, 1, 0), "z")]
    loads = [ks.InitialCurvature((-0.1, 0, 0), "B"), ks.InitialCurvature((0, -0.2, 0), "above")]
    result = ks.solve(scene(halves(4), supports=corner, loads=loads))
    assert result.model["element"] == "argyris"
    x, y = result.points[:, :2].T
    expected = (
        -0.1 * np.maximum(x - 0.5, 0) ** 2 / 2 - 0.1 * np.maximum(y - 0.5, 0) ** 2 + 0.1 * (x / 8 + y / 4)
    )
    assert np.allclose(result.fields["displacement"][:, 2], expected, atol=1e-12)
    assert np.abs(result.fields["moment"]).max() < 1e-9


@pytest.mark.parametrize("support", [ks.Clamped("middle"), ks.Clamped("B")], ids=["line", "half"])
def test_a_clamped_line_keeps_one_side_from_the_other(support):
    """Supported on three sides, clamped on the fourth, 1/2 x 1; the other half at rest."""
    probes = {"left": (0.25, 0.5, 0), "right": (0.75, 0.5, 0)}
    supports = [ks.SimplySupported("edge"), support]
    result = ks.solve(scene(halves(8), supports=supports, loads=[ks.Pressure(1.0, "A")], probes=probes))
    assert result.model["element"] == "argyris"
    assert result.probe("left")["u"][2] == pytest.approx(3.0490730e-4, rel=1e-6)
    assert np.abs(result.fields["displacement"][result.points[:, 0] > 0.5]).max() < 1e-15
    assert result.balance < 1e-10


CYLINDER, SPHERE = ks.geometry.Cylinder(R=1.0), ks.geometry.Sphere(R=1.0)


def curved(chart, n, ranges, **changes):
    """A patch of a chart with groups A and B in halves along the first parameter."""
    (u0, u1), (v0, v1) = ranges
    flat = halves(n, n, u1 - u0, v1 - v0)
    groups = {
        name: (flat.edges if group.dimension == 1 else flat.triangles)[group.members]
        for name, group in flat.groups.items()
    }
    mesh = ks.Mesh.from_arrays(flat.points + [u0, v0, 0], flat.triangles, groups)
    material = ks.Isotropic(E=1e3, nu=0.3)
    at = chart.at(u0 + 0.3 * (u1 - u0), v0 + 0.6 * (v1 - v0)).point
    given = {
        "mesh": mesh,
        "chart": chart,
        "thickness": 0.05,
        "material": material,
        "loads": [ks.Pressure(1e-3)],
    }
    given |= {"probes": {"p": tuple(at)}, "solve": {"large_deflection": False, "error": "off"}}
    return ks.Scene(**(given | changes))


ON_CHARTS = {
    "step along a generator": (CYLINDER, ((0, 1.2), (0, 1.0)), {"thickness": {"A": 0.05, "B": 0.03}}),
    "step on a sphere": (SPHERE, ((0.2, 1.2), (0.3, 1.2)), {"thickness": {"A": 0.05, "B": 0.03}}),
    "clamped line": (CYLINDER, ((0, 1.2), (0, 1.0)), {"supports": [ks.Clamped("bottom"), ks.Clamped("middle")]}),
    "line without translations": (
        SPHERE, ((0.2, 1.2), (0.3, 1.2)), {"supports": [ks.Clamped("bottom"), ks.SimplySupported("middle")]},
    ),
    "line without rotation": (
        CYLINDER, ((0, 1.2), (0, 1.0)), {"supports": [ks.Clamped("bottom"), ks.Fixed("middle", "r")]},
    ),
    "part held": (
        CYLINDER, ((0, 1.2), (0, 1.0)), {"supports": [ks.Clamped("bottom"), ks.Fixed("B", "z")]},
    ),
    "heated half": (
        CYLINDER, ((0, 1.2), (0, 1.0)),
        {"loads": [ks.Temperature(mean=10, gradient=100, expansion=1e-5, on="B")]},
    ),
    "line force": (CYLINDER, ((0, 1.2), (0, 1.0)), {"loads": [ks.LineForce("middle", (1e-3, 2e-3, 0))]}),
}  # fmt: skip


QUICK = ("step along a generator", "line without translations")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in QUICK else pytest.mark.full) for name in ON_CHARTS]
)
def test_lines_on_curved_charts_are_as_with_koiter_elements(name):
    """Cubics on 12 cells are nearer to the limit than quintics on 8 in about half of the cases."""
    chart, ranges, changes = ON_CHARTS[name]
    changes = {"supports": [ks.Clamped("bottom")], **changes}
    quintic = ks.solve(curved(chart, 8, ranges, **changes))
    assert quintic.model["element"] == "argyris"
    cubic = ks.solve(curved(chart, 12, ranges, **changes), element="koiter")
    assert quintic.strain_energy == pytest.approx(cubic.strain_energy, rel=4e-3)
    u = [result.probe("p")["u"] for result in (quintic, cubic)]
    np.testing.assert_allclose(u[0], u[1], atol=4e-3 * np.abs(u[1]).max())
    assert quintic.balance < 1e-7
    for label, entry in quintic.reactions.items():
        size = max(np.abs(r["force"]).max() for r in cubic.reactions.values())
        if size > 1e-12:
            np.testing.assert_allclose(entry["force"], cubic.reactions[label]["force"], atol=2e-2 * size)


def stepped_annulus(a, r0, b, stiffness, nu=0.3):
    """w(b) and M_r(r0) of an annulus clamped at a, free at b, of stiffness D inside and outside r0, pressure 1.

    w = c0 + c1 r^2 + c2 ln r + c3 r^2 ln r + r^4 / 64 D on either side; w, w', M_r and the shear force go on.
    """

    def rows(r):  # w, w', M_r / -D, Q / -D
        log = np.log(r)
        first = np.array([0, 2 * r, 1 / r, 2 * r * log + r])
        second = np.array([0, 2, -1 / r**2, 2 * log + 3])
        shear = np.array([0, 0, 2 / r**3, 2 / r]) + second / r - first / r**2
        return np.array([[1, r**2, log, r**2 * log], first, second + nu * first / r, shear])

    def particular(r):
        return np.array([r**4 / 64, r**3 / 16, (3 + nu) * r**2 / 16, r / 2])

    system, right = np.zeros((8, 8)), np.zeros(8)
    system[:2, :4], right[:2] = rows(a)[:2], -particular(a)[:2] / stiffness[0]
    scale = np.array([[1, 1, d, d] for d in stiffness])
    system[2:6, :4], system[2:6, 4:] = scale[0][:, None] * rows(r0), -scale[1][:, None] * rows(r0)
    right[2:6] = (scale[1] / stiffness[1] - scale[0] / stiffness[0]) * particular(r0)
    system[6:, 4:], right[6:] = rows(b)[2:], -particular(b)[2:] / stiffness[1]
    c = np.linalg.solve(system, right)[4:]
    tip = rows(b)[0] @ c + particular(b)[0] / stiffness[1]
    return tip, -(stiffness[1] * (rows(r0)[2] @ c) + particular(r0)[2])


def test_a_step_along_a_circle():
    """Polar parameters: the step is straight in their plane and follows its circle."""
    polar = ks.geometry.Chart.from_expressions("u*cos(v)", "u*sin(v)", "0*u")
    tip, moment = stepped_annulus(0.5, 0.75, 1.0, (1.0, 0.125))
    result = ks.solve(
        curved(
            polar,
            4,
            ((0.5, 1.0), (0, 0.8)),
            thickness={"A": 0.1, "B": 0.05},
            material=ks.Isotropic(E=12e3 * (1 - 0.3**2), nu=0.3),
            supports=[ks.Clamped("left"), ks.Symmetry("bottom"), ks.Symmetry("top")],
            loads=[ks.Pressure(1.0)],
            probes={"tip": (1, 0, 0), "A": (0.75 - 1e-7, 0, 0), "B": (0.75 + 1e-7, 0, 0)},
        )
    )
    assert result.model["element"] == "argyris"
    assert result.probe("tip")["u"][2] == pytest.approx(tip, rel=3e-7)
    for side in "AB":
        assert result.probe(side)["M"][0] == pytest.approx(moment, rel=1e-3)


@pytest.mark.parametrize("large", [False, True], ids=["small", "large"])
def test_hinges_transmit_no_moment(large):
    supports = [ks.Clamped("left"), ks.SimplySupported("right"), ks.Hinge("middle")]
    given = scene(
        halves(8),
        thickness=0.05,
        supports=supports,
        loads=[ks.Traction((0, 0, 0.3))],
        probes={"a": (0.5, 0.5, 0), "b": (0.3, 0.4, 0)},
        solve={"large_deflection": large, "error": "off"},
    )
    quintic, cubic = ks.solve(given), ks.solve(given, element="koiter")
    assert quintic.model["element"] == "argyris"
    assert quintic.model["large_deflection"] is large
    for name in "ab":
        assert quintic.probe(name)["u"] == pytest.approx(cubic.probe(name)["u"], rel=3e-3, abs=1e-5)
    assert abs(quintic.probe("a")["M"][0]) < 1e-3 * abs(quintic.probe("b")["M"][0])
    with pytest.raises(ks.InputError, match="can move freely"):
        ks.solve(dataclasses.replace(given, supports=[supports[0], supports[2]]), large_deflection=False)


def with_wall(n, points):
    """A square with a line through vertices, group wall."""
    flat = halves(n)
    near = [int(np.argmin(np.linalg.norm(flat.points[:, :2] - p, axis=1))) for p in points]
    groups = {name: flat.edges[g.members] for name, g in flat.groups.items() if g.dimension == 1}
    return ks.Mesh.from_arrays(flat.points, flat.triangles, groups | {"wall": list(pairwise(near))})


# energies extrapolated from both elements and 64 cells
@pytest.mark.parametrize(
    ("line", "energy"),
    [
        ([(0.25, 0.5), (0.375, 0.5), (0.5, 0.5)], 1.0956e-4),
        ([(0.5, 0.25), (0.5, 0.375), (0.5, 0.5), (0.375, 0.5), (0.25, 0.5)], 8.102e-5),
    ],
    ids=["end", "corner"],
)
def test_lines_that_end_or_turn_are_no_worse_than_with_cubic_koiter_elements_and_said(line, energy):
    mesh = with_wall(8, line)
    given = scene(mesh, supports=[ks.SimplySupported("edge"), ks.Clamped("wall")], loads=[ks.Pressure(1.0)])
    with pytest.warns(ks.KshellWarning, match="end, turn or branch"):
        quintic = ks.solve(given, error="off")
    assert quintic.model["element"] == "argyris"
    cubic = ks.solve(given, element="koiter", error="off")
    assert abs(quintic.strain_energy - energy) < abs(cubic.strain_energy - energy)


def test_a_support_ends_where_a_load_goes_on():
    """The line of the load is straight through the end of the support, which is one all the same."""
    flat = with_wall(8, [(0.5, 0.0), (0.5, 0.125), (0.5, 0.25), (0.5, 0.375), (0.5, 0.5)])
    groups = {
        n: (flat.edges if g.dimension == 1 else flat.triangles)[g.members] for n, g in flat.groups.items()
    }
    mesh = ks.Mesh.from_arrays(flat.points * [1.2, 1, 1], flat.triangles, groups)
    supports = [ks.Clamped("left"), ks.SimplySupported("wall")]
    loads = [ks.Traction((1e-3, 2e-3, 1e-3)), ks.LineForce("middle", (1e-3, 0, 0))]
    given = scene(mesh, chart=CYLINDER, thickness=0.05, supports=supports, loads=loads)
    with pytest.warns(ks.KshellWarning, match="end, turn or branch"):
        quintic = ks.solve(given, error="off", element="argyris")
    cubic = ks.solve(given, error="off", element="koiter")
    # from below and from above
    assert 0.9 * cubic.strain_energy < quintic.strain_energy < cubic.strain_energy


@pytest.mark.full
def test_a_patch_inside_and_where_lines_branch():
    """A hot quarter beside a step: lines end on another; both elements agree about the whole."""
    mesh = halves(8)
    centre = mesh.points[mesh.triangles].mean(axis=1)
    quarter = mesh.triangles[(centre[:, 0] < 0.5) & (centre[:, 1] < 0.5)]
    groups = {
        n: (mesh.edges if g.dimension == 1 else mesh.triangles)[g.members] for n, g in mesh.groups.items()
    }
    mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups | {"hot": quarter})
    loads = [ks.Traction((1e-2, 0, 1e-3)), ks.Temperature(mean=10, expansion=1e-5, on="hot")]
    given = scene(mesh, thickness={"A": 0.1, "B": 0.06}, supports=[ks.Clamped("left")], loads=loads)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = [ks.solve(given, element=name).strain_energy for name in ("argyris", "koiter")]
    assert found[0] == pytest.approx(found[1], rel=2e-3)


def test_curved_edges_in_the_parameters_are_koiter_for_auto():
    given = scene(
        disk(2, 2), supports=[ks.Clamped("edge")], loads=[ks.Pressure(1.0)], probes={"c": (0, 0, 0)}
    )
    result = ks.solve(given)
    assert result.model["element"] == "koiter"
    assert result.probe("c")["u"][2] == pytest.approx(1 / 64, rel=1e-2)
    with pytest.raises(ks.InputError, match="edges of the parameter mesh are curved"):
        ks.solve(given, element="argyris")


@pytest.mark.full
def test_a_line_curved_in_the_parameters_is_said():
    mesh = halves(8)
    points = mesh.points.copy()
    points[:, 0] += 0.3 * points[:, 0] * (1 - points[:, 0]) * (points[:, 1] - 0.5) ** 2
    groups = {
        n: (mesh.edges if g.dimension == 1 else mesh.triangles)[g.members] for n, g in mesh.groups.items()
    }
    mesh = ks.Mesh.from_arrays(points, mesh.triangles, groups)
    given = scene(
        mesh, thickness={"A": 0.1, "B": 0.06}, supports=[ks.Clamped("left")], loads=[ks.Traction((1, 0, 1))]
    )
    with pytest.warns(ks.KshellWarning, match="curved in the plane of the parameters"):
        quintic = ks.solve(given)
    assert quintic.model["element"] == "argyris"
    cubic = ks.solve(given, element="koiter")
    assert quintic.strain_energy == pytest.approx(cubic.strain_energy, rel=3e-3)


def test_nodes_are_numbered_without_gaps_and_rigid_motions_are_tied():
    mesh = with_wall(4, [(0.25, 0.5), (0.5, 0.5), (0.5, 0.75), (0.5, 1.0)])
    lines = np.zeros(len(mesh.edges), dtype=bool)
    lines[mesh.groups["wall"].members] = True
    nodes = Nodes(mesh, lines)
    assert len(nodes.ends) == 2
    assert np.array_equal(np.unique(nodes.triangle_scalars), np.arange(nodes.scalars))
    discretisation = ArgyrisDiscretisation(mesh, CYLINDER, lines)
    basis = discretisation.conditions().reduction().basis.toarray()
    motions = discretisation.rigid_motions(np.zeros(3), 1.0)
    left = motions - basis @ np.linalg.lstsq(basis, motions, rcond=None)[0]
    assert np.abs(left).max() < 1e-9 * np.abs(motions).max()
