"""Multigrid: as good as a factorisation, in few iterations, on everything a plate mesh can be."""

from dataclasses import replace

import numpy as np
import pytest

import kshell as ks
from kshell.errors import InputError, SolveError
from kshell.mesh.mesh import Mesh
from kshell.solvers import prepare, solve_system
from kshell.solvers.multigrid import hierarchy
from kshell.solvers.multigrid import solver as multigrid
from kshell.solvers.multigrid.cloud import Cloud
from kshell.solvers.multigrid.coarsen import coarsen

from .plates import (
    SUPPORTS,
    cut,
    disk_with_hole,
    graded,
    l_shape,
    mesh_of,
    plate,
    slit,
    square,
    stretched,
)

SIZE = {"morley": 40, "argyris": 26}  # cells across
SHAPES = {"square": square, "L": l_shape, "slit": slit}
EASY = ("clamped", "simply supported")


def energy_error(problem, x):
    """Distance to the factorisation's answer in the energy norm, relative."""
    a, b = problem.assembled.matrix, problem.assembled.load
    exact = solve_system(a, b, method="superlu").x
    e = x - exact
    return np.sqrt(abs(e @ (a @ e)) / (b @ exact))


def run(problem, tolerance=1e-8):
    return solve_system(
        problem.assembled.matrix, problem.assembled.load, problem.space, "multigrid", tolerance
    )


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize("shape", list(SHAPES))
@pytest.mark.parametrize("supports", list(SUPPORTS))
def test_iterations_and_error(shape, element, supports):
    problem = plate(mesh_of(*SHAPES[shape](SIZE[element])), element, supports)
    solution = run(problem)
    assert solution.iterations <= (17 if supports in EASY else 21)
    assert solution.energy_error <= 1e-8
    assert energy_error(problem, solution.x) < 4e-8
    assert not solution.warnings


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize("supports", ["clamped", "simply supported", "cantilever"])
def test_hole(element, supports):
    problem = plate(mesh_of(*disk_with_hole(14 if element == "argyris" else 24), near=0.2), element, supports)
    solution = run(problem)
    assert solution.iterations <= 20
    assert energy_error(problem, solution.x) < 4e-8


@pytest.mark.parametrize("supports", ["clamped", "mixed"])
def test_graded(supports):
    problem = plate(mesh_of(*graded(36), near=0.2), "morley", supports)
    solution = run(problem)
    assert solution.iterations <= 18
    assert energy_error(problem, solution.x) < 4e-8


@pytest.mark.parametrize("jitter", [0.0, 0.25])
def test_coarse_triangles_on_free_edges_are_not_flat(jitter):
    """Flat ones carry stiff functions: at free edges the iterations grew with the number of levels."""
    cloud = Cloud.of_space(plate(mesh_of(*square(96, jitter)), "morley", "mixed").space)
    for level in range(3):
        cloud = coarsen(cloud).cloud
        edges, line = cloud.edges
        free = edges[line & cloud.plain[edges].all(axis=1)]
        pairs = {tuple(sorted(pair)) for pair in free.tolist()}
        heights = []
        for triangle in cloud.triangles:
            for k in range(3):
                a, b, apex = triangle[[k, (k + 1) % 3, (k + 2) % 3]].tolist()
                if (min(a, b), max(a, b)) in pairs:
                    along, up = cloud.points[b] - cloud.points[a], cloud.points[apex] - cloud.points[a]
                    heights.append(abs(along[0] * up[1] - along[1] * up[0]) / (along @ along))
        if level:  # on the first level the fine mesh keeps them apart
            assert np.quantile(heights, 0.05) > 0.28


def moved(points):
    """The same plate once more: with other last digits; larger; turned and elsewhere."""
    noise = np.random.default_rng(1).uniform(-1e-13, 1e-13, points.shape)
    c, s = np.cos(0.3), np.sin(0.3)
    return [points * (1 + noise), 1.7 * points, points @ [[c, s], [-s, c]] - [0.3, 7.0]]


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize(("shape", "near"), [(square, 1e-6), (l_shape, 1e-6), (disk_with_hole, 0.2)])
def test_iterations_do_not_hang_on_the_last_digit(shape, near, element):
    """Nor on where the plate lies: regular meshes are full of ties, and rounding must not decide them."""
    cells = {"morley": 40, "argyris": 20}[element] // (2 if shape is disk_with_hole else 1)
    points, triangles = shape(cells)
    mesh = mesh_of(points, triangles, near)

    def iterations(points):
        flat = np.column_stack([points, np.zeros(len(points))])
        return run(plate(Mesh(flat, mesh.triangles, groups=mesh.groups), element, "mixed")).iterations

    first = iterations(points)
    assert all(abs(iterations(other) - first) <= 1 for other in moved(points))


