"""Files as ParaView itself reads them, where it is installed."""

import json
import shutil
import subprocess

import numpy as np
import pytest

import kshell as ks
from kshell.result.pieces import piece_name, piece_of, pieces_index
from kshell.result.vtu import facts, unstructured
from kshell.result.vtu_file import write_triangles
from tests.plate.plates import UNIT, rectangle

PVPYTHON = shutil.which("pvpython")
PROGRAM = """
import json, sys
from paraview.simple import OpenDataFile, XDMFReader, servermanager
out = {}
for path in sys.argv[1:]:
    reader = XDMFReader(FileNames=[path]) if path.endswith(".xdmf") else OpenDataFile(path)
    reader.UpdatePipeline()
    times = list(getattr(reader, "TimestepValues", []))
    if times:
        reader.UpdatePipeline(times[-1])
    data = servermanager.Fetch(reader)
    arrays = data.GetPointData()
    found = [arrays.GetArray(k) for k in range(arrays.GetNumberOfArrays())]
    names = {a.GetName(): [a.GetComponentName(k) for k in range(a.GetNumberOfComponents())] for a in found}
    moved = arrays.GetArray("displacement")
    field = data.GetFieldData()
    out[path] = {
        "names": names, "times": times, "largest": moved.GetRange(-1)[1], "cells": data.GetNumberOfCells(),
        "facts": [field.GetArrayName(k) for k in range(field.GetNumberOfArrays())],
    }
print("FOUND" + json.dumps(out))
"""

pytestmark = [
    pytest.mark.full,
    pytest.mark.skipif(PVPYTHON is None, reason="ParaView is not installed"),
]


def opened(folder, *names):
    program = folder / "program.py"
    program.write_text(PROGRAM, encoding="utf-8")
    paths = [str(folder / name) for name in names]
    done = subprocess.run(
        [PVPYTHON, str(program), *paths],
        capture_output=True,
        text=True,
        timeout=300,
        env={"PATH": "/usr/bin:/bin"},
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.rpartition("FOUND")[2])
    return [found[path] for path in paths]


def largest(result):
    return float(np.linalg.norm(result.fields["displacement"], axis=1).max())


def test_paraview_opens_every_file(tmp_path):
    pytest.importorskip("h5py")
    scene = ks.Scene(
        mesh=rectangle(2),
        title="Strip",
        thickness=0.1,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("left")],
        loads=[ks.LineForce("right", (0, 0, 1e-4))],
    )
    path = ks.trace(scene, steps=3)
    path.save(tmp_path)
    path.save(tmp_path, xdmf=True)
    whole, count = unstructured(path), len(path.mesh.triangles)
    for k in range(2):
        piece = piece_of(whole, np.arange(count) % 2 == k)
        write_triangles(tmp_path / piece_name(k), piece, facts=facts(path))
    (tmp_path / "result.pvtu").write_text(
        pieces_index(whole, [piece_name(0), piece_name(1)]), encoding="utf-8"
    )
    every = opened(tmp_path, "result.vtu", "path.pvd", "series.xdmf", "result.pvtu")
    for one in every:
        assert one["cells"] == count
        assert one["largest"] == pytest.approx(largest(path), rel=1e-12)
    single, steps, series, pieces = every
    for one in (single, steps, pieces):
        assert one["names"]["moment"] == ["xx", "yy", "xy"]
        assert one["names"]["shear"] == ["x", "y"]
        assert {"title: Strip", "analysis: path", f"kshell: {ks.__version__}"} <= set(one["facts"])
    factors = [factor for factor, _ in path.series]
    assert steps["times"] == pytest.approx(factors)
    assert series["times"] == pytest.approx(factors)
