"""Triangles of order 3 and 4 in files of gmsh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.build import reversed_triangles
from kshell.mesh.higher import higher_nodes, lattice, nodes_along, order_of
from kshell.mesh.order import in_spatial_order
from kshell.mesh.read import read_mesh
from kshell.mesh.refine import bisect, longest_first
from kshell.mesh.slit import slit
from kshell.mesh.triangulation import Higher
from kshell.plate.domain import Domain
from kshell.shell.koiter.surface import Surface
from tests.mesh.mesh_samples import msh2_text
from tests.plate.plates import disk, egg, on_egg

SQUARE = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], dtype=float)
TRIANGLES = [(0, 1, 2), (1, 3, 2)]


def along(corners, degree):
    """Vertices, then edge by edge, then inside, as gmsh has them."""
    a, b, c = corners
    out = [a, b, c]
    for start, end in ((a, b), (b, c), (c, a)):
        out += [start + (end - start) * k / degree for k in range(1, degree)]
    return out


def height(x):
    """A cubic in space."""
    return 0.2 * x[0] ** 3 - 0.3 * x[0] * x[1] ** 2 + 0.1 * x[0] * x[1]


# barycentric coordinates of the nodes inside, as gmsh has them
INSIDE = {0: (), 1: ((1 / 3, 1 / 3, 1 / 3),), 3: ((0.5, 0.25, 0.25), (0.25, 0.5, 0.25), (0.25, 0.25, 0.5))}


def written(order, kind, line, inside, height=height):
    """Two triangles on a cubic surface, and a line of the same order."""
    number, points = {}, []

    def tag(x):
        key = tuple(np.round(x, 9))
        if key not in number:
            points.append((*x, height(x)))
            number[key] = len(points)
        return number[key]

    cells = []
    for corners in TRIANGLES:
        x = SQUARE[list(corners)]
        places = along(x, order) + [np.array(b) @ x for b in INSIDE[inside]]
        cells.append(f"{kind} 1 " + " ".join(str(tag(place)) for place in places))
    side = [SQUARE[0], SQUARE[1], *(SQUARE[0] + (SQUARE[1] - SQUARE[0]) * k / order for k in range(1, order))]
    cells.append(f"{line} 2 " + " ".join(str(tag(place)) for place in side))
    return msh2_text(points, cells)


@pytest.mark.parametrize(
    ("order", "kind", "line", "inside"), [(3, 21, 26, 1), (3, 20, 26, 0), (4, 23, 27, 3), (4, 22, 27, 0)]
)
def test_middles_of_edges_lie_on_the_surface(tmp_path, order, kind, line, inside):
    path = tmp_path / "high.msh"
    path.write_text(written(order, kind, line, inside), encoding="utf-8")
    mesh = read_mesh(path)
    assert (len(mesh.points), len(mesh.triangles), len(mesh.edges), mesh.order) == (4, 2, 5, 2)
    middle = mesh.points[mesh.edges].mean(axis=1)[:, :2]
    assert mesh.midpoints[:, :2] == pytest.approx(middle, abs=1e-14)
    assert mesh.midpoints[:, 2] == pytest.approx(height(middle.T), abs=1e-14)
    assert any(f"order {order}" in note for note in mesh.notes)
    assert sorted(len(group.members) for group in mesh.groups.values()) == [1, 2]


def quartic(x):
    return height(x) + 0.3 * x[0] ** 4 - 0.2 * x[0] ** 2 * x[1] ** 2 + 0.1 * x[1] ** 3 * x[0]


def bowl(x):
    return 0.3 * x[0] ** 2 - 0.2 * x[0] * x[1] + 0.1 * x[1] ** 2


@pytest.mark.parametrize(
    ("kind", "shape"),
    [("3 21 26 1", height), ("3 20 26 0", bowl), ("4 23 27 3", quartic), ("4 22 27 0", bowl)],
)
def test_shells_have_the_order_of_the_file(tmp_path, kind, shape):
    """Polynomials of the order are known everywhere; where there are no nodes inside, quadratics are."""
    path = tmp_path / "high.msh"
    path.write_text(written(*map(int, kind.split()), shape), encoding="utf-8")
    mesh = read_mesh(path)
    assert order_of(mesh) == int(kind[0])
    assert f"order {kind[0]}" in repr(mesh)
    for order in (2, 4):
        x = Surface(mesh, order).nodes
        assert x[:, 2] == pytest.approx(shape(x.T), abs=1e-14)
    between = nodes_along(mesh, np.arange(len(mesh.edges)))
    ends = mesh.points[mesh.edges]
    share = np.arange(1, order_of(mesh))[:, None] / order_of(mesh)
    chord = (1 - share) * ends[:, :1] + share * ends[:, 1:]
    assert between[..., :2] == pytest.approx(chord[..., :2], abs=1e-14)
    assert between[..., 2] == pytest.approx(shape(between.transpose(2, 0, 1)), abs=1e-14)


def cylinder(order, n=3):
    """A quarter of a tube as a mesh of an order."""
    flat = ks.geometry.Plane().mesh(n, n)
    groups = {
        name: (flat.edges[group.members]) for name, group in flat.groups.items() if group.dimension == 1
    }

    def on(u):
        return np.stack([np.sin(u[..., 0]), u[..., 1], np.cos(u[..., 0])], axis=-1)

    middles = flat.points[flat.edges].mean(axis=1)
    mesh = ks.Mesh.from_arrays(on(flat.points), flat.triangles, groups, on(middles))
    nodes = on(np.einsum("nc,tcx->tnx", lattice(order) / order, flat.points[flat.triangles]))
    nodes[:, :3] = mesh.points[mesh.triangles]
    return replace(mesh, higher=Higher(order, nodes))


@pytest.mark.parametrize("order", [3, 4])
def test_nodes_stay_where_triangles_are_renumbered_turned_or_torn(order):
    mesh = cylinder(order)
    crosswise = np.ptp(mesh.points[mesh.edges][:, :, 1], axis=1) < 1e-9
    inner = np.flatnonzero((mesh.edge_counts == 2) & crosswise)
    some = replace(
        mesh, groups={**mesh.groups, "slit": replace(next(iter(mesh.groups.values())), members=inner)}
    )
    odd = np.arange(len(mesh.triangles)) % 2 == 1
    known = np.sort(Surface(mesh, order).nodes.round(12), axis=0)
    torn = slit(some, "slit")
    assert len(torn.points) > len(mesh.points)
    for other in (in_spatial_order(mesh)[0], longest_first(mesh), reversed_triangles(mesh, odd), torn):
        x = higher_nodes(other)
        assert x[:, :3] == pytest.approx(other.points[other.triangles], abs=0)
        places = np.einsum("nc,tcx->tnx", lattice(order) / order, other.points[other.triangles])
        assert np.abs(x - places).max() < 0.1
        if other is not torn:
            assert np.sort(Surface(other, order).nodes.round(12), axis=0) == pytest.approx(known, abs=2e-12)
    assert order_of(bisect(mesh, np.array([0])).mesh) == 2
    assert order_of(replace(mesh, points=mesh.points + 1e-9)) == 2


def test_a_roof_of_cubic_triangles_is_the_one_on_its_chart():
    """A quarter of a cylinder; the normals at its held edges are those of all its nodes, too."""
    mesh = cylinder(3)
    flat = ks.geometry.Plane().mesh(3, 3)
    chart = ks.geometry.Chart.from_expressions("sin(u)", "v", "cos(u)")
    found = []
    for what in (
        {"mesh": mesh},
        {"mesh": replace(flat, groups=mesh.groups), "chart": chart},
        {"mesh": replace(mesh, higher=None)},
    ):
        scene = ks.Scene(
            **what,
            thickness=0.01,
            material=ks.Isotropic(E=1e9, nu=0.3),
            supports=[ks.Fixed("v0", "xz"), ks.Symmetry("v1"), ks.Symmetry("u0")],
            loads=[ks.Traction((0, 0, -1.0))],
        )
        found.append(
            ks.solve(scene, order=3, element="koiter", large_deflection=False, error="off").strain_energy
        )
    assert found[0] == pytest.approx(found[1], rel=1e-6)
    assert abs(found[2] / found[1] - 1) > 1e-5


def test_edges_of_plates_have_the_nodes_of_the_file():
    """An egg of 18 edges: its area with 1, 2 and 3 nodes for each."""
    exact = Domain(egg(18), curved=True).area
    straight, middles = egg(3), egg(3, 2)
    errors = [abs(Domain(mesh, curved=True).area / exact - 1) for mesh in (straight, middles)]
    nodes = np.einsum("nc,tcx->tnx", lattice(3) / 3, disk(3).points[straight.triangles])
    rim = np.zeros(len(nodes), dtype=bool)
    for triangle, edge in straight.edge_owner[straight.boundary_edges]:
        on = nodes[triangle, 3 + 2 * edge : 5 + 2 * edge]
        on /= np.linalg.norm(on, axis=1, keepdims=True)
        rim[triangle] = True
    shape = nodes.shape
    nodes[rim] = on_egg(nodes[rim].reshape(-1, 3)).reshape(-1, *shape[1:])
    nodes[:, :3] = straight.points[straight.triangles]
    third = replace(middles, higher=Higher(3, nodes))
    assert nodes_along(third, third.boundary_edges).shape == (18, 2, 3)
    errors.append(abs(Domain(third, curved=True).area / exact - 1))
    assert errors[1] < 0.1 * errors[0]
    assert errors[2] < 0.1 * errors[0]  # as many derivatives at the ends are what limits both
