"""Public decks and meshes keep their area, counts, groups and places.

The files belong to others and are not here: public_meshes.json has the repository on GitHub, the path in it, the
checksum, and figures whose areas were also found by other programs (gmsh, meshio, pyNastran, or by hand from the lines
of the deck). KSHELL_PUBLIC_MESHES names a folder that is looked through for files of these checksums.
"""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path

import numpy as np
import pytest

from kshell.mesh import check, read_mesh

PINS = json.loads(Path(__file__).with_name("public_meshes.json").read_text(encoding="utf-8"))
FOLDER = os.environ.get("KSHELL_PUBLIC_MESHES", "")


@pytest.fixture(scope="module")
def files():
    """Files by their checksum."""
    if not FOLDER:
        pytest.skip("KSHELL_PUBLIC_MESHES names no folder with the files")
    names = {pin["name"] for pin in PINS}
    found = [path for path in Path(FOLDER).rglob("*") if path.name in names and path.is_file()]
    return {hashlib.sha256(path.read_bytes()).hexdigest(): path for path in found}


def test_the_table_is_whole():
    assert len({pin["sha256"] for pin in PINS}) == len(PINS) >= 20
    assert {Path(pin["name"]).suffix for pin in PINS} >= {".inp", ".bdf", ".msh", ".stl"}


@pytest.mark.parametrize("pin", PINS, ids=[f"{pin['repository']}/{pin['path']}" for pin in PINS])
def test_pinned(files, pin):
    path = files.get(pin["sha256"])
    if path is None:
        pytest.skip(f"{pin['path']} of github.com/{pin['repository']} is not in {FOLDER}")
    mesh = read_mesh(path)
    assert (len(mesh.triangles), len(mesh.points), mesh.order) == (
        pin["triangles"],
        pin["vertices"],
        pin["order"],
    )
    assert mesh.areas.sum() == pytest.approx(pin["area"], rel=1e-8)
    size = np.linalg.norm(np.subtract(pin["high"], pin["low"]))
    np.testing.assert_allclose(mesh.points.min(axis=0), pin["low"], atol=1e-8 * size)
    np.testing.assert_allclose(mesh.points.max(axis=0), pin["high"], atol=1e-8 * size)
    groups = {group.name: (group.kind, group.members, group.measure) for group in check.summary(mesh).groups}
    for name, (kind, members, measure) in pin["groups"].items():
        assert groups[name] == (kind, members, pytest.approx(measure, rel=1e-8))
