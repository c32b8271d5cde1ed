"""Closest points of meshes: against points sampled on all triangles, on many sheets of very different triangles."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import kshell as ks
from kshell.mesh import feet
from kshell.mesh.closest import Locator


def sheet(n, z, size=1.0, order=1, bend=0.0):
    """A square of n x n cells at a height, bent to a parabola."""
    x = np.linspace(0, size, n + 1)
    points = np.stack([*np.meshgrid(x, x), np.zeros((n + 1, n + 1))], axis=-1).reshape(-1, 3)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    triangles = np.concatenate([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])

    def lift(p):
        return p + (z + bend * p[:, 0] * (size - p[:, 0]))[:, None] * [0, 0, 1]

    mesh = ks.Mesh.from_arrays(lift(points), triangles)
    if order == 1:
        return mesh
    middle = points[mesh.edges].mean(axis=1)
    return ks.Mesh.from_arrays(lift(points), triangles, midpoints=lift(middle))


def sampled(nodes, points, n=40):
    """Distances from samples of all triangles, and by how much they may be too large."""
    at = np.array([(i / n, j / n) for i in range(n + 1) for j in range(n + 1 - i)])
    whole = np.moveaxis(nodes, 0, 2)
    samples = np.concatenate([feet.place(whole, np.tile(rs[:, None], (1, whole.shape[2]))).T for rs in at])
    reach = 2 * np.linalg.norm(nodes - nodes[:, :1], axis=2).max() / n
    return cKDTree(samples).query(points)[0], reach


def test_two_sheets_of_coarse_and_fine_triangles():
    coarse, fine = sheet(1, 0.0), sheet(20, 0.05)
    nodes = np.concatenate([m.points[m.triangles] for m in (coarse, fine)])
    points = np.random.default_rng(1).uniform(0, 1, (5000, 3)) * [1, 1, 0.05]
    points[:, 2] *= 0.499  # nearer to the coarse one
    found = Locator(nodes).find(points)
    assert (found.triangles < len(coarse.triangles)).all()
    assert np.allclose(found.distance, points[:, 2], rtol=0, atol=1e-15)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("seed", range(4))
def test_random_sheets_against_samples(order, seed):
    random = np.random.default_rng(seed)
    nodes = []
    for _ in range(6):
        n = int(random.integers(1, 9))
        m = sheet(n, 0.0, random.uniform(0.1, 2), order, random.uniform(-0.8, 0.8))
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
        corners = m.points[m.triangles]
        if order == 2:
            corners = np.concatenate([corners, m.midpoints[m.triangle_edges]], axis=1)
        nodes.append(corners @ turn + random.uniform(-1, 1, 3))
    nodes = np.concatenate(nodes)
    points = random.normal(size=(400, 3)) * random.choice([0.3, 1.0, 20.0], (400, 1))
    found = Locator(nodes).find(points)
    best, reach = sampled(nodes, points)
    assert (found.distance <= best + 1e-12).all()
    assert (found.distance >= best - reach).all()
    there = feet.place(np.moveaxis(nodes[found.triangles], 0, 2), found.xi.T).T
    assert np.allclose(there, found.x, rtol=0, atol=1e-13)
    assert np.allclose(np.linalg.norm(found.x - points, axis=1), found.distance, rtol=0, atol=1e-13)
    assert (found.xi >= 0).all()
    assert (found.xi.sum(axis=1) <= 1 + 1e-15).all()


def test_foot_is_at_a_right_angle_inside_triangles():
    """On a finely meshed torus the way to the foot is normal to the surface of the triangle."""
    mesh = ks.geometry.Torus(2, 0.7).mesh(60, 40)
    random = np.random.default_rng(3)
    start = mesh.points[random.integers(len(mesh.points), size=300)]
    points = start + random.normal(size=start.shape) * 0.1
    locator = Locator.of(mesh)
    found = locator.find(points)
    inside = np.minimum(found.xi.min(axis=1), 1 - found.xi.sum(axis=1)) > 1e-3
    assert inside.sum() > 200
    step = 1e-6
    whole = locator.nodes[:, :, found.triangles]
    for direction in ([step, 0], [0, step]):
        ahead = feet.place(whole, (found.xi + direction).T).T
        back = feet.place(whole, (found.xi - direction).T).T
        tangent = (ahead - back) / (2 * step)
        slope = ((points - found.x) * tangent).sum(axis=1)
        assert np.abs(slope[inside]).max() < 1e-8


def test_centre_of_a_coarse_sphere():
    """All triangles are nearly equally far from there: none of them may be left out."""
    points = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]]
    flat = ks.Mesh.from_arrays(points, triangles)
    middle = points[flat.edges].mean(axis=1)
    middle *= np.sqrt(2) * np.where(np.arange(len(middle)) == 5, 0.9, 1.0)[:, None]
    mesh = ks.Mesh.from_arrays(points, triangles, midpoints=middle)
    found = Locator.of(mesh).find(np.zeros((1, 3)))
    best, reach = sampled(np.moveaxis(Locator.of(mesh).nodes, 2, 0), np.zeros((1, 3)), 200)
    assert best[0] - reach <= found.distance[0] <= best[0]


def test_answer_does_not_depend_on_numbering():
    """Points on common edges, at vertices, and half way between two sheets."""
    one, two = sheet(6, 0.0), sheet(6, 0.2)
    nodes = np.concatenate([m.points[m.triangles] for m in (one, two)])
    points = np.concatenate([one.points, one.points[one.edges].mean(axis=1), one.points + [0, 0, 0.1]])
    order = np.random.default_rng(5).permutation(len(nodes))
    first, second = Locator(nodes).find(points), Locator(nodes[order]).find(points)
    assert (first.triangles == order[second.triangles]).all()
    assert (first.x == second.x).all()


def test_nodes_of_strongly_bent_triangles_lie_on_them():
    """Triangles that turn by up to 90 degrees: of those that share a node the one with the least centroid."""
    sphere = ks.geometry.Sphere(1.0).mesh(4, 2, order=2, u_range=(0.3, 2 * np.pi + 0.3), v_range=(0.4, 2.6))
    nodes = np.concatenate([sphere.points[sphere.triangles], sphere.midpoints[sphere.triangle_edges]], axis=1)
    rank = np.argsort(np.lexsort(nodes[:, :3].mean(axis=1).T[::-1]))
    for points, numbers in (
        (sphere.points, sphere.triangles),
        (sphere.midpoints, sphere.triangle_edges),
    ):
        found = Locator(nodes).find(points)
        assert found.distance.max() < 1e-12
        for number, triangle in enumerate(found.triangles):
            around = np.flatnonzero((numbers == number).any(axis=1))
            assert triangle == around[np.argmin(rank[around])]


def test_few_and_many_points_agree():
    mesh = ks.geometry.Torus(2, 0.7).mesh(30, 20)
    points = np.random.default_rng(7).normal(size=(50, 3)) * 2
    many = Locator.of(mesh).find(points)
    for k, point in enumerate(points):
        single = Locator.of(mesh).find(point[None])
        assert single.distance[0] == pytest.approx(many.distance[k], abs=1e-13)
        assert np.allclose(single.x[0], many.x[k], atol=1e-7)


def test_values_come_from_the_nearest_sheet():
    """A clamped strip under a loaded one: values at points just over the lower one are its own."""
    low, high = sheet(1, 0.0), sheet(20, 0.05)
    points = np.concatenate([low.points, high.points])
    triangles = np.concatenate([low.triangles, high.triangles + len(low.points)])
    groups = {
        "low": low.triangles,
        "high": high.triangles + len(low.points),
        "edge": high.edges[high.boundary_edges] + len(low.points),
        "rim": low.edges[low.boundary_edges],
    }
    mesh = ks.Mesh.from_arrays(points, triangles, groups)
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1e9, nu=0.3),
        supports=[ks.Clamped("edge"), ks.Clamped("rim")],
        loads=[ks.Pressure(1.0, "high")],
    )
    result = ks.solve(scene, large_deflection=False)
    at = result.at([[0.5, 0.5, 0.024], [0.5, 0.5, 0.026]])
    assert np.allclose(at["x"][:, 2], [0.0, 0.05], atol=1e-6)
    assert abs(at["u"][0, 2]) < 1e-3 * abs(at["u"][1, 2])
