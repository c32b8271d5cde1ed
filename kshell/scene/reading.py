"""From the tables of a scene file, one function each, to what `Scene` takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kshell.errors import InputError
from kshell.material.given import Section
from kshell.material.laminate import Layer
from kshell.material.materials import Anisotropic, Isotropic, Orthotropic
from kshell.mesh.words import shown
from kshell.scene.blocks import Probe
from kshell.scene.imperfection import Imperfection
from kshell.scene.line import Line
from kshell.scene.loads import LOADS
from kshell.scene.motion import Initial
from kshell.scene.places import as_probe
from kshell.scene.supports import (
    Clamped,
    Elastic,
    Fixed,
    Free,
    Hinge,
    RigidLink,
    SimplySupported,
    SoftSupported,
    Symmetry,
)
from kshell.values.naming import listing, suggestion
from kshell.values.validation import unknown_key

LINE_KEYS = ["name", "from", "to", "n"]
NAMED_SUPPORTS = {
    cls.kind: cls
    for cls in (Clamped, SimplySupported, SoftSupported, Symmetry, Free, Hinge, RigidLink, Elastic)
}


def material_from_dict(data: Mapping[str, Any]) -> Any:
    """Isotropic, Orthotropic or Anisotropic, told apart by the keys."""
    if "C" in data:
        return Anisotropic(**data)
    if {"E1", "E2", "nu12", "G12"} & set(data):
        return Orthotropic(**data)
    if {"E", "nu", "lame_lambda", "lame_mu"} & set(data):
        return Isotropic(**data)
    raise InputError(
        f"keys {listing(data)}: a material has E and nu, or lame_lambda and lame_mu, "
        "or E1, E2, nu12 and G12 (and angle), or C; and density"
    )


def layer_from_dict(data: dict[str, Any]) -> Layer:
    """A layer: material keys, thickness and angle."""
    layer = {key: data.pop(key) for key in ("thickness", "angle") if key in data}
    return Layer(material=material_from_dict(data), **layer)


GROUP_KEYS = ("thickness", "material", "layer", "section", "offset", "direction")


def group_from_dict(data: dict[str, Any]) -> dict[str, Any]:
    """What a block [group.NAME] says, as arguments of Scene."""
    for key in data:
        if key not in GROUP_KEYS:
            raise InputError(unknown_key(key, list(GROUP_KEYS)))
    out: dict[str, Any] = {key: data[key] for key in ("thickness", "offset", "direction") if key in data}
    if "material" in data:
        out["material"] = material_from_dict(table_of(data["material"]))
    if "layer" in data:
        out["layers"] = [layer_from_dict(dict(table_of(layer))) for layer in blocks_of(data["layer"])]
    if "section" in data:
        out["section"] = Section(**table_of(data["section"]))
    return out


def blocks_of(value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise InputError("write [[group.NAME.layer]] with double brackets: there may be several")
    return value


def chart_from_dict(data: dict[str, Any]) -> Any:
    """A ready chart: its kind and constants."""
    from kshell.geometry import ready_chart

    if "kind" not in data:
        raise InputError('kind is missing: for example kind = "cylinder" with R = 25.0')
    return ready_chart(data.pop("kind"), **data)


def imperfection_from_dict(data: dict[str, Any], folder: Path) -> Imperfection:
    """An imperfection; a relative path is relative to the folder."""
    found = Imperfection(**data)
    return found if found.file is None else Imperfection(**{**data, "file": folder / found.file})


def initial_from_dict(data: dict[str, Any]) -> Initial:
    """How a motion begins: its velocity, and where, and its displacement."""
    begin = Initial(**data)
    if begin.velocity is None and (begin.displacement is None or begin.on is not None):
        raise InputError("velocity is missing: give [vx, vy, vz]; on is where it is")
    return begin


def support_from_dict(data: dict[str, Any]) -> Any:
    """A support: `kind`, or `fix`, or `stiffness`, with `on`."""
    kind = data.pop("kind", None)
    exact = [key for key in ("fix", "stiffness", "freedoms") if key in data]
    if kind is not None:
        if not isinstance(kind, str) or kind not in NAMED_SUPPORTS:
            hint = suggestion(str(kind), NAMED_SUPPORTS)
            raise InputError(
                f"kind = {shown(kind)}: {hint}the kinds are {listing(NAMED_SUPPORTS)}; "
                'for exact freedoms write fix = "xzr", for springs stiffness = 1e6'
            )
        if kind == Elastic.kind:
            return Elastic(**data)
        if exact:
            raise InputError(f'kind = "{kind}" and {exact[0]} given: leave one of them out')
        return NAMED_SUPPORTS[kind](**data)
    if "fix" in data and "freedoms" in data:
        raise InputError("fix and freedoms given: they mean the same, leave one of them out")
    if "fix" in data:
        data["freedoms"] = data.pop("fix")
    if "stiffness" in data:
        return Elastic(**data)
    if not exact:
        raise InputError(
            f'how is missing: give kind ({listing(NAMED_SUPPORTS)}), or fix = "xzr", or stiffness = 1e6'
        )
    return Fixed(**data)


def in_folder(block: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A block whose values that are files are in the folder, if their paths are relative."""
    return {
        key: {**value, "file": folder / value["file"]}
        if isinstance(value, Mapping) and isinstance(value.get("file"), str) and value["file"]
        else value
        for key, value in block.items()
    }


def load_from_dict(data: dict[str, Any]) -> Any:
    """A load: `kind` and the keys of that kind."""
    kind = data.pop("kind", None)
    if kind is None:
        raise InputError(f"kind is missing: one of {listing(LOADS)}")
    if not isinstance(kind, str) or kind not in LOADS:
        raise InputError(
            f"kind = {shown(kind)}: {suggestion(str(kind), LOADS)}the kinds are {listing(LOADS)}"
        )
    return LOADS[kind](**data)


def line_from_dict(data: dict[str, Any]) -> Line:
    """A line: name, from, to and n."""
    for key in data:
        if key not in LINE_KEYS:
            raise InputError(unknown_key(key, LINE_KEYS))
    renamed = {"from": "start", "to": "end"}
    return Line(**{renamed.get(key, key): value for key, value in data.items()})


def probes_from_blocks(blocks: Any, source: str) -> dict[str, Any]:
    probes: dict[str, Any] = {}

    def add(data: dict[str, Any]) -> None:
        block = Probe(**data)
        if block.name in probes:
            raise InputError(f'the name "{block.name}" is taken by an earlier probe: give another')
        probes[block.name] = as_probe({"at": block.at, "on": block.on})

    each_block(blocks, "probe", source, add)
    return probes


def each_block(blocks: Any, name: str, source: str, make: Callable[[dict[str, Any]], Any]) -> list[Any]:
    if not isinstance(blocks, list):
        raise InputError(f"{source}: write [[{name}]] with double brackets: there may be several")
    made = []
    for number, block in enumerate(blocks, start=1):
        with inside(f"{source}, [[{name}]] {number}", f"{name}: "):
            made.append(make(dict(table_of(block))))
    return made


def table_of(value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise InputError(f"{shown(value)} must be a table of keys")
    return dict(value)


@contextmanager
def inside(where: str, instead_of: str = "") -> Iterator[None]:
    """Say in which file and block an error was found, in place of what it says itself."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {str(error).removeprefix(instead_of)}") from None
