"""The Argyris discretisation on charts: the same properties and references as the triangulated surface."""

import numpy as np
import pytest

from kshell.equilibrium.linear import solve_linear
from kshell.errors import InputError
from kshell.geometry import Chart
from kshell.mesh.mesh import Mesh
from kshell.shell.chart import loads as chart_loads
from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.chart.matrices import chart_foundation
from kshell.shell.chart.reactions import chart_resultant
from kshell.shell.chart.recovery import chart_resultants
from kshell.shell.chart.supports import ChartSupports
from kshell.shell.chart.surface import ChartSurface
from kshell.shell.section import Section
from tests.shell.shapes import rectangle
from tests.shell.test_koiter import LAMINATE


def cylinder_chart(radius):
    return Chart.from_expressions("R*sin(u/R)", "v", "R*cos(u/R)", constants={"R": radius})


def sphere_chart(radius):
    return Chart.from_expressions(
        "R*cos(u/R)*cos(v/R)", "R*sin(u/R)*cos(v/R)", "R*sin(v/R)", constants={"R": radius}
    )


class ChartModel:
    def __init__(self, mesh, chart, section):
        self.mesh = mesh
        self.surface = ChartSurface(mesh, chart)
        self.koiter = ChartKoiter(self.surface, section)
        self.supports = ChartSupports(self.surface)

    def edges(self, axis, value):
        boundary = self.mesh.boundary_edges
        middle = self.mesh.points[self.mesh.edges[boundary]].mean(axis=1)
        return boundary[np.abs(middle[:, axis] - value) < 1e-9]

    def vertex(self, u, v):
        return int(np.argmin(np.abs(self.mesh.points - [u, v, 0]).sum(axis=1)))

    def solve(self, load):
        return solve_linear(self.koiter, load, self.supports.reduction())


def test_six_motions_without_energy():
    surface = ChartSurface(rectangle(2, 2, 0, 1, 0, 1, skew=0.2), sphere_chart(1.3))
    koiter = ChartKoiter(surface, LAMINATE)
    # of unknowns of one size: value, h d, h^2 d2
    scale = np.full(surface.scalars, 0.5)
    scale[: 6 * len(surface.mesh.points)] = np.tile([1, 0.5, 0.5, 0.25, 0.25, 0.25], len(surface.mesh.points))
    scale = np.repeat(1 / scale, 3)
    values = np.linalg.eigvalsh(koiter.linear_stiffness().toarray() * scale[:, None] * scale)
    assert np.all(np.abs(values[:6]) < 1e-11 * values[-1])
    assert values[6] > 1e-7 * values[-1]


def test_derivatives_against_finite_differences():
    surface = ChartSurface(rectangle(2, 1, 0, 1, 0, 1, skew=0.2), sphere_chart(1.3))
    koiter = ChartKoiter(surface, LAMINATE, block=3)
    rng = np.random.default_rng(0)
    x, step = 0.02 * rng.normal(size=surface.unknowns), rng.normal(size=surface.unknowns)
    h = 1e-6
    state = koiter.energy(x, 2)
    ahead, behind = (koiter.energy(x + s * h * step, 1) for s in (1, -1))
    assert (ahead.value - behind.value) / (2 * h) == pytest.approx(state.gradient @ step, rel=1e-7)
    difference, exact = (ahead.gradient - behind.gradient) / (2 * h), state.hessian @ step
    assert np.linalg.norm(difference - exact) < 1e-7 * np.linalg.norm(exact)


def test_scordelis_lo_roof():
    edge = 25 * np.radians(40.0)
    model = ChartModel(
        rectangle(6, 6, 0, edge, 0, 25), cylinder_chart(25.0), Section.isotropic(4.32e8, 0.0, 0.25)
    )
    model.supports.symmetry(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(1, 0.0))
    model.supports.diaphragm(model.edges(1, 25.0))
    answer = model.solve(chart_loads.traction(model.surface, [0, 0, -90.0]))
    assert answer.x[18 * model.vertex(edge, 0.0) + 2] == pytest.approx(-0.300592457, rel=1e-7)


def test_hemisphere_with_hole():
    model = ChartModel(
        rectangle(16, 16, 0, 5 * np.pi, 0, 4 * np.pi),
        sphere_chart(10.0),
        Section.isotropic(6.825e7, 0.3, 0.04),
    )
    model.supports.symmetry(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(0, 5 * np.pi))
    a, b = model.vertex(0.0, 0.0), model.vertex(5 * np.pi, 0.0)
    model.supports.vertex(a, "z")
    load = chart_loads.point_force(model.surface, a, [1, 0, 0])
    answer = model.solve(load + chart_loads.point_force(model.surface, b, [0, -1, 0]))
    assert answer.x[18 * a] == pytest.approx(0.0935216, rel=3e-4)


