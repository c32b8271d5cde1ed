"""From a scene back to the keys of a scene file: for `Scene.save`, and for scenes that differ in a few values.

A key is written where its value is not the default one.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kshell.errors import InputError
from kshell.material.by_group import ELSE
from kshell.material.materials import Isotropic
from kshell.mesh.mesh import Mesh
from kshell.scene.supports import Elastic, Fixed
from kshell.values.varying import show

if TYPE_CHECKING:
    from kshell.scene.scene import Scene

# argument of Scene: block of the file, of which there are several
BLOCKS = {
    "supports": "support",
    "loads": "load",
    "layers": "layer",
    "cases": "case",
    "combinations": "combination",
    "lines": "line",
    "masses": "mass",
}

# arguments that may be dicts by surface group
BY_GROUP = ("thickness", "material", "layers", "section", "offset", "direction")


def scene_data(scene: Scene) -> dict[str, Any]:
    """What `Scene.from_dict` makes the same scene of; meshes in memory and functions stand in it as they are."""
    data: dict[str, Any] = {}
    for key, value in _given(scene).items():
        if key in BY_GROUP and isinstance(value, Mapping):
            for group, part in value.items():
                table = data if group == ELSE else data.setdefault("group", {}).setdefault(group, {})
                blocks = key in BLOCKS
                table[BLOCKS.get(key, key)] = [_block(item) for item in part] if blocks else _plain(part)
        elif key in BLOCKS:
            if value:
                data[BLOCKS[key]] = [_block(item) for item in value]
        elif key == "probes":
            data["probe"] = [_probe(name, point) for name, point in value.items()]
        elif key == "cuts":
            data["cut"] = [{"on": list(value)}] if value else []
        elif key == "initial_velocity":
            begin = _block(value)
            data["initial"] = {**data.get("initial", {}), "velocity": begin.pop("value"), **begin}
        elif key == "initial_displacement":
            data["initial"] = {**data.get("initial", {}), "displacement": _block(value)["value"]}
        elif key == "obstacles":
            data["contact"] = {**data.get("contact", {}), "with": [_obstacle(body) for body in value]}
        elif key == "contact":
            data[key] = {**_plain(value), **data.get(key, {})}
        elif key == "chart":
            data[key] = _chart(value)
        else:
            data[key] = _plain(value)
    return data


def scene_words(scene: Scene) -> dict[str, Any]:
    """The keys of a scene file as numbers and text, for result.json.

    The mesh is the name of its file; functions are named, as text that no scene file takes.
    """
    data = scene_data(scene)
    data["mesh"] = str(data["mesh"]) if isinstance(data["mesh"], Path) else "a mesh in memory"
    words: dict[str, Any] = _as_words(data)
    return words


def _as_words(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _as_words(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_as_words(part) for part in value]
    if value is None or isinstance(value, str | int | float):
        return value
    return show(value) if callable(value) else str(value)


def _given(item: Any) -> dict[str, Any]:
    """Arguments of a described object that are not their defaults."""
    out = {}
    for f in fields(item):
        if not f.init:
            continue
        value = getattr(item, f.name)
        default = f.default if f.default is not MISSING else None
        if f.default_factory is not MISSING:
            default = f.default_factory()
        if value is not default and not (_comparable(value) and value == default):
            out[f.name] = value
    if isinstance(item, Isotropic):  # which knows them from E and nu
        del out["lame_lambda"], out["lame_mu"]
    return out


def _comparable(value: Any) -> bool:
    return not isinstance(value, np.ndarray)


def _block(item: Any) -> dict[str, Any]:
    """A load, support, layer, case or line with the keys it has in a file."""
    data = {key: _plain(value) for key, value in _given(item).items()}
    if isinstance(item, Fixed):
        data["fix"] = item.freedoms
        data.pop("freedoms", None)
    elif getattr(item, "kind", "") and not isinstance(item, Elastic):
        data = {"kind": item.kind, **data}
    if isinstance(data.get("material"), dict):  # of a layer, whose keys stand beside its own
        material = data.pop("material")
        angle = material.pop("angle", 0.0) + data.get("angle", 0.0)
        data = {**material, **data, **({"angle": angle} if angle else {})}
    for key, name in (("start", "from"), ("end", "to")):
        if key in data:
            data[name] = data.pop(key)
    return data


def _probe(name: str, point: Any) -> dict[str, Any]:
    on = getattr(point, "on", None)
    return {"name": name, "at": list(point), **({} if on is None else {"on": on})}


def _obstacle(body: Any) -> dict[str, Any]:
    """An obstacle as in [contact]: its kind and keys, or its file, beside name and motion."""
    data = {key: _plain(part) for key, part in _given(body).items()}
    shape = data.pop("shape")
    return {**(shape if isinstance(shape, dict) else {"file": shape}), **data}


def _chart(chart: Any) -> Any:
    from kshell.geometry.charts import READY

    kind = next((kind for kind, cls in READY.items() if type(chart) is cls), None)
    return chart if kind is None else {"kind": kind, **chart.constants}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if hasattr(value, "__dataclass_fields__") and not isinstance(value, Mesh):
        return {key: _plain(part) for key, part in _given(value).items()}
    return value


def save_scene(scene: Scene, path: str | os.PathLike[str]) -> list[str]:
    """Write a scene file, and beside it a mesh that only is in memory. See `Scene.save`."""
    import tomli_w

    from kshell.mesh import read_mesh
    from kshell.mesh.write import write_msh

    target = Path(path)
    data = scene_data(scene)
    written = [str(target)]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(scene.mesh, Path):
            data["mesh"] = _relative(scene.mesh, target.parent)
        else:
            file = target.with_suffix(".msh")
            write_msh(read_mesh(scene.mesh), file)
            data["mesh"] = file.name
            written.append(str(file))
        for key in ("geometry", "imperfection.file"):
            _relocate(data, key.split("."), target.parent)
        for body in data.get("contact", {}).get("with", []):
            _relocate(body, ["file"], target.parent)
        for load in data.get("load", []):
            for value in load.values():
                if isinstance(value, dict):
                    _relocate(value, ["file"], target.parent)
        _require_text(data, "")
        target.write_text(tomli_w.dumps(data), encoding="utf-8")
    except OSError as error:
        raise InputError(
            f"{error.filename or target}: cannot be written ({error.strerror or error})"
        ) from None
    return written


def _relative(path: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # on another drive
        return path.resolve().as_posix()


def _relocate(data: dict[str, Any], keys: list[str], folder: Path) -> None:
    table: Any = data
    for key in keys[:-1]:
        table = table.get(key, {})
    if isinstance(table.get(keys[-1]), Path):
        table[keys[-1]] = _relative(table[keys[-1]], folder)


def _require_text(value: Any, where: str) -> None:
    """Refuse what a file cannot hold."""
    if isinstance(value, Mapping):
        for key, part in value.items():
            _require_text(part, f"{where}.{key}" if where else str(key))
    elif isinstance(value, list):
        for number, part in enumerate(value):
            _require_text(part, f"{where}.{number}")
    elif not isinstance(value, str | int | float):
        raise InputError(
            f"{where} = {value!r} cannot be written into a scene file: give numbers or an expression in x, y, z "
            "instead of a function, and a ready chart"
        )
