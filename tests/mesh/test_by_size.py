"""Geometry files meshed anew by wanted sizes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import read_mesh
from kshell.mesh.by_size import mesh_by_size, sizes_at_vertices, sizes_of_triangles
from kshell.mesh.quality import quality, summary

NOWHERE = np.zeros((0, 3))
PANEL = """SetFactory("OpenCASCADE");
Point(1) = {1, 0, 0}; Point(2) = {0, 0, 0}; Point(3) = {0, 1, 0}; Circle(1) = {1, 2, 3};
Extrude {0, 0, 1} { Curve{1}; }
Physical Surface("wall") = {1}; Physical Curve("straight") = {2, 3}; Physical Point("corner") = {1};
"""
DISK = """SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 1}; Physical Surface("plate") = {1}; Physical Curve("rim") = {1};
"""
SHIPPED = Path(__file__).parents[2] / "meshes"


def written(folder, text):
    path = folder / "shape.geo"
    path.write_text(text, encoding="utf-8")
    return path


def finer(mesh, path, ratio=0.5, places=NOWHERE):
    sizes = sizes_at_vertices(mesh, ratio * sizes_of_triangles(mesh))
    return mesh_by_size(mesh, sizes, path, mesh.order, places)


def test_areas_tend_to_that_of_the_geometry_and_groups_stay(tmp_path):
    path = written(tmp_path, PANEL)
    mesh = read_mesh(path, 0.8, 2)
    off = []
    for _ in range(3):
        off.append(abs(summary(mesh).area - np.pi / 2))
        assert {g.name: g.kind for g in summary(mesh).groups} == {
            "wall": "surface", "straight": "curve", "corner": "point"
        }  # fmt: skip
        lengths = {g.name: g.measure for g in summary(mesh).groups}
        assert lengths["straight"] == pytest.approx(2.0, rel=1e-12)
        assert quality(mesh).min_angle > 15.0
        mesh = finer(mesh, path)
    assert off[1] < off[0] / 4
    assert off[2] < off[1] / 4
    np.testing.assert_allclose(np.hypot(mesh.midpoints[:, 0], mesh.midpoints[:, 1]), 1.0, atol=1e-7)


def test_sizes_are_met_where_they_are_wanted(tmp_path):
    path = written(tmp_path, PANEL)
    mesh = read_mesh(path, 0.3, 2)
    low = mesh.points[mesh.triangles].mean(axis=1)[:, 2] < 0.4
    wanted = np.where(low, 0.25, 1.0) * sizes_of_triangles(mesh)
    new = mesh_by_size(mesh, sizes_at_vertices(mesh, wanted), path, 2, NOWHERE)
    z, size = new.points[new.triangles].mean(axis=1)[:, 2], sizes_of_triangles(new)
    assert np.median(size[z > 0.8]) > 2.5 * np.median(size[z < 0.2])


@pytest.mark.parametrize("text", [PANEL, DISK])
def test_places_become_vertices_also_along_curves(tmp_path, text):
    path = written(tmp_path, text)
    mesh = read_mesh(path, 0.5, 2)
    s = np.sqrt(0.5)
    inside, on_rim, corner = ([0.36, 0.17, 0.0], [s, s, 0.0], [1.0, 0.0, 0.0])
    if text == PANEL:
        inside = [0.6, 0.8, 0.43]
    new = finer(mesh, path, places=np.array([inside, on_rim, corner, [5.0, 5.0, 5.0]]))
    for at in (inside, on_rim, corner):
        assert np.linalg.norm(new.points - at, axis=1).min() < 1e-12
    assert summary(new).area == pytest.approx(np.pi / (2 if text == PANEL else 1), rel=1e-4)


def test_the_same_sizes_make_the_same_mesh_facing_the_same_way(tmp_path):
    path = written(tmp_path, PANEL)
    mesh = read_mesh(path, 0.5, 2)
    from kshell.mesh.build import reversed_triangles

    turned = reversed_triangles(mesh, np.ones(len(mesh.triangles), dtype=bool))
    outward = []
    for start in (mesh, mesh, turned):
        new = finer(start, path)
        x = new.points[new.triangles]
        n = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        outward.append(np.sign((n * x.mean(axis=1))[:, :2].sum(axis=1)))
        np.testing.assert_array_equal(new.points, finer(mesh, path).points)
    assert (outward[0] == outward[1]).all()
    assert (outward[0] == -outward[2]).all()


def test_what_asks_for_too_much_or_holds_triangles_is_refused(tmp_path):
    path = written(tmp_path, PANEL)
    mesh = read_mesh(path, 0.5, 2)
    with pytest.raises(InputError, match="would make about"):
        finer(mesh, path, ratio=1e-5)
    with pytest.raises(InputError, match="lacks 1 group"):
        finer(read_mesh(written(tmp_path, PANEL.replace("wall", "skin")), 0.5, 2), written(tmp_path, PANEL))
