"""Exponents at corners against the equations of Williams (1952), and what plates have of them."""

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.mesh import Mesh
from kshell.plate.corner_exponents import Star, corner_exponents, least_exponent
from kshell.plate.domain import Domain
from tests.plate.hhj_cases import MATERIAL, problem, square
from tests.plate.plates import disk

NU = 0.3
ISOTROPIC = (1.0, NU, 0.0, NU, 1.0, 0.0, 0.0, 0.0, (1 - NU) / 2)
CLAMPED, SUPPORTED, FREE = (True, True), (True, False), (False, False)


def corner(degrees, first, last, stiffness=ISOTROPIC):
    ends = zip(first, last, strict=True)
    held, turned = ends
    return Star((np.radians(degrees),), held, turned, (stiffness,), False)


def williams(degrees, pair):
    """Left sides of the equations for s, zero at exponents 1 + s."""
    w = np.radians(degrees)
    if pair == (CLAMPED, CLAMPED):
        return lambda s: np.sin(s * w) ** 2 - (s * np.sin(w)) ** 2
    if pair == (CLAMPED, SUPPORTED):
        return lambda s: np.sin(2 * s * w) - s * np.sin(2 * w)
    if pair == (CLAMPED, FREE):
        c = (3 + NU) * (1 - NU)
        return lambda s: c * np.sin(s * w) ** 2 - 4 + ((1 - NU) * s * np.sin(w)) ** 2
    if pair == (SUPPORTED, FREE):
        return lambda s: np.sin(2 * s * w) + s * (1 - NU) / (3 + NU) * np.sin(2 * w)
    return lambda s: np.sin(s * w) ** 2 - (s * (1 - NU) / (3 + NU) * np.sin(w)) ** 2


def least_root(left):
    """The least real part of the roots in (0.02, 0.9999), by Newton's method from many places of the complex plane."""
    s = (np.linspace(0.03, 1.1, 30)[:, None] + 1j * np.linspace(0.0, 1.0, 15)).ravel()
    with np.errstate(all="ignore"):
        for _ in range(60):
            s = s - left(s) * 2e-6 / (left(s + 1e-6) - left(s - 1e-6))
        found = s[(np.abs(left(s)) < 1e-9) & (s.real > 0.02) & (s.real < 0.9999) & (np.abs(s.imag) < 2.0)]
    return found.real.min(initial=1.0)


@pytest.mark.parametrize("degrees", [200.0, 230.0, 270.0, 330.0])
@pytest.mark.parametrize(
    "pair",
    [(CLAMPED, CLAMPED), (CLAMPED, SUPPORTED), (CLAMPED, FREE), (SUPPORTED, FREE), (FREE, FREE)],
    ids=["CC", "CS", "CF", "SF", "FF"],
)
def test_exponents_are_the_least_roots_of_williams(degrees, pair):
    s = least_exponent(corner(degrees, *pair)) - 1.0
    assert s == pytest.approx(least_root(williams(degrees, pair)), abs=1e-6)
    mirrored = corner(degrees, *pair[::-1])
    assert least_exponent(mirrored) == pytest.approx(1.0 + s, abs=1e-7)


def test_right_angles_are_mild_and_changes_on_an_edge_are_not():
    for pair in [(CLAMPED, CLAMPED), (CLAMPED, SUPPORTED), (CLAMPED, FREE), (SUPPORTED, FREE), (FREE, FREE)]:
        assert least_exponent(corner(90, *pair)) == 2.0
    for pair in [(CLAMPED, SUPPORTED), (CLAMPED, FREE), (SUPPORTED, FREE)]:
        assert least_exponent(corner(180, *pair)) == pytest.approx(1.5, abs=1e-6)


def test_orthotropic_corners_are_isotropic_ones_in_stretched_axes():
    """D11 = 16, D22 = 1, D12 + 2 D66 = 4: with x = 2 x' the operator is biharmonic, clamped edges stay clamped."""
    stiffness = (16.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 1.75)
    degrees = 360.0 - np.degrees(np.arctan2(1.0, 1.0))  # from the x axis around to (1, -1)
    stretched = 360.0 - np.degrees(np.arctan2(2.0, 1.0))
    found = least_exponent(corner(degrees, CLAMPED, CLAMPED, tuple(x / 16 for x in stiffness)))
    assert found == pytest.approx(least_exponent(corner(stretched, CLAMPED, CLAMPED)), abs=1e-4)
    assert found != pytest.approx(least_exponent(corner(degrees, CLAMPED, CLAMPED)), abs=1e-3)


def two_supports():
    """A square whose lower edge is clamped on the left half, with a line from its middle up to the centre."""
    mesh = square(4)
    middle = mesh.points[mesh.edges].mean(axis=1)
    x, y = middle[:, 0], middle[:, 1]
    groups = {
        "left half": mesh.edges[(y == 0.0) & (x < 0.5)],
        "line": mesh.edges[(np.abs(x - 0.5) < 1e-12) & (y < 0.5)],
        "rest": mesh.edges[mesh.boundary_edges][~((y == 0.0) & (x < 0.5))[mesh.boundary_edges]],
    }
    groups["plate"] = mesh.triangles
    return Mesh.from_arrays(mesh.points, mesh.triangles, groups)


