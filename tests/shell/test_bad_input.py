"""Bad shells from the command line: each ends with a message that names it, and the exit code it deserves."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import kshell as ks
from kshell.cli.commands import run
from tests.shell.shapes import panel, strip
from tests.shell.shell_scenes import MESHES

PLATE = panel((0, 0, 0), (1, 0, 0), (0, 1, 0), 4)
SLOPE = panel((0, 0, 0), (1, 0, 0.2), (0, 1, 0), 3)


def two(one, other):
    return np.concatenate([one[0], other[0]]), np.concatenate([one[1], other[1] + len(one[0])])


def flipped(sheet):
    points, triangles = sheet[0], sheet[1].copy()
    triangles[::3] = triangles[::3, ::-1]
    return points, triangles


def moved(sheet, change):
    points = sheet[0].copy()
    change(points)
    return points, sheet[1]


def collapsed(x):
    x[5] = x[6]


def without_a_place(x):
    x[5] = np.nan


def wavy(x):
    """The side y = 0 becomes a curve that lies in no plane."""
    x[:, 2] = 0.3 * np.sin(3 * x[:, 0]) * (1 + x[:, 1])
    x[:, 1] += 0.2 * x[:, 0] ** 2


def tube_with_open_seam():
    angle, n = np.linspace(0, 2 * np.pi, 13), 13
    points = np.array([(np.cos(a), np.sin(a), z) for z in (0.0, 0.5, 1.0) for a in angle])
    first = (np.arange(12) + n * np.arange(2)[:, None]).ravel()[:, None]
    return points, np.concatenate([first + [0, 1, n + 1], first + [0, n + 1, n]])


def mobius():
    mesh = strip(1)
    return mesh.points, mesh.triangles


# groups of curves, by coordinates of the ends before a sheet is bent
LEFT = {"left": lambda x: np.abs(x[..., 0]) < 1e-9}
BOTH = LEFT | {"far": lambda x: np.abs(x[..., 0] - 3) < 1e-9}
STEM = LEFT | {"foot": lambda x: np.abs(np.abs(x[..., 2]) - 1) < 1e-9}
CLAMPED, STEM_CLAMPED = {"left": "clamped"}, {"left": "clamped", "foot": "clamped"}
FLAT = LEFT | {
    "right": lambda x: np.abs(x[..., 0] - 1) < 1e-9,
    "middle": lambda x: np.abs(x[..., 0] - 0.5) < 1e-9,
}

# sheet, groups, supports, exit code, words
CASES = {
    "loose part": (
        two(PLATE, panel((3, 0, 0), (0, 1, 0), (0, 0, 1), 4)), BOTH, CLAMPED, 2,
        r"part of 32 triangles around \(3, 0.5, 0.5\), one of 2 parts\) is not held",
    ),
    "mixed orientation": (
        flipped(SLOPE), LEFT, CLAMPED, 0, "6 of 18 triangles reversed so that neighbours agree",
    ),
    "one-sided": (mobius(), {}, {}, 2, "one-sided"),
    "symmetry on a curve of no plane": (
        moved(panel((0, 0, 0), (1, 0, 0), (0, 1, 0), 8), wavy),
        LEFT | {"front": lambda x: np.abs(x[..., 1] - 0.2 * x[..., 0] ** 2) < 1e-9},
        {"front": "symmetry", "left": "clamped"}, 2, "support symmetry on 'front': .*needs edges in one plane",
    ),
    "crossing": (
        two(PLATE, panel((0.45, 0.2, -1), (0, 0.5, 0), (0, 0, 2), 3)), STEM, STEM_CLAMPED, 0,
        "crosses itself at .*join",
    ),
    "tee not joined": (
        two(PLATE, panel((0.45, 0.2, 0), (0, 0.5, 0), (0, 0, 1), 3)), STEM, STEM_CLAMPED, 0,
        r"touches itself without being joined: 4 vertices .*\(0.45, 0.2\).*join",
    ),
    "tee of doubled vertices": (
        two(PLATE, panel((0.5, 0, 0), (0, 1, 0), (0, 0, 1), 4)), STEM, STEM_CLAMPED, 2,
        "5 pairs of vertices at the same place that are not joined",
    ),
    "sheets upon each other": (
        two(SLOPE, panel((0.1, 0.1, 0.02), (0.8, 0, 0.16), (0, 0.8, 0), 4)), LEFT | {
            "foot": lambda x: np.abs(x[..., 0] - 0.1) < 1e-9
        }, STEM_CLAMPED, 0, "touches itself without being joined",
    ),
    "open seam": (
        tube_with_open_seam(), {"foot": lambda x: x[..., 2] < 1e-9}, {"foot": "clamped"}, 2,
        "pairs of vertices at the same place",
    ),
    "triangle without normal": (moved(SLOPE, collapsed), {}, {}, 2, "2 triangles without area"),
    "node without place": (moved(SLOPE, without_a_place), {}, {}, 2, "coordinates that are not finite"),
    "nothing across the plane": (
        PLATE, FLAT, {"left": "xy", "right": "xy"}, 2, "in 3 ways: it can move along z",
    ),
    "one edge supported": (PLATE, FLAT, {"left": "simply_supported"}, 2, "turn about the axis .* along y"),
    "hinge between supported ends": (
        PLATE, FLAT, {"left": "simply_supported", "right": "simply_supported", "middle": "hinge"}, 2,
        r"can move freely \(it moves most near \(0.5, .*add supports",
    ),
    "no support": (PLATE, {}, {}, 2, "not held: it can move along x, y and z"),
}  # fmt: skip


def write_msh(path, sheet, groups):
    """MSH 2.2 exactly as given, unlike `kshell.mesh.write_msh`, which wants a mesh that is sound."""
    points, triangles = sheet
    flat = ks.Mesh(np.nan_to_num(points), np.asarray(triangles, dtype=np.int32))
    cells = [f"2 2 1 1 {a} {b} {c}" for a, b, c in triangles + 1]
    for number, chosen in enumerate(groups.values(), start=2):
        ends = flat.edges[chosen(flat.points[flat.edges]).all(axis=1)]
        cells += [f"1 2 {number} {number} {a} {b}" for a, b in ends + 1]
    names = ['2 1 "shell"', *(f'1 {k} "{name}"' for k, name in enumerate(groups, start=2))]
    nodes = [f"{k} {x} {y} {z}" for k, (x, y, z) in enumerate(points.tolist(), start=1)]
    blocks = {
        "PhysicalNames": names,
        "Nodes": nodes,
        "Elements": [f"{k + 1} {c}" for k, c in enumerate(cells)],
    }
    text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    for name, lines in blocks.items():
        text += "\n".join([f"${name}", str(len(lines)), *lines, f"$End{name}\n"])
    path.write_text(text, encoding="utf-8")


def scene_text(mesh, supports, more=""):
    text = f'mesh = "{mesh}"\nthickness = 0.01\n[material]\nE = 2.1e11\nnu = 0.3\n'
    for on, kind in supports.items():
        key = "fix" if set(kind) <= set("xyzr") else "kind"
        text += f'[[support]]\non = "{on}"\n{key} = "{kind}"\n'
    text += '[[load]]\nkind = "pressure"\nvalue = 1.0\n[solve]\nmodel = "shell"\nlarge_deflection = false\n'
    return text + more


def said(capsys, *arguments):
    """Exit code and all that was written."""
    code = run([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return code, out + err


@pytest.mark.parametrize("name", CASES)
def test_solve_says_what_is_wrong(tmp_path, capsys, name):
    sheet, groups, supports, code, words = CASES[name]
    write_msh(tmp_path / "bad.msh", sheet, groups)
    scene = tmp_path / "bad.toml"
    scene.write_text(scene_text("bad.msh", supports), encoding="utf-8")
    found, text = said(capsys, "solve", scene, "--json", tmp_path / "out.json")
    flowed = " ".join(text.split())
    assert found == code, flowed
    assert ("error: " in flowed) == (code != 0)
    if code == 0:
        result = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
        flowed = " ".join(result["warnings"] + result["model"]["reasons"])
    else:
        assert not (tmp_path / "out.json").exists()
    assert re.search(words, flowed), flowed


@pytest.mark.parametrize("element", ["koiter", "argyris"])
def test_a_chart_without_normal(tmp_path, capsys, element):
    """Latitudes up to the pole of a sphere: edges shrink to a point there."""
    points, triangles = panel((0, 0, 0), (1, 0, 0), (0, 1.2, 0), 3)
    write_msh(tmp_path / "uv.msh", (points, triangles), LEFT)
    scene = tmp_path / "pole.toml"
    more = f'element = "{element}"\n[chart]\nkind = "sphere"\nR = 1.0\n'
    scene.write_text(scene_text("uv.msh", CLAMPED, more), encoding="utf-8")
    code, text = said(capsys, "solve", scene)
    assert code == 2
    assert "3 edges to single points" in " ".join(text.split())


def test_a_thick_shell_is_warned_of_with_numbers(tmp_path, capsys):
    scene = tmp_path / "thick.toml"
    hook = (
        (MESHES / "raasch_hook.toml")
        .read_text(encoding="utf-8")
        .replace("raasch_hook.msh", str(MESHES / "raasch_hook.msh"))
    )
    scene.write_text(hook, encoding="utf-8")
    code, text = said(capsys, "solve", scene, "--set", "thickness=8.0")
    assert code == 0
    assert "thickness 8 is more than half of the radius of curvature 13.9" in " ".join(text.split())


def test_a_cylinder_on_a_plate_touches_it_and_joined_sheets_do_not():
    from kshell.shell.shape_checks import contacts

    plate = panel((-2, 0, -1), (4, 0, 0), (0, 4, 0), 5)
    angle = np.linspace(0, 2 * np.pi, 25)[:-1] - np.pi / 2
    points = np.array([(np.cos(a), y, np.sin(a)) for y in (0.5, 1.1, 1.7) for a in angle])
    first = np.arange(24)
    side = (first + 1) % 24
    ring = np.concatenate(
        [np.stack(t, axis=1) for t in ((first, side, side + 24), (first, side + 24, first + 24))]
    )
    mesh = ks.Mesh.from_arrays(*two(plate, (points, np.concatenate([ring, ring + 24]))))
    vertices, _ = contacts(mesh)
    np.testing.assert_allclose(
        mesh.points[np.unique(vertices)], [[0, y, -1] for y in (0.5, 1.1, 1.7)], atol=1e-12
    )
    for name in ("box_girder", "scordelis_lo", "hemisphere"):
        assert not len(contacts(ks.mesh.read_mesh(MESHES / f"{name}.msh"))[0])
