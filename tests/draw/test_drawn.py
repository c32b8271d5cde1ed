"""Points between nodes in pictures: values of the elements, shapes of edges and surfaces, jumps, ranges."""

import dataclasses

import numpy as np
import pytest

import kshell as ks
from kshell.draw.drawn import MANY, Drawn
from kshell.draw.pictures import picture_values
from kshell.elements.lattice import lattice, numbers, pieces
from tests.plate.test_jumps import halves
from tests.scene.fabricated import square_mesh

STEEL = ks.Isotropic(E=200e9, nu=0.3)
SIDES = ["left", "right", "bottom", "top"]
KINDS = ["morley", "argyris", "hhj", "koiter", "chart"]


def wheel(nodes):
    """A disk of radius 1 with so many nodes around its middle."""
    angle = 2 * np.pi * np.arange(nodes) / nodes
    rim = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    after = 1 + (np.arange(nodes) + 1) % nodes
    triangles = np.stack([np.zeros(nodes, dtype=int), 1 + np.arange(nodes), after], axis=1)
    return ks.Mesh.from_arrays(np.vstack([[0, 0], rim]), triangles, {"rim": triangles[:, 1:]})


def solved(kind, n=4):
    """A clamped square under pressure, flat or as a cylinder of radius 1."""
    scene = ks.Scene(mesh=square_mesh(n), thickness=0.01, material=STEEL, loads=[ks.Pressure("1e3*(1 + x)")])
    scene = dataclasses.replace(
        scene, supports=[ks.Clamped(side) for side in SIDES if side in scene.mesh.groups]
    )
    if kind == "koiter":
        points = scene.mesh.points
        bent = np.stack([np.sin(points[:, 0]), points[:, 1], np.cos(points[:, 0])], axis=1)
        groups = {
            name: scene.mesh.edges[group.members]
            for name, group in scene.mesh.groups.items()
            if group.dimension == 1
        }
        curved = ks.Mesh.from_arrays(bent, scene.mesh.triangles, groups)
        return ks.solve(dataclasses.replace(scene, mesh=curved), error="off", element="koiter", order=3)
    if kind == "chart":
        chart = ks.geometry.Hypar(2.0, 3.0)
        return ks.solve(dataclasses.replace(scene, chart=chart), error="off", large_deflection=False)
    return ks.solve(scene, error="off", element=kind, large_deflection=False)


@pytest.fixture(scope="module", params=KINDS)
def result(request):
    return solved(request.param)


def inside(drawn):
    """Numbers of the nodes that lie on no edge."""
    return np.setdiff1d(np.arange(len(drawn.rest)), drawn.lines)


@pytest.mark.parametrize("parts", [1, 2, 3, 7])
def test_pieces_of_a_lattice_fill_the_triangle(parts):
    xi = lattice(parts)[:, 1:][pieces(parts)]
    a, b = xi[:, 1] - xi[:, 0], xi[:, 2] - xi[:, 0]
    assert a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] == pytest.approx(np.full(parts**2, parts**-2.0))
    corners, edges, rest = numbers(parts)
    assert sorted([*corners, *edges.ravel(), *rest]) == list(range(len(lattice(parts))))
    assert lattice(parts)[corners].tolist() == np.eye(3).tolist()


def test_at_vertices_values_are_those_of_the_fields(result):
    drawn, rows = Drawn(result), len(result.points)
    assert drawn.parts > 1
    assert np.array_equal(drawn.rest[:rows], result.points)
    for what in ("deflection", "moment_xx", "moment_xy", "von_mises_top"):
        shown, fields = drawn.values(what), picture_values(result, what)[0]
        assert np.array_equal(shown[:rows], fields[:rows])
        assert (shown.min(), shown.max()) == (fields.min(), fields.max())


def test_inside_values_are_those_of_the_elements(result):
    drawn = Drawn(result)
    some = inside(drawn)
    exact = result.at(drawn.rest[some])
    largest = np.abs(result.fields["moment"]).max()
    for column, what in enumerate(("moment_xx", "moment_yy", "moment_xy")):
        fields = picture_values(result, what)[0]
        shown, own = drawn.values(what)[some], exact["M"][:, column]
        within = (own >= fields.min()) & (own <= fields.max())
        assert within.mean() > 0.5
        assert np.abs(shown - own)[within].max() < 1e-9 * largest
        assert np.array_equal(shown[~within], np.clip(own, fields.min(), fields.max())[~within])
    moved = drawn.deformed(3.0)[some] - drawn.rest[some]
    assert np.abs(moved - 3.0 * exact["u"]).max() < 1e-9 * np.abs(moved).max()


def test_all_points_lie_on_the_surface(result):
    drawn = Drawn(result)
    assert result.at(drawn.rest)["distance"].max() < 1e-9


@pytest.mark.parametrize("element", ["argyris", "hhj"])
def test_the_middle_of_a_coarse_plate_is_not_the_mean_of_vertices(element):
    result = solved(element, 2)
    drawn = Drawn(result)
    some = inside(drawn)
    own = result.at(drawn.rest[some])["M"][:, 0]
    fields = result.fields["moment"][:, 0]
    clipped = np.clip(own, fields.min(), fields.max())
    assert drawn.values("moment_xx")[some] == pytest.approx(clipped, abs=1e-12 * np.abs(fields).max())
    linear = fields[result.rows.corner] @ lattice(drawn.parts)[numbers(drawn.parts)[2]].T
    assert np.abs(own - linear.ravel()).max() > 0.1 * np.abs(fields).max()


@pytest.mark.parametrize("element", ["argyris", "hhj"])
def test_edges_of_a_disk_of_few_triangles_are_arcs(element):
    scene = ks.Scene(
        mesh=wheel(8),
        thickness=0.01,
        material=STEEL,
        supports=[ks.Clamped("rim")],
        loads=[ks.Pressure(1.0)],
    )
    result = ks.solve(scene, error="off", element=element, large_deflection=False)
    drawn = Drawn(result)
    assert np.linalg.norm(drawn.rest[drawn.lines[result.mesh.boundary_edges]], axis=2) == pytest.approx(
        1.0, abs=1e-6
    )
    corners = drawn.rest[drawn.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    assert normals.min() > 0.0
    assert 0.5 * normals.sum() == pytest.approx(np.pi, rel=2e-3)


def test_steps_stay_steps():
    """M = -(2 - x) by statics on both sides of the step, stresses 6 M / t^2 jump by the square of the thickness."""
    scene = ks.Scene(
        mesh=halves(4, 1, 2.0, 0.5),
        thickness={"A": 2.0, "B": 1.0},
        material=ks.Isotropic(E=12.0, nu=0.0),
        supports=[ks.Clamped("left")],
        loads=[ks.LineForce("right", (0, 0, 1.0))],
    )
    result = ks.solve(scene, error="off", element="argyris", large_deflection=False)
    drawn = Drawn(result)
    x = drawn.rest[drawn.triangles][..., 0]
    exact = 6 * (2 - x) / np.where(x.mean(axis=1) < 1.0, 4.0, 1.0)[:, None]
    assert drawn.values("von_mises_top")[drawn.triangles] == pytest.approx(exact, abs=1e-7)


def test_loaded_results_and_large_meshes_are_drawn_by_their_nodes(tmp_path):
    result = solved("argyris")
    result.save(tmp_path)
    drawn = Drawn(ks.Result.load(tmp_path))
    assert drawn.parts == 1
    assert np.array_equal(drawn.values("moment_xx"), result.fields["moment"][:, 0])
    many = solved("morley", int(np.sqrt(MANY / 2)) + 1)
    assert Drawn(many).parts == 1
