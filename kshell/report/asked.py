"""What a report says of the question: scene, mesh, supports, loads, and the model with its reasons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from kshell.mesh import check
from kshell.mesh.words import place
from kshell.report.table import Table, number
from kshell.result.result import Result
from kshell.scene.places import on_words
from kshell.scene.scene import Scene
from kshell.scene.writing import scene_data
from kshell.values.varying import show

# keys of a scene that have sections of their own
ELSEWHERE = ("title", "mesh", "material", "support", "load", "layer", "case", "combination")


def scene_tables(scene: Scene) -> list[Table]:
    """Thickness, material, layers, and every other key that the scene gives."""
    data = scene_data(scene)
    rows = [[key.replace("_", " "), _words(value)] for key, value in data.items() if key not in ELSEWHERE]
    tables = [Table("", (), rows)]
    if scene.material is not None:
        tables.append(Table("Material", (), _material(scene.material, data.get("material"))))
    if scene.layers is not None:
        layers = [
            [str(n), number(layer.thickness), f"{number(layer.angle)}°", _one_line(layer.material)]
            for n, layer in enumerate(scene.layers, 1)
        ]
        tables.append(Table("Layers, bottom to top", ("", "thickness", "angle", "material"), layers))
    return tables


def _material(material: Any, data: Any) -> list[list[str]]:
    rows = [["law", type(material).__name__.lower()]]
    if isinstance(data, Mapping):
        rows += [[key.replace("_", " "), _words(value)] for key, value in data.items()]
    return rows


def _one_line(material: Any) -> str:
    names = ("E", "nu", "E1", "E2", "nu12", "G12", "density")
    given = [(name, getattr(material, name, None)) for name in names]
    return f"{type(material).__name__.lower()} " + ", ".join(f"{n} = {v:g}" for n, v in given if v)


def _words(value: Any) -> str:
    if isinstance(value, Mapping):
        return "; ".join(f"{key}: {_words(part)}" for key, part in value.items())
    if isinstance(value, list) and value and isinstance(value[0], list | dict):
        return "; ".join(_words(part) for part in value)
    if isinstance(value, list):
        return ", ".join(_words(part) for part in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float | int):
        return f"{value:g}"
    return show(value) if callable(value) else str(value)


def support_table(scene: Scene) -> Table:
    """What holds, and where."""
    rows = []
    for support in scene.supports:
        value = "" if support.value is None else show(support.value)
        rows.append(
            [support.kind.replace("_", " "), on_words(support.on), _freedoms(support.freedoms), value]
        )
    return Table("Supports", ("support", "where", "holds", "prescribed"), rows)


def _freedoms(letters: str) -> str:
    turned = ["rotation"] if "r" in letters else []
    return ", ".join([letter for letter in letters if letter != "r"] + turned)


def load_table(scene: Scene) -> Table:
    """What acts, and where."""
    rows = [
        [str(n), load.name, load.kind.replace("_", " "), load.where, load.amount]
        for n, load in enumerate(scene.loads)
    ]
    return Table("Loads", ("", "name", "load", "where", "value"), rows)


def case_table(scene: Scene) -> Table:
    """Factors of the loads in every load case and combination."""
    heads = ["case", *(load.name or f"load {n}" for n, load in enumerate(scene.loads))]
    rows = [[name, *(f"{f:g}" for f in factors)] for name, factors in scene.case_factors.items()]
    return Table("Factors of the loads in load cases and combinations", heads, rows)


def mesh_tables(result: Result) -> Iterator[Table]:
    """Counts and sizes, groups, and the shape of the triangles."""
    mesh = result.mesh
    found, worst = check.summary(mesh), check.quality(mesh)
    yield Table(
        "",
        (),
        [
            ["source", found.source],
            ["triangles", f"{found.triangles} of order {found.order}"],
            ["vertices, edges", f"{found.vertices}, {found.edges}"],
            ["from, to", f"{place(found.lower)}, {place(found.upper)}"],
            ["area, length of the boundary", f"{number(found.area)}, {number(found.boundary_length)}"],
            ["unknowns", str(result.unknowns)],
        ],
    )
    unit = {"point": "", "curve": "length ", "surface": "area "}
    if found.groups:
        rows = [
            [g.name, g.kind, str(g.members), f"{unit[g.kind]}{number(g.measure)}" if unit[g.kind] else ""]
            for g in found.groups
        ]
        yield Table("Groups", ("group", "kind", "members", "size"), rows)
    yield Table(
        "Shape of the triangles",
        ("", "worst", "at"),
        [
            ["smallest angle", f"{worst.min_angle:.3g}°", place(worst.min_angle_at)],
            ["largest aspect ratio", f"{worst.max_aspect:.3g}", place(worst.max_aspect_at)],
            ["shortest edge", f"{worst.shortest_edge:.4g}", place(worst.shortest_edge_at)],
            ["longest edge", f"{worst.longest_edge:.4g}", place(worst.longest_edge_at)],
        ],
    )


def model_table(result: Result) -> Table:
    """Which model and element; the reasons stand below it."""
    model = result.model
    rows = [
        ["model", str(model.get("kind", ""))],
        ["element", f"{model.get('element', '')}, order {model.get('order', '')}"],
        ["deflections", "large" if model.get("large_deflection") else "small"],
        ["frame of moments and stresses", result.frame],
    ]
    return Table("", (), rows)
