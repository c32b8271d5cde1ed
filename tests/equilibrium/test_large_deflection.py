"""Large deflections: elastica, roll-up, Sze, Liu & Lo (2004), limit points, follower pressure."""

import numpy as np
import pytest

from kshell.equilibrium.load_steps import load_path
from kshell.equilibrium.path import PathFollower, follow
from kshell.equilibrium.problem import Problem
from kshell.errors import SolveError
from kshell.geometry import Chart
from kshell.shell.chart import loads as chart_loads
from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.chart.supports import ChartSupports
from kshell.shell.chart.surface import ChartSurface
from kshell.shell.koiter import loads
from kshell.shell.section import Section
from tests.shell.shapes import Model, cylinder, rectangle, sphere


def cantilever(order, n, load, width=1.0, length=10.0, section=None):
    section = section or Section.isotropic(1.2e6, 0.0, 0.1)
    model = Model(rectangle(n, 1, 0, length, 0, width), order, section)
    model.supports.clamp(model.edges(0, 0.0))
    return model, Problem(model.koiter, model.reduction(), load(model.surface, model.edges(0, length)))


@pytest.mark.parametrize(("order", "n", "tolerance"), [(1, 32, 4e-3), (2, 8, 2e-4), (3, 8, 1e-4)])
def test_cantilever_under_end_shear_in_one_step(order, n, tolerance):
    model, problem = cantilever(order, n, lambda s, e: loads.line_force(s, [0, 0, 4.0], e))
    path = load_path(problem, steps=1).states
    tip = 3 * model.vertex(10.0, 0.0)
    assert -path[-1].x[tip] == pytest.approx(3.28941, rel=tolerance)
    assert path[-1].x[tip + 2] == pytest.approx(6.69964, rel=tolerance)
    assert len(path) == 2
    assert path[-1].iterations <= 10
    assert path[-1].negative == 0


@pytest.mark.parametrize("ratio", [1e-2, 1e-3, 1e-4, 1e-5])
def test_a_thin_cantilever_needs_no_more_iterations_than_a_thick_one(ratio):
    """The second iterate may have (L / t)^2 times the work of the first; that is no divergence."""
    section = Section.isotropic(1200 / (10 * ratio) ** 3, 0.0, 10 * ratio)  # EI = 100
    model, problem = cantilever(2, 8, lambda s, e: loads.line_force(s, [0, 0, 4.0], e), section=section)
    path = load_path(problem, steps=1).states
    assert path[-1].x[3 * model.vertex(10.0, 0.0) + 2] == pytest.approx(6.69964, rel=1e-3)
    assert len(path) == 2
    assert path[-1].iterations <= 9


@pytest.mark.parametrize(
    ("alpha", "w", "u"), [(1, 0.30172077379981, 0.056433236283377), (2, 0.49345748039671, 0.16064172082517)]
)
def test_elastica(alpha, w, u):
    """Thin enough that stretching does not matter."""
    section = Section.isotropic(1.2e9, 0.0, 0.01)  # EI = 100
    model, problem = cantilever(
        3, 8, lambda s, e: loads.line_force(s, [0, 0, float(alpha)], e), section=section
    )
    state = load_path(problem, steps=1).states[-1]
    tip = 3 * model.vertex(10.0, 0.0)
    assert state.x[tip + 2] / 10 == pytest.approx(w, rel=1e-4)
    assert -state.x[tip] / 10 == pytest.approx(u, rel=1e-4)


@pytest.mark.parametrize(("turns", "steps"), [(1, 10), (2, 20)])
def test_strip_rolls_up(turns, steps):
    """M = 2 pi EI / L per turn; half of the width with its plane of symmetry. Koiter's strains shift the tip by
    about (t / R)^2 / 6 of the length for a turn."""
    model = Model(rectangle(24, 1, 0, 12, 0, 0.5), 2, Section.isotropic(1.2e6, 0.0, 0.1))
    model.supports.clamp(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(1, 0.0))
    load = loads.edge_moment(model.surface, -50 * np.pi / 3 * turns, model.edges(0, 12.0))
    path = load_path(Problem(model.koiter, model.reduction(), load), steps=steps).states
    tip = 3 * model.vertex(12.0, 0.0)
    assert path[-1].x[tip] == pytest.approx(-12.0, abs=0.012 * turns**2)
    assert path[-1].x[tip + 2] == pytest.approx(0.0, abs=1e-3 * turns)
    assert len(path) - 1 <= steps + turns


def test_slit_annulus():
    model = Model(
        rectangle(30, 6, 0, 2 * np.pi, 6, 10), 2, Section.isotropic(21e6, 0.0, 0.03),
        lambda q: np.column_stack([q[:, 1] * np.cos(q[:, 0]), -q[:, 1] * np.sin(q[:, 0]), 0 * q[:, 0]]),
    )  # fmt: skip
    model.supports.clamp(model.edges(0, 0.0))
    load = loads.line_force(model.surface, [0, 0, 0.8], model.edges(0, 2 * np.pi))
    state = load_path(Problem(model.koiter, model.reduction(), load), steps=5).states[-1]
    inner, outer = (state.x[3 * model.vertex(2 * np.pi, r) + 2] for r in (6.0, 10.0))
    assert inner == pytest.approx(13.891, rel=6e-3)
    assert outer == pytest.approx(17.528, rel=6e-3)


