"""The meshes in meshes/ are sound, small, and agree with the geometry beside them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kshell.mesh import check, read_mesh

FOLDER = Path(__file__).parents[2] / "meshes"

# order, area of the geometry
SHIPPED = {
    "plate": (1, 1.5 - np.pi * 0.2**2),
    "unit_square": (1, 1.0),
    "disk": (1, np.pi),
    "disk_order2": (2, np.pi),
    "l_shape": (1, 3.0),
    "annulus": (2, np.pi * (1 - 0.4**2)),
    "skew_plate": (1, 0.5),
    "sector": (2, np.pi / 6),
    "ellipse": (2, 2 * np.pi),
}


# surfaces in space and parameter planes of charts
SURFACES = {
    "scordelis_lo": (2, 25 * np.radians(40) * 25),
    "pinched_cylinder": (2, 150 * np.pi * 300),
    "hemisphere_hole": (2, 50 * np.pi * np.cos(np.radians(18))),
    "hemisphere": (2, 50 * np.pi),
    "raasch_hook": (2, 20 * (14 * np.pi / 3 + 46 * 5 * np.pi / 6)),
    "hypar": (2, 0.6401),
    "pressurised_sphere": (2, np.pi / 2),
    "box_girder": (1, 4 * (4 * 1 + 3 * 0.6)),
    "twisted_beam": (1, 1.1 * np.pi / 2),
    "tube": (1, np.pi / 2),
    "sphere_edge": (1, np.pi / 2 * np.pi / 3),
    "can": (2, np.pi * 0.033 * 0.06),
    "roof": (2, 254 * 254),
    "strip": (1, 0.4 * 0.05),
    "kirigami": (1, 0.03),
    "table": (1, 0.65 * (0.65 + 4 * 0.8)),
}


@pytest.mark.parametrize("name", SURFACES)
def test_surfaces(name):
    order, area = SURFACES[name]
    path = FOLDER / f"{name}.msh"
    assert path.stat().st_size < 200_000
    assert path.with_suffix(".geo").exists()
    mesh = read_mesh(path)
    assert mesh.order == order
    assert check.summary(mesh).area == pytest.approx(area, rel=1e-3)
    assert all(len(group.members) for group in mesh.groups.values())


def test_all_are_listed():
    assert {path.stem for path in FOLDER.glob("*.msh")} >= {*SHIPPED, *SURFACES}


@pytest.mark.parametrize("name", SHIPPED)
def test_sound(name):
    order, area = SHIPPED[name]
    path = FOLDER / f"{name}.msh"
    assert path.stat().st_size < 150_000
    mesh = read_mesh(path)
    check.plate_problems(mesh)
    assert mesh.notes == ()
    assert mesh.order == order
    assert check.summary(mesh).area == pytest.approx(area, rel=1e-5 if order == 2 else 4e-3)
    assert check.quality(mesh).min_angle > 29.9
    assert all(len(group.members) for group in mesh.groups.values())


@pytest.mark.parametrize("name", ["plate", "annulus", "disk_order2"])
def test_made_from_the_geometry_beside_it(name):
    shipped = read_mesh(FOLDER / f"{name}.msh")
    fresh = read_mesh(FOLDER / f"{name.removesuffix('_order2')}.geo", mesh_order=shipped.order)
    assert list(fresh.groups) == list(shipped.groups)
    for ours, theirs in zip(check.summary(fresh).groups, check.summary(shipped).groups, strict=True):
        assert ours.measure == pytest.approx(theirs.measure, rel=1e-3)
