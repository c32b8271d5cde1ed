"""Scenes as .inp files: what they say, what they refuse, and where CalculiX is at hand what it answers."""

import re
import shutil
import subprocess

import numpy as np
import pytest

import kshell as ks
from kshell.cli.commands import run
from kshell.export.forces import nodal_forces
from kshell.export.nodes import Nodes
from kshell.scene.structure import resolve

STEEL = ks.Isotropic(E=210e9, nu=0.3, density=7850)


def plate(**given):
    return ks.Scene(
        **{
            "mesh": ks.geometry.Plane().mesh(20, 20, order=1, u_range=(0, 1), v_range=(0, 1)),
            "thickness": 0.01,
            "material": STEEL,
            "supports": [ks.Clamped("u0"), ks.SimplySupported(["u1", "v0", "v1"])],
            "loads": [ks.Pressure("-1e4*(1 + x)")],
            "probes": {"centre": (0.5, 0.5, 0.0)},
            **given,
        }
    )


def blocks(path):
    """Keyword lines of a file, each with its data lines."""
    out = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("*") and not line.startswith("**"):
            out.append((line, []))
        elif not line.startswith("**"):
            out[-1][1].append(line)
    return out


def test_the_file_has_the_mesh_and_the_resultant(tmp_path):
    scene = plate()
    ks.write_inp(scene, tmp_path / "plate.inp")
    found = dict(blocks(tmp_path / "plate.inp"))
    assert len(found["*ELEMENT, TYPE=S6, ELSET=EALL"]) == 800
    assert found["*ELASTIC"] == ["210000000000, 0.3"]
    loads = np.array([[float(part) for part in line.split(",")] for line in found["*CLOAD, OP=NEW"]])
    assert loads[loads[:, 1] == 3, 2].sum() == pytest.approx(-1.5e4, rel=1e-12)


@pytest.mark.parametrize(
    ("load", "force", "moment"),
    [
        (ks.Gravity((0, 0, -9.81)), (0, 0, -78.5 * 9.81), (-78.5 * 9.81 / 2, 78.5 * 9.81 / 2, 0)),
        (ks.LineForce("u1", (0, 0, "2*y")), (0, 0, 1), (2 / 3, -1, 0)),
        (ks.EdgeMoment("u1", 7.0), (0, 0, 0), (0, 7, 0)),
        (ks.EdgeMoment("v0", 7.0), (0, 0, 0), (7, 0, 0)),
        (ks.EdgeMoment("v1", 7.0), (0, 0, 0), (-7, 0, 0)),
        (ks.PointForce((1, 1, 0), (0, 0, 5)), (0, 0, 5), (5, -5, 0)),
        (ks.PointMoment((1, 1, 0), (3, 4, 0)), (0, 0, 0), (3, 4, 0)),
        (ks.Snow(100.0), (0, 0, -100), (-50, 50, 0)),
    ],
    ids=lambda value: getattr(value, "kind", ""),
)
def test_resultants(load, force, moment):
    scene = plate(loads=[load], supports=[ks.Clamped("u0")])
    structure = resolve(scene, scene.read_mesh())
    nodes = Nodes.of(structure.space)
    (found,) = nodal_forces(structure, nodes)
    np.testing.assert_allclose(found[:, :3].sum(axis=0), force, atol=1e-9)
    arm = np.cross(nodes.points, found[:, :3]).sum(axis=0)
    np.testing.assert_allclose(arm + found[:, 3:].sum(axis=0), moment, atol=1e-9)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"material": ks.Orthotropic(E1=1e9, E2=2e9, nu12=0.1, G12=3e8)}, "isotropic"),
        ({"thickness": "0.01*(1 + x)"}, "varies"),
        ({"supports": [ks.Clamped("u0"), ks.Elastic("plane", 1e6)]}, "elastic"),
        ({"loads": [ks.Temperature(gradient=1.0, expansion=1e-5)]}, "no counterpart"),
        ({"loads": [ks.Pressure(1.0, follower=True)]}, "follower"),
        ({"supports": [ks.Fixed("u0", "xyzr", axes=[[1, 1, 0], [-1, 1, 0], [0, 0, 1]])]}, "own axes"),
    ],
)
def test_refusals(given, words, tmp_path):
    if "supports" in given and "plane" in str(given["supports"][-1].on):
        given["supports"][-1] = ks.Elastic("u1", 1e6)
    with pytest.raises(ks.InputError, match=words):
        ks.write_inp(plate(**given), tmp_path / "no.inp")
    assert not (tmp_path / "no.inp").exists()


