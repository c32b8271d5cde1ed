"""Curvature of triangle meshes: exact cases, known limits, where it converges and where it does not."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import kshell.geometry as g
from kshell.errors import InputError
from kshell.geometry.discrete import (
    angle_defect,
    area,
    euler_characteristic,
    gaussian_curvature,
    mean_curvature,
    mean_curvature_vector,
    midedge,
    normal_cycle,
    principal,
    total_curvature,
    vertex_areas,
    vertex_normals,
    volume,
)
from verification.geometry.convergence import torus_errors
from verification.geometry.meshes import lantern, mesh_of, random_sphere, vertex_ring

few = settings(max_examples=8, deadline=None, derandomize=True)


# --- exact statements --------------------------------------------------------------------------------


@given(st.integers(0, 10**6))
@few
def test_gauss_bonnet_holds_on_any_mesh(seed: int) -> None:
    assert total_curvature(random_sphere(60, seed)) == pytest.approx(4 * np.pi, rel=1e-12)
    rng = np.random.default_rng(seed)
    for mesh in (
        g.Torus().mesh(12, 8, order=1),
        g.Hypar().mesh(5, 4, order=1),
        g.Cylinder().mesh(8, 3, order=1),
    ):
        shaken = mesh_of(mesh.points + 0.03 * rng.normal(size=mesh.points.shape), mesh.triangles)
        assert total_curvature(shaken) == pytest.approx(2 * np.pi * euler_characteristic(mesh), abs=1e-10)


def test_cube() -> None:
    hull = ConvexHull(np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T)
    x, t = hull.points, hull.simplices.copy()
    outward = (
        np.sum(np.cross(x[t[:, 1]] - x[t[:, 0]], x[t[:, 2]] - x[t[:, 0]]) * (x[t[:, 0]] - 0.5), axis=1) > 0
    )
    t[~outward] = t[~outward][:, ::-1]
    cube = mesh_of(x, t)
    assert area(cube) == pytest.approx(6.0)
    assert volume(cube) == pytest.approx(1.0)
    np.testing.assert_allclose(angle_defect(cube), np.pi / 2, rtol=1e-14)
    for kind in ("mixed", "voronoi", "barycentric"):
        assert vertex_areas(cube, kind).sum() == pytest.approx(6.0)
    whole = normal_cycle(cube, 10.0)  # balls that hold the whole cube
    np.testing.assert_allclose(whole.area, 6.0)
    np.testing.assert_allclose(whole.defect, 4 * np.pi / 6)


@given(st.integers(0, 10**6))
@few
def test_rigid_motion_and_scaling(seed: int) -> None:
    mesh = g.Ellipsoid(3, 2, 1).mesh(10, 7, order=1)
    R = Rotation.random(rng=seed).as_matrix()
    moved = mesh_of(2.0 * mesh.points @ R.T + [5, -3, 1], mesh.triangles)
    np.testing.assert_allclose(gaussian_curvature(moved), gaussian_curvature(mesh) / 4, rtol=1e-9)
    np.testing.assert_allclose(mean_curvature_vector(moved), mean_curvature_vector(mesh) @ R.T / 2, atol=1e-9)
    for method in (principal, lambda m: normal_cycle(m, 0.9 if m is mesh else 1.8)):
        a, b = method(mesh), method(moved)
        np.testing.assert_allclose(b.principal_curvatures, a.principal_curvatures / 2, rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(b.tensor, R @ a.tensor @ R.T / 2, atol=1e-7)
    np.testing.assert_allclose(midedge(moved).tensor, R @ midedge(mesh).tensor @ R.T / 2, atol=1e-9)


def test_turning_the_mesh_over_changes_the_sign() -> None:
    mesh = g.Sphere(2).mesh(12, 8, order=1)
    over = mesh_of(mesh.points, mesh.triangles[:, ::-1])
    assert (mean_curvature(mesh) > 0).all()  # the sphere's normal points inward
    np.testing.assert_allclose(mean_curvature(over), -mean_curvature(mesh), rtol=1e-12)
    np.testing.assert_allclose(gaussian_curvature(over), gaussian_curvature(mesh), rtol=1e-12)
    np.testing.assert_allclose(principal(over).mean_curvature, -principal(mesh).mean_curvature, rtol=1e-9)
    np.testing.assert_allclose(midedge(over).mean_curvature, -midedge(mesh).mean_curvature, rtol=1e-9)
    np.testing.assert_allclose(
        normal_cycle(over, 1.0).mean_curvature, -normal_cycle(mesh, 1.0).mean_curvature, rtol=1e-9
    )


# --- the known limits at one vertex --------------------------------------------------------------------

LIMITS = json.loads((Path(__file__).parent / "valence_limits.json").read_text(encoding="utf-8"))["limits"]
VALENCE = [(ring, bending, limit) for ring, row in LIMITS.items() for bending, limit in row.items()]


@pytest.mark.parametrize(("ring", "bending", "limit"), VALENCE)
def test_angle_defect_tends_to_the_curvature_at_valence_six_only(
    ring: str, bending: str, limit: float
) -> None:
    """Rings such as "n=4,rot pi/n", paraboloids such as "k1=2,k2=1"."""
    n = int(ring[2])
    k1, k2 = (float(part.split("=")[1]) for part in bending.split(","))
    mesh = vertex_ring(n, k1, k2, np.pi / n if ring.endswith("rot pi/n") else 0.0, eta=1e-3)
    value = angle_defect(mesh)[0] / vertex_areas(mesh, "barycentric")[0]
    assert value == pytest.approx(limit, abs=5e-5)
    if n == 6:
        assert value == pytest.approx(k1 * k2, abs=5e-5)


@pytest.mark.parametrize("n", [3, 4, 5, 6, 7, 8, 12])
def test_cotangent_mean_curvature_needs_the_voronoi_area(n: int) -> None:
    mesh = vertex_ring(n, 2.0, 1.0, 0.3, eta=1e-4)
    flat = {3: 3.0, 4: 1.5, 5: 1.145898033750315, 6: 1.0, 7: 0.9239355851097124, 8: 0.8786796564403574,
            12: 0.8038475772933681}  # fmt: skip
    for kind, ratio in (("barycentric", flat[n]), ("voronoi", 1.0)):
        # the vertex is interior although its ring is the boundary
        assert mean_curvature(mesh, kind)[0] / 1.5 == pytest.approx(ratio, rel=1e-5)
    assert np.isnan(mean_curvature(mesh)[1:]).all()


# --- convergence -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def errors() -> dict[str, tuple[dict[str, float], dict[str, float]]]:
    coarse, fine = 18, 36
    return {
        "regular": (torus_errors(coarse), torus_errors(fine)),
        "crossed": (torus_errors(coarse, "crossed", balls=False), torus_errors(fine, "crossed", balls=False)),
        "shaken": (torus_errors(coarse, shake=0.2), torus_errors(fine, shake=0.2)),
    }


# mesh, quantity, least rate: errors fall by 2^rate when the edges are halved
RATES = [
    ("regular", "area", 1.9), ("regular", "defect", 1.8), ("regular", "cotangent", 1.8),
    ("regular", "principal", 1.8), ("regular", "direction", 1.7), ("regular", "midedge_exact", 0.9),
    ("crossed", "area", 1.9), ("crossed", "principal", 1.6), ("crossed", "midedge_exact", 0.9),
    ("shaken", "area", 1.9), ("shaken", "principal", 1.5), ("shaken", "direction", 1.5),
    ("shaken", "midedge_exact", 0.8), ("shaken", "cycle", 0.5), ("regular", "cycle", 0.5),
    ("regular", "cycle_defect", 0.5), ("shaken", "cycle_defect", 0.5),
]  # fmt: skip


@pytest.mark.parametrize(("mesh", "quantity", "rate"), RATES)
def test_converges(errors, mesh: str, quantity: str, rate: float) -> None:
    coarse, fine = errors[mesh]
    assert np.log2(coarse[quantity] / fine[quantity]) > rate


# known not to converge pointwise: the error stays, here above these values
STUCK = [
    ("crossed", "defect", 1.5), ("crossed", "cotangent", 1.0), ("crossed", "midedge_mean", 2.0),
    ("shaken", "defect", 0.2), ("shaken", "cotangent", 0.15), ("shaken", "midedge_mean", 1.5),
]  # fmt: skip


@pytest.mark.parametrize(("mesh", "quantity", "least"), STUCK)
def test_does_not_converge(errors, mesh: str, quantity: str, least: float) -> None:
    coarse, fine = errors[mesh]
    assert fine[quantity] > least
    assert fine[quantity] > 0.6 * coarse[quantity]


def test_random_sphere() -> None:
    """Irregular valences: the fit finds 1/R everywhere, the angle defect over a third of the area does not."""
    mesh = random_sphere(800, seed=1, radius=2.0)
    fit = principal(mesh)
    np.testing.assert_allclose(fit.principal_curvatures, 0.5, atol=0.06)
    assert np.sqrt(np.mean((fit.principal_curvatures - 0.5) ** 2)) < 0.02
    np.testing.assert_allclose(fit.normal, -mesh.points / 2.0, atol=0.02)
    assert np.abs(gaussian_curvature(mesh, "barycentric") - 0.25).max() > 0.1
    balls = normal_cycle(mesh, 0.8)
    assert balls.defect.mean() == pytest.approx(0.25, rel=0.02)
    assert np.sqrt(np.mean((balls.defect - 0.25) ** 2)) < 0.02
    assert np.sqrt(np.mean((balls.principal_curvatures - 0.5) ** 2)) < 0.05


# --- the Schwarz lantern -----------------------------------------------------------------------------------


def test_schwarz_lantern() -> None:
    def exact(n: int, bands: int) -> float:
        return 2 * bands * n * np.sin(np.pi / n) * np.hypot(1 / bands, 1 - np.cos(np.pi / n))

    assert area(lantern(100, 100)) == pytest.approx(6.289795141481573, rel=1e-12)
    assert area(lantern(100, 10000)) == pytest.approx(31.62878916112618, rel=1e-11)
    assert exact(100, 100) == pytest.approx(6.289795141481573, rel=1e-13)
    for n in (8, 16):
        assert area(lantern(n, n**2)) > 4.8 * 2 * np.pi  # tends to 2 pi sqrt(1 + pi^4/4), not to 2 pi
    assert area(lantern(16, 16**3)) > 10 * area(lantern(16, 16))


# --- areas in balls -----------------------------------------------------------------------------------------


def test_area_in_a_ball_is_exact_for_discs() -> None:
    mesh = g.Plane().mesh(11, 7, order=1, pattern="alternate")
    found = normal_cycle(mesh, 0.31)
    x, y, _ = mesh.points.T
    inside = (np.minimum(x, 1 - x) > 0.31) & (np.minimum(y, 1 - y) > 0.31)
    assert inside.sum() > 5
    np.testing.assert_allclose(found.area[inside], np.pi * 0.31**2, rtol=1e-12)
    np.testing.assert_allclose(found.area[(x == 0) & (y == 0)], np.pi * 0.31**2 / 4, rtol=1e-12)
    np.testing.assert_allclose(normal_cycle(mesh, 5.0).area, 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.principal_curvatures, 0.0, atol=1e-14)


def test_normal_cycle_of_a_cylinder() -> None:
    """Curvature across the axis, none along it: directions are not swapped."""
    mesh = g.Cylinder(2.0).mesh(60, 12, order=1, v_range=(0, 4))
    found = normal_cycle(mesh, 0.8)
    middle = np.abs(mesh.points[:, 2] - 2) < 0.5
    np.testing.assert_allclose(found.principal_curvatures[middle], [[0.0, -0.5]] * middle.sum(), atol=0.02)
    np.testing.assert_allclose(np.abs(found.principal_directions[middle, 0, 2]), 1.0, atol=1e-3)


@pytest.mark.parametrize(("degree", "rate"), [(2, 0.9), (3, 1.8), (4, 2.7)])
def test_principal_converges_up_to_the_boundary_with_the_degree(degree: int, rate: float) -> None:
    chart, errors = g.Hypar(1.0, 2.0), []
    for n in (16, 32):
        mesh = chart.mesh(n, n, order=1)
        exact = chart.at(*mesh.points[:, :2].T).principal_curvatures
        errors.append(np.abs(principal(mesh, degree).principal_curvatures - exact).max())
    assert np.log2(errors[0] / errors[1]) > rate
    flat = principal(g.Plane().mesh(5, 5, order=1), degree)
    np.testing.assert_allclose(flat.principal_curvatures, 0.0, atol=1e-12)


# --- midedge ----------------------------------------------------------------------------------------------


def test_midedge_form_with_exact_directors() -> None:
    """For every constant tau: area tau:b = - sum |e| theta tau(mu, mu), and the form in the sides as basis."""
    mesh = random_sphere(40, seed=2)
    middle = mesh.points[mesh.edges].mean(axis=1)
    form = midedge(mesh, -middle / np.linalg.norm(middle, axis=1, keepdims=True))
    x = mesh.points[mesh.triangles]
    basis = np.stack([x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]], axis=1)
    np.testing.assert_allclose(form.second_form, basis @ form.tensor @ np.swapaxes(basis, 1, 2), atol=1e-12)
    np.testing.assert_allclose(np.einsum("tij,tj->ti", form.tensor, form.normal), 0.0, atol=1e-12)
    fine = random_sphere(4000, seed=2)
    middle = fine.points[fine.edges].mean(axis=1)
    form = midedge(fine, -middle / np.linalg.norm(middle, axis=1, keepdims=True))
    np.testing.assert_allclose(form.principal_curvatures, 1.0, atol=0.02)
    assert np.abs(midedge(fine).principal_curvatures - 1.0).max() > 0.3  # mean normals, irregular mesh


def test_midedge_at_a_boundary() -> None:
    mesh = g.Cylinder(2.0).mesh(40, 6, order=1, u_range=(0, 2))
    form = midedge(mesh)
    touches = np.isin(mesh.triangle_edges, mesh.boundary_edges).any(axis=1)
    assert np.isnan(form.mean_curvature[touches]).all()
    assert np.isfinite(form.mean_curvature[~touches]).all()
    with pytest.raises(InputError, match="one for each edge"):
        midedge(mesh, np.zeros((3, 3)))


# --- libigl 2.6.3, of which these are the numbers (verification/geometry/against_libigl.py recomputes them) ---

LIBIGL = {  # vertex: angle defect, mixed Voronoi area, mean curvature vector
    0: (0.021087856493653967, 0.6847689154578853, (0.0, 0.0, -0.38563418982580766)),
    3: (0.2959017463166478, 0.523659984877644, (-1.0471439706558237, 0.0, -1.1246420170131346)),
    25: (0.15243043925922195, 0.6324009119296171, (0.0, -1.099131786319667, -0.8380274542035729)),
    50: (0.01742826444728296, 0.3586177842092281, (0.08502046288051987, 0.0, 0.5078017374136602)),
}


def test_the_numbers_of_libigl() -> None:
    mesh = g.Ellipsoid(3, 2, 1).mesh(12, 8, order=1)
    defect, mixed, vector = angle_defect(mesh), vertex_areas(mesh), mean_curvature_vector(mesh)
    for vertex, (their_defect, their_area, their_vector) in LIBIGL.items():
        assert defect[vertex] == pytest.approx(their_defect, rel=1e-12)
        assert mixed[vertex] == pytest.approx(their_area, rel=1e-12)
        np.testing.assert_allclose(vector[vertex], their_vector, atol=1e-12)


# --- bad meshes --------------------------------------------------------------------------------------------

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
FUNCTIONS = [angle_defect, gaussian_curvature, mean_curvature, midedge, principal, vertex_normals,
             lambda m: normal_cycle(m, 1.0)]  # fmt: skip


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize(
    ("points", "triangles", "message"),
    [
        (SQUARE, [[0, 1, 2], [0, 3, 2]], r"edge at \(0.5, 0.5, 0\) turn opposite ways"),
        (
            np.vstack([SQUARE, [[0.5, 0.5, 1]]]),
            [[0, 1, 2], [0, 2, 3], [0, 2, 4]],
            r"3 triangles meet at \(0.5, 0.5, 0\)",
        ),
        (SQUARE * [1, 0, 0] + [0, 2, 0], [[0, 1, 2]], "belongs to no triangle"),
        (
            np.vstack([SQUARE, [[2, 0, 0]]]),
            [[0, 1, 4], [0, 1, 2], [0, 2, 3]][:2] + [[0, 2, 3]],
            "no area|meet",
        ),
        (np.where(SQUARE == 1, np.nan, SQUARE), [[0, 1, 2], [0, 2, 3]], "vertex 1 is at .*nan"),
        (
            np.vstack([SQUARE, -SQUARE[1:]]),
            [[0, 1, 2], [0, 2, 3], [0, 4, 5], [0, 5, 6]],
            r"touch only in vertex 0",
        ),
    ],
)
def test_meshes_that_are_no_surface_are_refused_with_the_place(function, points, triangles, message) -> None:
    with pytest.raises(InputError, match=message):
        function(mesh_of(points, triangles))


def test_other_bad_requests() -> None:
    mesh = g.Hypar().mesh(3, 3, order=1)
    with pytest.raises(
        InputError, match=r"volume needs a closed surface, but 12 edges are boundary, one of them at \("
    ):
        volume(mesh)
    with pytest.raises(InputError, match="radius = -1"):
        normal_cycle(mesh, -1.0)
    with pytest.raises(InputError, match="degree = 7"):
        principal(mesh, degree=7)
    with pytest.raises(InputError, match="rings = 0"):
        principal(mesh, rings=0)
    with pytest.raises(InputError, match="kind"):
        vertex_areas(mesh, "square")
    tiny = mesh_of(SQUARE, [[0, 1, 2], [0, 2, 3]])
    with pytest.raises(InputError, match="too coarse"):
        principal(tiny)


def test_volume_of_a_ball_converges() -> None:
    inward = [volume(g.Sphere().mesh(2 * n, n, order=1)) for n in (20, 40)]
    errors = np.abs(np.array(inward) + 4 * np.pi / 3)
    assert errors[0] / errors[1] > 3.8