@pytest.mark.parametrize("shape", [lambda n: square(n, 0.0), l_shape, disk_with_hole])
def test_levels_are_those_of_the_mesh_not_of_its_digits(shape):
    points, triangles = shape(24)

    def levels(points):
        cloud = Cloud.of_space(plate(mesh_of(points, triangles), "morley", "clamped").space)
        for _ in range(2):
            coarsening = coarsen(cloud)
            yield coarsening
            cloud = coarsening.cloud

    for other in moved(points):
        for one, two in zip(levels(points), levels(other), strict=True):
            assert np.array_equal(one.chosen, two.chosen)
            assert np.array_equal(one.region, two.region)
            assert np.array_equal(one.cloud.triangles, two.cloud.triangles)


@pytest.mark.parametrize("supports", ["clamped", "simply supported"])
def test_iterations_do_not_hang_on_the_numbering(supports):
    """It decides by chance which vertices stay: no draw may leave gaps beside a support."""
    points, triangles = l_shape(80)
    iterations = []
    for seed in range(4):
        number = np.random.default_rng(seed).permutation(len(points))
        renumbered = np.empty_like(points)
        renumbered[number] = points
        iterations.append(run(plate(mesh_of(renumbered, number[triangles]), "morley", supports)).iterations)
    assert max(iterations) <= min(iterations) + 2


def test_iterations_do_not_grow():
    """Four times the unknowns twice over: two iterations more at the most."""
    iterations = [run(plate(mesh_of(*l_shape(n)), "morley", "clamped")).iterations for n in (40, 80, 160)]
    assert max(iterations) <= min(iterations) + 2


def test_thin_triangles_converge():
    problem = plate(mesh_of(*stretched(80, 5)), "morley", "cantilever")
    solution = run(problem)
    assert solution.name.startswith("multigrid")
    assert solution.iterations <= 40
    assert energy_error(problem, solution.x) < 1e-7


def test_factorisation_takes_over_where_it_stalls():
    problem = plate(mesh_of(*stretched(60, 20)), "argyris", "cantilever")
    solution = run(problem)
    assert not solution.name.startswith("multigrid")
    assert any("stalled" in warning for warning in solution.warnings)
    assert energy_error(problem, solution.x) < 1e-6


def test_stall_without_memory_keeps_history_and_iterate(monkeypatch):
    monkeypatch.setattr(multigrid, "fits", lambda *_: False)
    problem = plate(mesh_of(*stretched(60, 20)), "argyris", "cantilever")
    with pytest.raises(SolveError, match="stalled") as caught:
        run(problem)
    state = caught.value.state
    assert len(state.history) > 10
    assert state.energy_error == min(state.history) > 1e-6
    assert energy_error(problem, state.x) < 0.5


def test_jump_of_stiffness():
    """A stiff inclusion, ten thousand times stiffer, and one as much softer."""

    def stiff(x, y):
        return (np.abs(x - 0.5) < 0.25) & (np.abs(y - 0.5) < 0.25)

    mesh = mesh_of(*square(40, 0.0), stiff=stiff, soft=lambda x, y: ~stiff(x, y))
    factor = 1e4 ** (1 / 3)
    for inside, outside in ((factor, 1.0), (1.0, factor)):
        thickness = {"stiff": 0.01 * inside, "soft": 0.01 * outside}
        problem = plate(mesh, "morley", "clamped", thickness)
        solution = run(problem)
        assert solution.iterations <= 25
        assert energy_error(problem, solution.x) < 1e-7


def test_variable_thickness():
    problem = plate(mesh_of(*square(40)), "morley", "mixed", "0.01 * (1 + 2*x)")
    solution = run(problem)
    assert solution.iterations <= 18
    assert energy_error(problem, solution.x) < 4e-8


def test_point_supports():
    corners = [ks.Fixed(point, "z") for point in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0.3, 0.6, 0))]
    problem = plate(mesh_of(*square(40)), "morley", corners)
    solution = run(problem)
    assert solution.iterations <= 22
    assert energy_error(problem, solution.x) < 4e-8


def test_elastic_foundation():
    mesh = mesh_of(*square(40), everywhere=lambda x, y: x > -1)
    problem = plate(mesh, "morley", [ks.Elastic("everywhere", 1e5)])
    solution = run(problem)
    assert solution.iterations <= 18
    assert energy_error(problem, solution.x) < 4e-8


@pytest.mark.parametrize("element", ["morley", "argyris"])
def test_loads_and_reactions_balance_where_it_stops_by_itself(element):
    scene = ks.Scene(
        mesh=mesh_of(*square(48, 0.2)),
        thickness=0.01,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.SimplySupported("boundary")],
        loads=[ks.Pressure(1.0)],
    )
    result = ks.solve(scene, element=element, solver="multigrid", error="off")
    assert result.solver["iterations"] > 1
    assert result.balance < 1e-6
    assert not [words for words in result.warnings if "loads and reactions" in words]


