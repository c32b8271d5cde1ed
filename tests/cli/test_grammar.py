"""Scenes by a grammar: every key valid in itself, together extreme or contradictory.

Whatever they are, the command line answers with exit code 0, 1 or 2, one line of error and no traceback. The seeds are
fixed: a scene that fails can be made again from its number.
"""

from __future__ import annotations

import json
import random
import sys
from pathlib import Path

import numpy as np
import pytest

from kshell.cli.commands import run
from kshell.mesh import read_mesh
from kshell.mesh.mesh import Mesh

MESHES = Path(__file__).parents[2] / "meshes"
SMALL = ("unit_square", "disk_order2", "annulus", "scordelis_lo", "raasch_hook", "box_girder")
LONGEST = 1500  # characters of any message
Scene = dict[str, object]


def number(r: random.Random, base: float) -> float:
    return r.choice([base] * 60 + [base * f for f in (1e3, 1e-3, 1e8, 1e-8, -1.0, 0.0, 1e20, 1e-20)])


def vector(r: random.Random, base: float) -> list[float | str]:
    return [
        r.choice([0, number(r, base), f"{base}*x", f"{base}*sin(y)", f"{base}*(x>0.5)"]) for _ in range(3)
    ]


def scalar(r: random.Random, base: float) -> float | str:
    return r.choice([number(r, base), f"{base}*(1+x**2)", f"{base} if y > 0.3 else 0", f"-{base}*y"])


def somewhere(r: random.Random, mesh: Mesh, dimensions: tuple[int, ...] = (0, 1, 2)) -> object:
    names = [name for name, group in mesh.groups.items() if group.dimension in dimensions]
    kind = r.random()
    if kind < 0.9 and names:
        return r.choice(names)
    if kind < 0.93 and mesh.groups:
        return [r.choice(list(mesh.groups)) for _ in range(2)]
    shift = r.choice([0.0, 0.0, 0.0, 1e-3, 50.0])
    return (mesh.points[r.randrange(len(mesh.points))] + shift).tolist()


def support(r: random.Random, mesh: Mesh) -> Scene:
    kind = r.choice(
        [
            "clamped",
            "clamped",
            "simply_supported",
            "symmetry",
            "free",
            "hinge",
            "fix",
            "elastic",
            "rigid_link",
        ]
    )
    out: Scene = {"on": somewhere(r, mesh), "kind": kind}
    if kind == "fix":
        letters = "".join(r.sample("xyzr", r.randint(1, 4)))
        out = {"on": out["on"], "fix": letters}
        if r.random() < 0.3:
            out["value"] = [number(r, 0.01) if c in letters else 0 for c in "xyz"]
        if r.random() < 0.2:
            out["axes"] = [[1, 1, 0], [-1, 1, 0], [0, 0, 1]]
    elif kind == "elastic":
        out |= {"stiffness": scalar(r, 1e6), "freedoms": "".join(r.sample("xyzrn", r.randint(1, 3)))}
        if r.random() < 0.3:
            out["axes"] = [[1, 0, 1], [0, 1, 0], [-1, 0, 1]]
    elif kind == "rigid_link":
        out |= {"to": [number(r, 0.5) for _ in range(3)], "name": "link"}
    elif kind != "hinge" and r.random() < 0.15:
        out["value"] = r.choice([number(r, 0.01), vector(r, 0.01)])
    return out


def load(r: random.Random, mesh: Mesh) -> Scene:
    kind = r.choice(
        [
            "pressure",
            "traction",
            "gravity",
            "line_force",
            "edge_moment",
            "point_force",
            "point_moment",
            "temperature",
        ]
        + ["initial_curvature", "initial_strain"]
    )
    out: Scene = {"kind": kind}
    if kind in ("pressure", "edge_moment"):
        out["value"] = scalar(r, 1e3)
    elif kind == "temperature":
        out |= {"mean": scalar(r, 10), "gradient": scalar(r, 100), "expansion": number(r, 1e-5)}
    else:
        out["value"] = vector(r, 1e-4 if kind.startswith("initial") else 1e2)
    if kind == "pressure" and r.random() < 0.2:
        out["follower"] = True
    if kind in ("line_force", "edge_moment"):
        out["on"] = somewhere(r, mesh, (1,))
    elif kind in ("point_force", "point_moment"):
        out["on"] = r.choice(["link", somewhere(r, mesh, (0,)), somewhere(r, mesh, (0,))])
    elif r.random() < 0.3:
        out["on"] = somewhere(r, mesh, (2,))
    return out