def named(of):
    return {tuple(np.round(of.mesh.points[v, :2], 9).tolist()): e for v, e in corner_exponents(of).items()}


def test_where_supports_change_and_lines_end():
    mesh = two_supports()
    pressure = [ks.Pressure(1.0)]
    free = problem(mesh, [ks.Clamped("left half")], pressure)
    assert named(free) == pytest.approx({(0.5, 0.0): 1.5}, abs=1e-6)
    supported = problem(mesh, [ks.Clamped("left half"), ks.SimplySupported("rest")], pressure)
    assert named(supported) == pytest.approx({(0.5, 0.0): 1.5}, abs=1e-6)
    tip = problem(
        mesh, [ks.SimplySupported("rest"), ks.SimplySupported("left half"), ks.Clamped("line")], pressure
    )
    assert named(tip) == pytest.approx({(0.5, 0.5): 1.5}, abs=1e-6)


def test_where_the_stiffness_jumps():
    """A soft quarter: the corner inside is singular, straight borders and equal stiffnesses are not."""
    mesh = square(4)
    centre = mesh.points[mesh.triangles].mean(axis=1)
    quarter = (centre[:, 0] > 0.5) & (centre[:, 1] > 0.5)
    groups = {
        "edge": mesh.edges[mesh.boundary_edges],
        "soft": mesh.triangles[quarter],
        "hard": mesh.triangles[~quarter],
    }
    parted = Mesh.from_arrays(mesh.points, mesh.triangles, groups)
    exponents = {}
    for soft in (1.0, 0.5, 0.1):
        of = problem(parted, [ks.Clamped("edge")], [ks.Pressure(1.0)], thickness={"soft": soft, "hard": 1.0})
        exponents[soft] = named(of)
    assert exponents[1.0] == {}
    assert set(exponents[0.5]) >= {(0.5, 0.5)}
    assert exponents[0.1][0.5, 0.5] < exponents[0.5][0.5, 0.5] < 2.0
    # a quarter without stiffness is a re-entrant corner between free edges
    limit = least_exponent(corner(270, FREE, FREE))
    assert abs(exponents[0.1][0.5, 0.5] - limit) < 0.02


def half_clamped_disk() -> Mesh:
    mesh = disk(4)
    edges = mesh.boundary_edges
    upper = mesh.points[mesh.edges[edges], 1].mean(axis=1) > 0.0
    groups = {"clamped": mesh.edges[edges[upper]], "rest": mesh.edges[edges[~upper]]}
    return Mesh.from_arrays(mesh.points, mesh.triangles, groups)


def test_curved_edges_leave_along_their_tangents():
    """Vertices of a rim are no corners; where its support ends it is straight near by."""
    of = problem(half_clamped_disk(), [ks.Clamped("clamped")], [ks.Pressure(1.0)])
    assert named(of) == pytest.approx({(1.0, 0.0): 1.5, (-1.0, 0.0): 1.5}, abs=1e-5)
    rim = problem(disk(4), [ks.SimplySupported("edge")], [ks.Pressure(1.0)])
    assert named(rim) == {}


def test_curved_plates_are_graded_to_a_tolerance():
    """0.0776454: by two elements on meshes graded further."""
    scene = ks.Scene(
        half_clamped_disk(),
        thickness=1.0,
        material=MATERIAL,
        supports=[ks.Clamped("clamped")],
        loads=[ks.Pressure(1.0)],
        probes={"centre": (0.0, 0.0, 0.0)},
    )
    result = ks.solve(scene, tolerance=1e-3, large_deflection=False)
    assert result.error["estimate"] <= 1e-3
    assert result.probes["centre"]["u"][2] == pytest.approx(0.0776454, rel=1e-3)
    assert len(result.error["levels"]) < 4  # 10 without
    rim = result.mesh.points[np.unique(result.mesh.edges[result.mesh.boundary_edges])]
    assert np.hypot(rim[:, 0], rim[:, 1]) == pytest.approx(1.0, abs=1e-9)


def test_exponents_know_no_numbers_and_stay_with_their_domain():
    """Of vertices and triangles in another order; of chords, asked in turn with arcs."""
    mesh, random = two_supports(), np.random.default_rng(0)
    new = random.permutation(len(mesh.points))
    points = np.empty_like(mesh.points)
    points[new] = mesh.points
    groups = {name: new[mesh.edges[mesh.groups[name].members]] for name in ("left half", "line", "rest")}
    other = Mesh.from_arrays(points, new[mesh.triangles[random.permutation(len(mesh.triangles))]], groups)
    supports = [ks.SimplySupported("rest"), ks.SimplySupported("left half"), ks.Clamped("line")]
    found = [named(problem(m, supports, [ks.Pressure(1.0)])) for m in (mesh, other)]
    assert found[0]
    assert found[1] == pytest.approx(found[0], abs=1e-9)
    rim = problem(disk(4), [ks.SimplySupported("edge")], [ks.Pressure(1.0)])
    chords = Domain(rim.mesh, False)
    for _ in range(2):
        assert corner_exponents(rim) == {}
        assert len(corner_exponents(rim, chords)) == 24
