"""Known answers: series, closed forms and converged solutions of the Koiter model (references as in verification)."""

import numpy as np
import pytest

from kshell.mesh.mesh import Mesh
from kshell.shell.koiter import loads
from kshell.shell.koiter.recovery import energies, resultants
from kshell.shell.section import Section
from tests.shell.shapes import Model, cylinder, rectangle, sphere


def scordelis_lo(order, nx, ny):
    edge = 25.0 * np.radians(40.0)
    model = Model(
        rectangle(nx, ny, 0, edge, 0, 25), order, Section.isotropic(4.32e8, 0.0, 0.25), cylinder(25.0)
    )
    model.supports.symmetry(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(1, 0.0))
    model.supports.diaphragm(model.edges(1, 25.0))
    answer = model.solve(loads.traction(model.surface, [0, 0, -90.0]))
    return model, answer, answer.x[3 * model.vertex(edge, 0.0) + 2]


@pytest.mark.parametrize(
    ("order", "nx", "ny", "tolerance"),
    [(1, 32, 32, 3e-2), (2, 16, 16, 1e-4), (3, 8, 4, 1e-5), (3, 10, 4, 1e-5)],
)
def test_scordelis_lo_roof(order, nx, ny, tolerance):
    model, answer, deflection = scordelis_lo(order, nx, ny)
    assert deflection == pytest.approx(-0.300592457, rel=tolerance)
    if order == 3:
        assert model.reduction().basis.shape[1] <= 1700
        strain = model.koiter.linear_strain(answer.x)
        assert sum(e.sum() for e in energies(model.koiter, strain)) == pytest.approx(4826.57703 / 4, rel=2e-5)


@pytest.mark.parametrize(("order", "n"), [(2, 20), (3, 10)])
def test_pinched_cylinder(order, n):
    mesh = rectangle(n, n, 0, 1, 0, 1)
    points = mesh.points**2 * [150 * np.pi, 300.0, 0.0]  # graded towards the force
    model = Model(Mesh(points, mesh.triangles), order, Section.isotropic(3e6, 0.3, 3.0), cylinder(300.0))
    for axis, value in ((0, 0.0), (0, 150 * np.pi), (1, 0.0)):
        model.supports.symmetry(model.edges(axis, value))
    model.supports.diaphragm(model.edges(1, 300.0))
    node = model.vertex(0.0, 0.0)
    answer = model.solve(loads.point_force(model.surface, node, [0, 0, -0.25]))
    assert answer.x[3 * node + 2] == pytest.approx(-1.828195e-5, rel=1e-3)


@pytest.mark.parametrize(("order", "n"), [(2, 32), (3, 16)])
def test_hemisphere_with_hole(order, n):
    model = Model(
        rectangle(n, n, 0, 5 * np.pi, 0, 4 * np.pi),
        order,
        Section.isotropic(6.825e7, 0.3, 0.04),
        sphere(10.0),
    )
    model.supports.symmetry(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(0, 5 * np.pi))
    a, b = model.vertex(0.0, 0.0), model.vertex(5 * np.pi, 0.0)
    model.supports.translation([a], "z")
    surface = model.surface
    answer = model.solve(loads.point_force(surface, a, [1, 0, 0]) + loads.point_force(surface, b, [0, -1, 0]))
    assert answer.x[3 * a] == pytest.approx(0.0935216, rel=3e-4)