def test_wrong_names(tmp_path, capsys):
    with pytest.raises(ks.InputError, match="inp"):
        ks.write_inp(plate(), tmp_path / "no.txt")
    assert run(["export", "meshes/disk.msh", str(tmp_path / "no.inp")]) == 2
    assert "scene file" in capsys.readouterr().err


def test_command_and_cases(tmp_path):
    assert run(["export", "meshes/plate_cases.toml", str(tmp_path / "cases.inp")]) == 0
    scene = ks.Scene.load("meshes/plate_cases.toml")
    steps = [line for line, _ in blocks(tmp_path / "cases.inp") if line.startswith("*STEP")]
    assert len(steps) == len(scene.cases) + len(scene.combinations)


def displacement(path):
    """Displacements by node number of the last step of a .frd file."""
    text = path.read_text(encoding="utf-8")
    part = text[text.rindex("DISP") :]
    rows = re.findall(r"^ -1 *(\d+)(.{12})(.{12})(.{12})", part[: part.index(" -3")], re.MULTILINE)
    return {int(number): np.array([float(v) for v in values]) for number, *values in rows}


CALCULIX = shutil.which("ccx")


@pytest.mark.skipif(CALCULIX is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("name", ["plate", "roof"])
def test_calculix_agrees(name, tmp_path):
    if name == "plate":
        scene = plate()
    else:
        roof = ks.geometry.Chart.from_expressions("25*sin(u)", "v", "25*cos(u)")
        scene = ks.Scene(
            mesh=roof.mesh(8, 8, u_range=(0, np.radians(40)), v_range=(0, 25), pattern="alternate"),
            thickness=0.25,
            material=ks.Isotropic(E=4.32e8, nu=0.0),
            supports=[ks.Symmetry(["u0", "v0"]), ks.Fixed("v1", "xz")],
            loads=[ks.Traction((0, 0, -90))],
        )
    ks.write_inp(scene, tmp_path / "case.inp")
    subprocess.run([CALCULIX, "case"], cwd=tmp_path, check=True, capture_output=True)
    there = displacement(tmp_path / "case.frd")
    result = ks.solve(scene, error="off", large_deflection=False)
    u = result.fields["displacement"][: len(result.mesh.points)]
    k = int(np.argmax(np.linalg.norm(u, axis=1)))
    np.testing.assert_allclose(there[k + 1], u[k], atol=0.02 * np.linalg.norm(u[k]))


def test_numbers_are_short_enough_for_their_fields(tmp_path):
    """CalculiX reads 20 characters of a field; coordinates that are nothing but rounding have many digits."""
    mesh = ks.geometry.Plane().mesh(2, 2, order=1, u_range=(0, 1), v_range=(0, 1))
    points = mesh.points.copy()
    points[np.abs(points[:, 1]) < 1e-9, 1] = -7.347880794884123e-17
    groups = {name: mesh.edges[group.members] for name, group in mesh.groups.items() if group.dimension == 1}
    scene = plate(mesh=ks.Mesh.from_arrays(points, mesh.triangles, groups), thickness=1 / 30)
    ks.write_inp(scene, tmp_path / "plate.inp")
    fields = [
        part.strip()
        for _, lines in blocks(tmp_path / "plate.inp")
        for line in lines
        for part in line.split(",")
    ]
    assert any(part.startswith("-7.34788079488") for part in fields)
    assert max(map(len, fields)) <= 20
