"""Guaranteed bounds: true values inside, exact equilibrium, sharp energies, nested intervals, reasons otherwise."""

from __future__ import annotations

import numpy as np
import pytest

import kshell as ks
from kshell.error.bounds import PlatePair, energy_bounds, probe_bounds
from kshell.error.goals import Goal
from kshell.mesh.mesh import Mesh
from tests.plate.hhj_cases import l_shape, problem, square, whole_edge

SUPPORTED_CENTRE = 0.004062352660675052  # Navier's series
SUPPORTED_ENERGY = 1.70251052472e-3 / 2
CLAMPED_CENTRE = 0.00126531908748
CLAMPED_ENERGY = 3.8912013330e-4 / 2  # HHJ of order 5 on 8 x 8 cells, confirmed by NGSolve
# clamped L, (0, 1)^2 minus (1/2, 1)^2, and its energy on (-1, 1)^2 minus a quadrant: intervals of this method, nested
L_PLACE, L_VALUE, L_UNCERTAIN = (0.25, 0.25), 1.95571370e-4, 5e-8
L_ENERGY = (3.578570071565e-3 / 2, 3.578570071591e-3 / 2)
RHOMBUS_VALUE, RHOMBUS_UNCERTAIN = 1.08226815e-4, 4e-8


def rhombus(n: int, degrees: float = 30.0) -> Mesh:
    """Rhombus of side 1, n x n cells."""
    s = np.linspace(0, 1, n + 1)
    u, v = np.meshgrid(s, s, indexing="ij")
    angle = np.radians(degrees)
    points = np.stack([u + np.cos(angle) * v, np.sin(angle) * v], axis=2).reshape(-1, 2)
    number = np.arange(len(points)).reshape(n + 1, n + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = [np.stack(t, axis=2).reshape(-1, 3) for t in ((a, b, d), (b, c, d))]
    return whole_edge(points, np.concatenate(triangles))


EDGE_LOADED = (
    [ks.Clamped("left")],
    [ks.LineForce("right", (0, 0, 1.0)), ks.LineForce("middle", (0, 0, "y"))],
)
EDGE_SPRUNG = ([ks.Elastic("left", 30.0, "zr"), ks.SimplySupported("right")], [ks.Pressure(1.0)])
CASES = {
    "supported": ([ks.SimplySupported("edge")], [ks.Pressure(1.0)]),
    "clamped": ([ks.Clamped("edge")], [ks.Pressure("1+x*y**2")]),
    "line forces": EDGE_LOADED,
    "edge moments": (
        [ks.SimplySupported("left"), ks.SimplySupported("right")],
        [ks.EdgeMoment("right", 1.0), ks.EdgeMoment("left", "y")],
    ),
    "edge springs": EDGE_SPRUNG,
    "Winkler": ([ks.Elastic("plate", 300.0, "z")], [ks.PointForce((0.5, 0.5, 0), (0, 0, 1.0))]),
    "points": (
        [ks.SimplySupported("left"), ks.Elastic((1.0, 1.0, 0), 5.0, "z"), ks.Fixed((1.0, 0, 0), "z")],
        [ks.Pressure("x")],
    ),
    "symmetry": ([ks.Clamped("left"), ks.Symmetry("right"), ks.SimplySupported("top")], [ks.Pressure(1.0)]),
    "prescribed": (
        [ks.Clamped("left"), ks.Fixed("right", "z", value=(0, 0, "0.01*y**2"))],
        [ks.Pressure(0.1)],
    ),
    "initial curvature": ([ks.Clamped("left")], [ks.InitialCurvature((0.1, 0.2, "0.05*x"))]),
}
ORTHOTROPIC = ks.Orthotropic(E1=25.0, E2=1.0, nu12=0.25, G12=0.5)


def goals(of) -> list[Goal]:
    """One of each kind, the same on all meshes."""
    mesh = of.mesh
    quarter = np.flatnonzero((mesh.points[mesh.triangles, :2].mean(axis=1) < 0.5).all(axis=1))
    middle = mesh.groups["middle"].members
    return [
        Goal.deflection(mesh, (0.5, 0.75)),
        Goal.mean_moment(of, quarter, 0),
        Goal.mean_moment(of, quarter, 2),
        Goal.mean_slope(mesh, quarter, (1.0, 0.5)),
        Goal.mean_deflection(mesh, middle),
        Goal.mean_edge_rotation(mesh, middle),
    ]


@pytest.mark.parametrize("material", [None, ORTHOTROPIC], ids=["isotropic", "orthotropic"])
@pytest.mark.parametrize("name", CASES)
def test_intervals_are_guaranteed_and_overlap_under_refinement(name, material):
    supports, loads = CASES[name]
    found = []
    for n, order in ((4, 3), (4, 4), (8, 4)):
        of = problem(
            square(n, jitter=0.0), supports, loads, **({} if material is None else {"material": material})
        )
        pair = PlatePair(of, order)
        assert pair.primal.imbalance < 1e-8 * pair.primal.norm
        found.append([pair.energy(), *(pair.probe(goal) for goal in goals(of))])
    for level in found:
        assert all(estimate.kind == "guaranteed" and not estimate.why_not for estimate in level)
        assert all(estimate.expected <= estimate.half_width for estimate in level)
    for estimates in zip(*found, strict=True):
        assert max(e.lower for e in estimates) <= min(e.upper for e in estimates)
    # the interval of the finest level is the narrowest
    assert all(c.half_width < a.half_width for a, _, c in zip(*found, strict=True))


VARYING = {
    "steps": lambda x, y, z: np.where(x + 0.3 * y > 0.6, 1.3, 1.0),
    "waves": lambda x, y, z: 1.0 + 0.4 * np.sin(7.0 * x) * np.cos(5.0 * y),
}


@pytest.mark.parametrize("thickness", VARYING)
@pytest.mark.parametrize("n", [3, 8])
def test_the_conforming_side_has_the_stiffness_of_the_plate(thickness, n):
    """Its equations are those that reactions are found by: what is left of them is rounding, however D varies."""
    supports, loads = [ks.Clamped("left"), ks.Elastic("right", 30.0, "zr")], [ks.Pressure("1+x*y**2")]
    of = problem(square(n), supports, loads, thickness=VARYING[thickness])
    conforming = PlatePair(of, 4).conforming
    own, system = conforming.unknowns, of.system
    load = system.load + system.fixed_load
    assert np.linalg.norm(system.matrix @ own - load) < 1e-9 * np.linalg.norm(load)
    assert np.linalg.norm(conforming.forces(own) - load) < 1e-11 * np.linalg.norm(load)


def test_line_forces_and_edge_springs_against_a_fine_solution():
    """True values of a beam-like strip, nu = 0: w = F x^2 (3 - x) / 6 under a force at its end, and k w' = m there."""
    strip = ks.Isotropic(E=12.0, nu=0.0)
    of = problem(square(4), [ks.Clamped("left")], [ks.LineForce("right", (0, 0, 1.0))], material=strip)
    tip = probe_bounds(of, [Goal.deflection(of.mesh, (1.0, 0.5))])[0]
    assert tip.kind == "guaranteed"
    assert abs(tip.value - 1 / 3) <= tip.half_width < 1e-9
    # a support that turns against k = 2 and gives against k = 3: w(1) = 1/3 + 1/2 + 1/3
    of = problem(
        square(4),
        [ks.Elastic("left", 3.0, "z"), ks.Elastic("left", 2.0, "r")],
        [ks.LineForce("right", (0, 0, 1.0))],
        material=strip,
    )
    pair = PlatePair(of)
    tip = pair.probe(Goal.deflection(of.mesh, (1.0, 0.5)))
    assert tip.kind == "guaranteed"
    assert abs(tip.value - (1 / 3 + 1 / 2 + 1 / 3)) <= tip.half_width < 1e-9
    energy = pair.energy()
    assert energy.contains(0.5 * (1 / 3 + 1 / 2 + 1 / 3))


@pytest.mark.parametrize(
    ("support", "energy", "centre"),
    [(ks.SimplySupported, SUPPORTED_ENERGY, SUPPORTED_CENTRE), (ks.Clamped, CLAMPED_ENERGY, CLAMPED_CENTRE)],
)
def test_square_against_series(support, energy, centre):
    """The energy's effectivity, gap over true error in the norm, is below 1.7; the centre lies inside."""
    of = problem(square(4), [support("edge")], [ks.Pressure(1.0)])
    pair = PlatePair(of)
    bounds = pair.energy()
    assert bounds.contains(energy)
    true = energy - bounds.lower  # of the conforming energy
    assert np.sqrt(pair.gap / 2 / true) < 1.7
    probe = pair.probe(Goal.deflection(of.mesh, (0.5, 0.5)))
    assert abs(probe.value - centre) <= probe.half_width + 1e-13
    assert probe.half_width < 2e-3 * centre


def test_clamped_l_shape():
    of = problem(l_shape(8), [ks.Clamped("edge")], [ks.Pressure(1.0)])
    pair = PlatePair(of)
    place = pair.probe(Goal.deflection(of.mesh, L_PLACE))
    assert abs(place.value - L_VALUE) <= place.half_width + L_UNCERTAIN * L_VALUE
    assert place.half_width < 0.03 * L_VALUE
    energy = pair.energy()
    scale = 2.0**-6  # of the energy when lengths are halved
    assert energy.lower <= L_ENERGY[1] * scale
    assert energy.upper >= L_ENERGY[0] * scale
    true = np.mean(L_ENERGY) * scale - energy.lower
    assert np.sqrt(pair.gap / 2 / true) < 1.2


def test_clamped_rhombus():
    mesh = rhombus(8)
    of = problem(mesh, [ks.Clamped("edge")], [ks.Pressure(1.0)])
    centre = probe_bounds(of, [Goal.deflection(mesh, tuple(mesh.points[:, :2].mean(axis=0)))])[0]
    assert abs(centre.value - RHOMBUS_VALUE) <= centre.half_width + RHOMBUS_UNCERTAIN * RHOMBUS_VALUE
    assert centre.half_width < 0.03 * RHOMBUS_VALUE


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("name", ["clamped", "line forces", "edge springs", "Winkler", "points"])
def test_moments_balance_loads_on_all_conforming_functions(name, order):
    """Any order, with the local correction: the residual against all Argyris functions is rounding."""
    supports, loads = CASES[name]
    pair = PlatePair(
        problem(
            square(3, jitter=0.2) if name != "line forces" and name != "Winkler" else square(4),
            supports,
            loads,
        ),
        order,
    )
    exerted = pair.conforming.reduction.T @ pair.primal.difference.equilibrium()
    assert (
        np.abs(pair.primal.residual).max()
        < 1e-11 * np.abs(exerted).max() + 1e-13 * np.abs(pair.problem.system.load).max()
    )


REFUSED = {
    "thickness": dict(thickness="1+x/10"),
    "pressure": dict(loads=[ks.Pressure("sin(x)")]),
    "function": dict(loads=[ks.Pressure(lambda x, y, z: x)]),
    "edge moment": dict(loads=[ks.EdgeMoment("right", "y**5")]),
    "line force": dict(loads=[ks.LineForce("right", (0, 0, "abs(y-0.3)"))]),
    "moment at a point": dict(loads=[ks.PointMoment((1.0, 0.5, 0), (0, 1.0, 0))]),
    "spring": dict(supports=[ks.Clamped("left"), ks.Elastic("right", "1+y", "z")]),
    "prescribed": dict(supports=[ks.Clamped("left"), ks.Fixed("right", "z", value=(0, 0, "sin(y)"))]),
}


@pytest.mark.parametrize("name", REFUSED)
def test_says_which_premise_fails(name):
    change = REFUSED[name]
    of = problem(
        square(2),
        change.get("supports", [ks.Clamped("left")]),
        change.get("loads", [ks.Pressure(1.0)]),
        thickness=change.get("thickness", 1.0),
    )
    found = energy_bounds(of)
    assert found.kind == "estimated"
    assert found.why_not


def test_curved_edges_are_refused():
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    rim = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([[[0.0, 0.0]], rim])
    triangles = np.array([(0, 1 + k, 1 + (k + 1) % 12) for k in range(12)])
    of = problem(whole_edge(points, triangles), [ks.Clamped("edge")], [ks.Pressure(1.0)])
    with pytest.raises(ks.InputError, match="straight edges"):
        PlatePair(of)


def test_a_place_must_be_a_vertex():
    with pytest.raises(ks.InputError, match="no vertex"):
        Goal.deflection(square(2), (0.3, 0.3))


@pytest.mark.parametrize("order", [0, 9])
def test_orders_that_are_not_integrated_exactly_are_refused(order):
    of = problem(square(2), [ks.Clamped("left")], [ks.Pressure(1.0)])
    with pytest.raises(ks.InputError, match="orders from 1 to 8"):
        PlatePair(of, order)