def octant(n):
    """Triangles of the simplex x + y + z = 1, and the projection onto the sphere of radius 10."""
    number = {}
    for i in range(n + 1):
        for j in range(n + 1 - i):
            number[i, j] = len(number)
    points = np.array([(i / n, j / n, 1 - (i + j) / n) for i, j in number])
    triangles = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in number if i + j < n]
    triangles += [
        (number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in number if i + j < n - 1
    ]
    return Mesh(points, np.array(triangles, dtype=np.int32))


def onto_sphere(q):
    w = np.sin(np.pi / 2 * q)
    return 10 * w / np.linalg.norm(w, axis=1)[:, None]


def test_full_hemisphere():
    model = Model(octant(18), 3, Section.isotropic(6.825e7, 0.3, 0.04), onto_sphere)
    model.supports.symmetry(model.edges(0, 0.0))
    model.supports.symmetry(model.edges(1, 0.0))
    a, b = model.vertex(1, 0, 0), model.vertex(0, 1, 0)
    model.supports.translation([a], "z")
    surface = model.surface
    answer = model.solve(loads.point_force(surface, a, [1, 0, 0]) + loads.point_force(surface, b, [0, -1, 0]))
    assert answer.x[3 * a] == pytest.approx(0.0924131, rel=3e-4)


@pytest.mark.parametrize(
    ("order", "n", "mean_error", "largest_error"),
    [(1, 24, 3e-3, 0.06), (2, 12, 5e-5, 3e-3), (3, 8, 2e-5, 1e-3)],
)
def test_sphere_under_pressure(order, n, mean_error, largest_error):
    """w = p R^2 (1 - nu) / (2 E t), less (t / R)^2 / 12 of it, and N = p R / 2; three planes of symmetry."""
    model = Model(octant(n), order, Section.isotropic(1.0, 0.3, 0.5), onto_sphere)
    for axis in range(3):
        model.supports.symmetry(model.edges(axis, 0.0))
    surface = model.surface
    load = loads.pressure(surface, 1.0)
    answer = model.solve(load)
    exact = 100 * 0.7 / (2 * 0.5) * (1 - 0.05**2 / 12)
    area = np.sum(surface.area_elements * surface.reference.weights)
    assert load @ answer.x / area == pytest.approx(exact, rel=mean_error)
    outwards = (surface.split(answer.x)[0] * surface.nodes / 10).sum(axis=1)
    assert np.abs(outwards / exact - 1).max() < largest_error
    found = resultants(model.koiter, model.koiter.linear_strain(answer.x), np.array([[1 / 3, 1 / 3]]))
    assert np.abs(found.membrane_force - [5.0, 5.0, 0.0]).mean() < 0.02


def raasch(q):
    """Arc length along the hook to two arcs of radius 14 (60 degrees) and 46 (150 degrees), bent oppositely."""
    first = np.minimum(q[:, 0] / 14, np.pi / 3)
    second = np.maximum(q[:, 0] - 14 * np.pi / 3, 0) / 46
    x = 14 * np.sin(first) + 46 * (np.sin(second - np.pi / 3) + np.sin(np.pi / 3))
    z = 14 * (1 - np.cos(first)) + 46 * (np.cos(second - np.pi / 3) - np.cos(np.pi / 3))
    return np.column_stack([x, q[:, 1], z])


@pytest.mark.parametrize(("order", "n", "m"), [(1, 36, 6), (2, 24, 4), (3, 16, 2)])
def test_raasch_hook(order, n, m):
    first, whole = 14 * np.pi / 3, 14 * np.pi / 3 + 46 * np.radians(150.0)
    mesh = rectangle(n, m, 0, n, 0, 20)
    points = mesh.points.copy()
    bend = round(n * first / whole)
    points[:, 0] = np.interp(points[:, 0], [0, bend, n], [0, first, whole])
    model = Model(Mesh(points, mesh.triangles), order, Section.isotropic(3300.0, 0.3, 2.0), raasch)
    model.supports.clamp(model.edges(0, 0.0))
    answer = model.solve(loads.line_force(model.surface, [0, 1 / 20, 0], model.edges(0, whole)))
    assert answer.x[3 * model.vertex(whole, 10.0) + 1] == pytest.approx(4.5580, rel=1e-3)


@pytest.mark.parametrize(
    ("thickness", "force", "axis", "reference"),
    [
        (0.32, 1.0, 1, 1.74949e-3),
        (0.32, 1.0, 2, 5.39965e-3),
        (0.0032, 1e-6, 1, 1.2928e-3),
        (0.0032, 1e-6, 2, 5.24974e-3),
    ],
)
def test_twisted_beam(thickness, force, axis, reference):
    def twist(q):
        angle = np.pi / 24 * q[:, 0]
        return np.column_stack([q[:, 0], q[:, 1] * np.cos(angle), q[:, 1] * np.sin(angle)])

    model = Model(rectangle(24, 4, 0, 12, -0.55, 0.55), 3, Section.isotropic(29e6, 0.22, thickness), twist)
    model.supports.clamp(model.edges(0, 0.0))
    load = loads.line_force(model.surface, force / 1.1 * np.eye(3)[axis], model.edges(0, 12.0))
    assert model.solve(load).x[3 * model.vertex(12.0, 0.0) + axis] == pytest.approx(reference, rel=1e-3)


@pytest.mark.parametrize(("thickness", "reference"), [(1e-2, -9.31454e-5), (1e-3, -6.39719e-3)])
def test_partly_clamped_hypar(thickness, reference):
    mesh = rectangle(24, 12, 0, 1, 0, 0.5)
    points = mesh.points.copy()
    points[:, 0] = 0.5 * np.sin(np.pi * (mesh.points[:, 0] - 0.5))  # graded towards both ends
    points[:, 1] = 0.5 * np.sin(np.pi * mesh.points[:, 1])
    model = Model(
        Mesh(points, mesh.triangles), 3, Section.isotropic(2e11, 0.3, thickness),
        lambda q: np.column_stack([q[:, 0], q[:, 1], q[:, 0] ** 2 - q[:, 1] ** 2]),
    )  # fmt: skip
    model.supports.clamp(model.edges(0, -0.5))
    model.supports.symmetry(model.edges(1, 0.0), [0, 1, 0])
    answer = model.solve(loads.traction(model.surface, [0, 0, -8000 * thickness]))
    assert answer.x[3 * model.vertex(0.5, 0.0) + 2] == pytest.approx(reference, rel=2e-4)


@pytest.mark.parametrize("ratio", [1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize(("order", "n", "skew"), [(2, 16, 0.0), (2, 16, 0.27), (3, 8, 0.0), (3, 8, 0.27)])
def test_quarter_cylinder_in_pure_bending_does_not_lock(ratio, order, n, skew):
    """Tip force 1 EI on a quarter circle of radius 1: the tip moves by pi / 4 (1 + t^2 / 12)."""
    mesh = rectangle(n, n // 2, 0, np.pi / 2, 0, 1, skew)
    model = Model(mesh, order, Section.isotropic(1.0, 0.0, ratio), cylinder(1.0))
    model.supports.clamp(model.edges(0, 0.0))
    load = loads.line_force(model.surface, [ratio**3 / 12, 0, 0], model.edges(0, np.pi / 2))
    tip = model.solve(load).x[3 * model.vertex(np.pi / 2, 0.0)]
    assert tip == pytest.approx(np.pi / 4 * (1 + ratio**2 / 12), rel=1e-4)


def test_cylinder_edge_load_and_moment():
    """Semi-infinite cylinder: w0 and slope of Q0 and M0 at the end (Timoshenko, chapter 15)."""
    radius, t, nu, length = 1.0, 0.01, 0.3, 1.0
    mesh = rectangle(24, 2, 0, 1, 0, 0.2)
    points = mesh.points.copy()
    points[:, 0] = length * points[:, 0] ** 1.5
    points = points[:, [1, 0, 2]]  # u around, v along the axis
    model = Model(
        Mesh(points, mesh.triangles[:, [0, 2, 1]]), 3, Section.isotropic(1.0, nu, t), cylinder(radius)
    )
    for value in (0.0, 0.2):
        model.supports.symmetry(model.edges(0, value))
    model.supports.symmetry(model.edges(1, length))
    end, node = model.edges(1, 0.0), model.vertex(0.0, 0.0)
    beta = 12.85407003320672
    bending = t**3 / (12 * (1 - nu**2))

    def outwards(p):
        return p * [1.0, 0.0, 1.0] / radius

    force = model.solve(loads.line_force(model.surface, outwards, end))
    moment = model.solve(loads.edge_moment(model.surface, 1.0, end))
    # the classical solution leaves out terms of the relative size t / R
    assert force.x[3 * node + 2] == pytest.approx(1 / (2 * beta**3 * bending), rel=5e-3)
    assert abs(moment.x[3 * node + 2]) == pytest.approx(1 / (2 * beta**2 * bending), rel=5e-3)
    slopes = [np.abs(a.x[model.surface.rotations_of_edges(end)]).mean() for a in (force, moment)]
    assert slopes == pytest.approx([1 / (2 * beta**2 * bending), 1 / (beta * bending)], rel=5e-3)