def test_several_loads_and_reuse():
    problem = plate(mesh_of(*square(30)), "morley", "clamped")
    b = problem.assembled.load
    prepared = prepare(problem.assembled.matrix, problem.space, "multigrid")
    both = prepared.solve(np.column_stack([b, -2 * b, 0 * b]), 1e-10)
    assert both.x.shape == (len(b), 3)
    assert np.allclose(both.x[:, 1], -2 * both.x[:, 0], rtol=1e-6, atol=1e-12 * np.abs(both.x).max())
    assert not both.x[:, 2].any()
    assert prepared.solve(b).seconds["setup"] == 0.0


def test_preconditioner_is_symmetric_and_positive():
    problem = plate(mesh_of(*square(24)), "argyris", "mixed")
    prepared = prepare(problem.assembled.matrix, problem.space, "multigrid")
    u, v = np.random.default_rng(0).standard_normal((2, len(problem.assembled.load)))
    mu, mv = prepared.precondition(u), prepared.precondition(v)
    assert u @ mv == pytest.approx(v @ mu, rel=1e-8)
    assert u @ mu > 0


@pytest.mark.parametrize("method", ["multigrid", "direct"])
def test_loose_plate_is_named(method):
    """Two unconnected squares, one clamped and one without any support."""
    points, triangles = square(24)
    mesh = mesh_of(
        np.concatenate([points, points + [2.0, 0.0]]), np.vstack([triangles, triangles + len(points)])
    )
    problem = plate(mesh, "morley", [ks.Elastic("boundary", 1e-3)])
    problem.forms = problem.forms[:1]  # without the springs nothing is held any more
    space = problem.space
    vertex = space.points[:, 0] < 1.5
    vertex &= np.any((space.points == 0.0) | (space.points == 1.0), axis=1)
    edge = vertex[space.edges].all(axis=1)  # on the boundary, or cutting a corner
    free = np.flatnonzero(~np.concatenate([vertex, edge]))
    clamped = replace(
        space, reduction=space.reduction[:, free], vertex_mask=space.vertex_mask & ~vertex[:, None]
    )
    matrix = problem.assembled.matrix[free][:, free]
    with pytest.raises(SolveError, match=r"1 of 2 unconnected parts.*\(2, 0\) to \(3, 1\).*rigid body"):
        solve_system(matrix, np.ones(len(free)), clamped, method)


def test_many_holes_coarsen_all_the_same():
    """A perforated plate: every hole has corners, and no coarse triangle spans one on the finest level."""
    points, triangles = square(48, 0.0)
    centre = points[triangles].mean(axis=1)
    hole = np.all((centre * 16) % 2 < 0.67, axis=1) & np.all(centre > 0.1, axis=1)
    problem = plate(mesh_of(*cut(points, triangles, ~hole)), "morley", "clamped")
    solution = run(problem)
    assert solution.iterations <= 45
    assert energy_error(problem, solution.x) < 1e-7


def test_aggregation_takes_over_where_coarsening_stalls(monkeypatch):
    monkeypatch.setattr(hierarchy, "STALL", 0.0)
    monkeypatch.setattr(hierarchy, "COARSEST", 1200)
    monkeypatch.setattr(hierarchy, "LARGEST_FACTOR", 10)
    problem = plate(mesh_of(*square(24)), "morley", "mixed")
    solution = run(problem)
    assert solution.name.startswith("multigrid")
    assert "coarsening stalls at 625 vertices" in solution.warnings[0]
    assert "smoothed aggregation" in solution.warnings[1]
    assert energy_error(problem, solution.x) < 1e-7


def test_bad_input_is_named():
    problem, other = (plate(mesh_of(*square(n)), "morley", "clamped") for n in (12, 14))
    a, b = problem.assembled.matrix, problem.assembled.load
    with pytest.raises(InputError, match="same problem"):
        solve_system(a, b, other.space, "multigrid")
    broken = b.copy()
    broken[7] = np.nan
    with pytest.raises(InputError, match="NaN"):
        solve_system(a, broken, problem.space, "multigrid")
    with pytest.raises(InputError, match=r"PlateSpace.lengths has the shape"):
        replace(problem.space, lengths=problem.space.lengths[1:])
    with pytest.raises(InputError, match="no multigrid for the element"):
        replace(problem.space, element="cubic")


def test_progress_is_told_every_iteration():
    problem = plate(mesh_of(*square(20)), "morley", "clamped")
    told = []
    prepared = prepare(problem.assembled.matrix, problem.space, "multigrid")
    solution = prepared.solve(problem.assembled.load, 1e-6, lambda k, error: told.append((k, error)))
    assert [k for k, _ in told] == list(range(solution.iterations + 1))
    assert told[-1][1] == solution.energy_error <= 1e-6