def test_pinched_hemisphere():
    """Sze, Liu & Lo 3.4 at full load: 4.067 outwards, 8.178 inwards, from a mesh of 16 x 16 shells with shear."""
    model = Model(
        rectangle(8, 8, 0, 5 * np.pi, 0, 4 * np.pi), 3, Section.isotropic(6.825e7, 0.3, 0.04), sphere(10.0)
    )
    model.supports.symmetry(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(0, 5 * np.pi))
    a, b = model.vertex(0.0, 0.0), model.vertex(5 * np.pi, 0.0)
    model.supports.translation([a], "z")
    load = loads.point_force(model.surface, a, [200, 0, 0]) + loads.point_force(
        model.surface, b, [0, -200, 0]
    )
    state = load_path(Problem(model.koiter, model.reduction(), load), steps=4).states[-1]
    assert state.x[3 * a] == pytest.approx(4.067, rel=6e-3)
    assert state.x[3 * b + 1] == pytest.approx(-8.178, rel=6e-3)


@pytest.fixture(scope="module")
def roof():
    """Hinged shallow roof, Sze, Liu & Lo 3.8a; a quarter under a quarter of 3000."""
    model = Model(rectangle(4, 4, 0, 254, 0, 254), 3, Section.isotropic(3102.75, 0.3, 12.7), cylinder(2540.0))
    model.supports.symmetry(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(1, 0.0))
    model.supports.simple(model.edges(0, 254.0))
    centre = model.vertex(0.0, 0.0)
    load = loads.point_force(model.surface, centre, [0, 0, -750.0])
    return Problem(model.koiter, model.reduction(), load), 3 * centre + 2


def test_load_control_stops_at_the_limit_point(roof):
    problem, centre = roof
    with pytest.raises(SolveError, match="turns back") as caught:
        load_path(problem, steps=4, until=0.8, limits="stop")
    last = caught.value.state.states[-1]
    assert 0.6 < last.factor < 0.7421
    assert last.x[centre] < 0


def test_load_steps_go_on_behind_the_limit_points(roof):
    problem, centre = roof
    path = load_path(problem, steps=4, until=0.8)
    assert path.states[-1].factor == pytest.approx(0.8)
    assert path.states[-1].negative == 0
    assert -path.states[-1].x[centre] > 25.0
    assert [c.kind for c in path.critical] == ["limit", "limit"]


def test_path_through_both_limit_points(roof):
    problem, centre = roof
    path = follow(problem, 0.8, lambda s: -s.x[centre] > 22.0)
    assert [c.kind for c in path.critical] == ["limit", "limit"]
    first, second = (c.state for c in path.critical)
    assert first.factor == pytest.approx(0.7421, rel=2e-3)  # table, at 11.293
    assert second.factor == pytest.approx(0.1729, rel=2e-2)  # table, at 19.852
    assert [s.negative for s in path.states][-1] == 0


def test_displacement_control_gives_the_table(roof):
    """The table was computed with other elements, on one mesh: its loads differ by up to 2 percent."""
    problem, centre = roof
    follower, state = PathFollower(problem), problem.start()
    row = np.eye(1, problem.energy.unknowns, centre)[0]
    for factor, w in (
        (0.1980, 1.638),
        (0.4686, 4.477),
        (0.6908, 8.237),
        (0.7421, 11.293),
        (0.6182, 14.188),
        (0.1729, 19.852),
    ):
        state = follower.displacement(state, row, -w - state.x[centre]).state
        assert state.x[centre] == pytest.approx(-w, abs=1e-9)
        assert state.factor == pytest.approx(factor, rel=2.5e-2)


def test_follower_pressure_bends_a_strip_to_a_circle_segment():
    """Checked against the equilibrium of the end: the clamp carries the pressure on the chord."""
    model = Model(rectangle(10, 1, 0, 10, 0, 1), 2, Section.isotropic(1.2e6, 0.0, 0.1))
    edge = model.edges(0, 0.0)
    model.supports.clamp(edge)
    surface = model.surface
    zero = np.zeros(surface.unknowns)
    problem = Problem(
        model.koiter, model.reduction(), zero, lambda x: loads.follower_pressure(surface, x, 2.0)
    )
    state = load_path(problem, steps=4).states[-1]
    _, residual, _ = problem.evaluate(state.x, 1.0, 1, state.memory, None)
    reaction = -residual[: surface.rotation_start].reshape(-1, 3)[surface.nodes_of_edges(edge)].sum(axis=0)
    u = surface.split(state.x)[0]
    tip = surface.nodes[model.vertex(10.0, 0.0)] + u[model.vertex(10.0, 0.0)]
    chord = np.array([-tip[2], 0.0, tip[0]])  # pressure times the chord, turned by 90 degrees
    assert u[:, 2].max() > 3.0
    assert np.allclose(reaction, -2.0 * chord, atol=2e-3 * np.linalg.norm(chord))