def material(r: random.Random) -> Scene:
    kind = r.random()
    if kind < 0.6:
        out: Scene = {"E": number(r, 2e11), "nu": r.choice([0, 0.3, 0.3, 0.3, 0.49999, -0.99])}
    elif kind < 0.8:
        out = {
            "E1": number(r, 1e11),
            "E2": number(r, 1e10),
            "nu12": r.choice([0.3, 0, -0.3]),
            "G12": number(r, 5e9),
        }
        out["angle"] = r.choice([0, 30, 45, -720.5])
    else:
        out = {"lame_lambda": number(r, 1e11), "lame_mu": number(r, 8e10)}
    return out | ({"density": number(r, 7850)} if r.random() < 0.7 else {})


def scene(seed: int) -> Scene:
    r = random.Random(seed)
    name = r.choice(SMALL)
    path = MESHES / f"{name}.msh"
    mesh = read_mesh(path)
    out: Scene = {"mesh": path.as_posix()}
    if r.random() < 0.2:
        layers = [
            {**material(r), "thickness": number(r, 0.005), "angle": r.choice([0, 45])} for _ in range(2)
        ]
        out["layer"] = layers
    else:
        out |= {
            "thickness": r.choice([number(r, 0.01), number(r, 0.01), "0.01+0.001*x**2"]),
            "material": material(r),
        }
    out["support"] = [support(r, mesh) for _ in range(r.randint(0, 3))]
    curves = [group for group in mesh.groups if mesh.groups[group].dimension == 1]
    if r.random() < 0.6 and curves:
        out["support"] = [*out["support"], {"on": r.choice(curves), "kind": "clamped"}]  # type: ignore[misc]
    out["load"] = [load(r, mesh) for _ in range(r.randint(0, 3))]
    if r.random() < 0.5:
        at = mesh.points[r.randrange(len(mesh.points))] * r.choice([1, 1, 1.01, 10])
        out["probe"] = [{"name": "p", "at": at.tolist()}]
    options: Scene = {"large_deflection": False, "error": "off"}
    if r.random() < 0.3:
        options["model"] = r.choice(["plate", "shell"])
    if r.random() < 0.3:
        options["element"] = r.choice(["koiter", "argyris", "morley", "hhj"])
    out["solve"] = options
    if r.random() < 0.1:
        out |= {"offset": number(r, 0.005), "direction": [1, 1, 0]}
    return out


def as_toml(scene: Scene) -> str:
    return "\n".join(f"{json.dumps(key)} = {_value(value)}" for key, value in scene.items()) + "\n"


def _value(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {_value(part)}" for key, part in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value)


def verdict(seed: int, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What is wrong with how a scene was handled; "answered" or "refused" if nothing is."""
    path = folder / f"scene-{seed}.toml"
    path.write_text(as_toml(scene(seed)), encoding="utf-8")
    with np.errstate(all="ignore"):
        code = run(["solve", str(path), "--json", "-"])
    said = capsys.readouterr()
    errors = [line for line in said.err.splitlines() if line.startswith("error: ")]
    if code not in (0, 1, 2):
        return f"exit code {code}"
    if "Traceback" in said.err or "fault of kshell" in said.err:
        return "traceback"
    if code and (len(errors) != 1 or len(errors[0]) > LONGEST):
        return f"{len(errors)} lines of error, or a very long one"
    if code:
        return "refused"
    return "answered" if json.loads(said.out)["balance"] < 1e-3 else "out of balance"


@pytest.mark.parametrize("first", range(0, 40, 20))
def test_scenes_are_answered_or_refused_in_words(first, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)  # put back what `run` sets
    found = {seed: verdict(seed, tmp_path, capsys) for seed in range(first, first + 20)}
    assert not {seed: words for seed, words in found.items() if words not in ("answered", "refused")}
    assert "answered" in found.values()  # not all of them are nonsense