@pytest.mark.parametrize("ratio", [1e-2, 1e-3])
def test_pure_bending_on_an_oblique_chart(ratio):
    """Parameter lines that are not at right angles: the slope across an edge involves that along it."""
    mesh = rectangle(8, 4, 0, np.pi / 2, 0, 1)
    points = mesh.points.copy()
    points[:, 0] -= points[:, 1] / 3
    chart = Chart.from_expressions("sin(u + v/3)", "v", "cos(u + v/3)")
    model = ChartModel(Mesh(points, mesh.triangles), chart, Section.isotropic(1.0, 0.0, ratio))
    boundary = mesh.boundary_edges
    arc = mesh.points[mesh.edges[boundary]].mean(axis=1)[:, 0]
    model.supports.clamp(boundary[arc < 1e-9])
    end = boundary[arc > np.pi / 2 - 1e-9]
    tip = int(np.argmax(mesh.points[:, 0]))
    force = model.solve(chart_loads.line_force(model.surface, [ratio**3 / 12, 0, 0], end))
    assert force.x[18 * tip] == pytest.approx(np.pi / 4 * (1 + ratio**2 / 12), rel=3e-5)
    moment = model.solve(chart_loads.edge_moment(model.surface, ratio**3 / 12, end))
    assert moment.x[18 * tip : 18 * tip + 3] == pytest.approx([-1, 0, 1 - np.pi / 2], rel=1e-4, abs=1e-6)


def test_membrane_forces_and_moments_of_a_pressurised_cylinder():
    """N = p R around, w = p R^2 / (E t); no force along the axis."""
    model = ChartModel(
        rectangle(2, 2, 0, np.pi, 0, 1), cylinder_chart(2.0), Section.isotropic(1.0, 0.3, 0.01)
    )
    for value in (0.0, np.pi):
        model.supports.symmetry(model.edges(0, value))
    model.supports.symmetry(model.edges(1, 0.0))
    answer = model.solve(chart_loads.pressure(model.surface, 1.0))
    assert answer.x[18 * model.vertex(0.0, 0.0) + 2] == pytest.approx(4 / 0.01, rel=1e-4)
    found = chart_resultants(model.koiter, answer.x, [[0.2, 0.3], [0.5, 0.1]])
    assert np.allclose(found.membrane_force, [2.0, 0.0, 0.0], atol=1e-3)
    assert np.abs(found.moment).max() < 1e-4


def test_prescribed_motion():
    model = ChartModel(
        rectangle(4, 2, 0, 2, 0, 1),
        Chart.from_expressions("u", "v", "0*u"),
        Section.isotropic(12.0, 0.0, 1.0),
    )
    model.supports.clamp(model.edges(0, 0.0))
    model.supports.translation(model.edges(0, 2.0), "z", [0, 0, 0.01])
    answer = model.solve(np.zeros(model.surface.unknowns))
    middle = answer.x[18 * model.vertex(1.0, 0.5) + 2]
    assert middle == pytest.approx(0.01 * 5 / 16, rel=1e-9)


def test_singular_charts_are_refused():
    with pytest.raises(InputError, match="singular"):
        ChartSurface(rectangle(2, 2, 0, 1, 0, 1), Chart.from_expressions("u", "u", "0*v"))


def test_reactions_balance_the_loads():
    model = ChartModel(rectangle(4, 4, 0, 10, 0, 8), sphere_chart(10.0), Section.isotropic(1e3, 0.3, 0.4))
    model.supports.clamp(model.edges(0, 0.0))
    end = model.edges(0, 10.0)
    load = chart_loads.pressure(model.surface, lambda x: 1 + 0.1 * x[:, 0])
    load += chart_loads.line_force(model.surface, [0.0, 1.0, 0.5], end)
    load += chart_loads.edge_moment(model.surface, 2.0, end)
    answer = model.solve(load)
    reaction, turning = chart_resultant(model.surface, answer.forces)
    force, moment = chart_resultant(model.surface, load)
    assert np.abs(force).max() > 10
    assert np.allclose(reaction, -force, atol=1e-7 * np.abs(force).max())
    assert np.allclose(turning, -moment, atol=1e-4 * np.abs(moment).max())


def test_mass_is_that_of_the_surface():
    surface = ChartSurface(rectangle(3, 2, 0, np.pi, 0, 1), cylinder_chart(2.0))
    x = np.zeros((surface.scalars, 3))
    x[: 6 * len(surface.mesh.points) : 6, 0] = 1.0
    mass = chart_foundation(surface, 2.0, np.eye(3))
    assert x.ravel() @ mass @ x.ravel() == pytest.approx(2 * np.pi, rel=1e-12)