def test_prescribed_motion_in_steps():
    """Ends of a strip brought together: it shortens or buckles, and the reaction is that of the true state."""
    model = Model(rectangle(8, 1, 0, 10, 0, 1), 2, Section.isotropic(1.2e6, 0.0, 0.1))
    model.supports.clamp(model.edges(0, 0.0))
    end = model.surface.nodes_of_edges(model.edges(0, 10.0))
    model.supports.translation(end, "z", [0, 0, 6.0])
    problem = Problem(model.koiter, model.reduction(), np.zeros(model.surface.unknowns))
    state = load_path(problem, steps=3).states[-1]
    u = model.surface.split(state.x)[0]
    assert np.allclose(u[end, 2], 6.0)
    # the same state under the force that holds it there
    _, residual, _ = problem.evaluate(state.x, 1.0, 1, state.memory, None)
    force = -residual[2 : model.surface.rotation_start : 3][end].sum()
    free, problem = cantilever(2, 8, lambda s, e: loads.line_force(s, [0, 0, force], e))
    again = load_path(problem, steps=1).states[-1]
    assert again.x[3 * free.vertex(10.0, 0.0) + 2] == pytest.approx(6.0, rel=1e-3)


def test_euler_column_buckles_onto_the_branch_of_the_elastica():
    """A cantilever under an axial force: bifurcation at pi^2 EI / 4 L^2; at a tip angle of 60 degrees the elastica
    carries 1.1517 times as much, with the tip at 0.5932 L aside (Timoshenko & Gere, table 2-4)."""
    model, problem = cantilever(
        2, 10, lambda s, e: loads.line_force(s, [-1e-5, 0, 0], e), section=Section.isotropic(12.0, 0.0, 0.1)
    )
    euler = np.pi**2 * 1e-3 / 400
    path = follow(problem, 2e-5, lambda s: s.factor > 1.5 * euler / 1e-5)
    (critical,) = path.critical
    assert critical.kind == "bifurcation"
    assert critical.state.factor * 1e-5 == pytest.approx(euler, rel=2e-2)
    tip = 3 * model.vertex(10.0, 0.0)
    assert abs(critical.mode[tip + 2]) == pytest.approx(1.0, abs=1e-6)

    branch = follow(
        problem, 0.3, lambda s: abs(s.x[tip + 2]) > 5.9, critical.state, along=critical.mode, most_steps=40
    )
    aside = [abs(s.x[tip + 2]) for s in branch.states]
    load = [s.factor * 1e-5 / euler for s in branch.states]
    assert np.interp(5.932, aside, load) == pytest.approx(1.1517, rel=1e-2)
    assert branch.states[-1].negative == 0


def test_von_karman_plate():
    """Clamped square plate with immovable edges under pressure: w / h at q a^4 / (E h^4) = 95 (converged Koiter)."""
    h = 0.002
    model = Model(rectangle(8, 8, 0, 0.5, 0, 0.5), 2, Section.isotropic(1.0, 0.3, h))
    for axis in (0, 1):
        model.supports.clamp(model.edges(axis, 0.0))
        model.supports.symmetry(model.edges(axis, 0.5), np.eye(3)[axis])
    load = loads.pressure(model.surface, 95 * h**4)
    state = load_path(Problem(model.koiter, model.reduction(), load), steps=1).states[-1]
    assert state.x[3 * model.vertex(0.5, 0.5) + 2] / h == pytest.approx(0.9086056697, rel=1e-3)


def test_chart_and_triangulated_surface_agree():
    """A shallow cap under pressure, both discretisations at large deflections."""
    section = Section.isotropic(1e6, 0.3, 0.02)
    chart = Chart.from_expressions("u", "v", "0.1*(u*(1 - u) + v*(1 - v))")
    flat = rectangle(4, 4, 0, 1, 0, 1)
    surface = ChartSurface(flat, chart)
    supports = ChartSupports(surface)
    supports.simple(flat.boundary_edges)
    problem = Problem(
        ChartKoiter(surface, section), supports.reduction(), chart_loads.pressure(surface, -8.0)
    )
    a = load_path(problem, steps=2).states[-1].x[18 * 12 + 2]

    model = Model(rectangle(8, 8, 0, 1, 0, 1), 3, section, lambda q: chart(q[:, 0], q[:, 1]))
    model.supports.simple(model.mesh.boundary_edges)
    problem = Problem(model.koiter, model.reduction(), loads.pressure(model.surface, -8.0))
    b = load_path(problem, steps=2).states[-1].x[3 * model.vertex(0.5, 0.5) + 2]
    assert abs(b) > 0.005
    assert a == pytest.approx(b, rel=1e-3)
