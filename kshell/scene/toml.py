"""Scene files, TOML, and the dicts they hold: from their keys to what `Scene` takes."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kshell.errors import InputError, clipped
from kshell.material.given import Section
from kshell.material.laminate import Layer
from kshell.material.materials import Anisotropic, Isotropic, Orthotropic
from kshell.mesh.words import is_folder, shown
from kshell.scene.blocks import Cut, Probe
from kshell.scene.cases import Case, Combination
from kshell.scene.contact import Contact, obstacle_from
from kshell.scene.imperfection import Imperfection
from kshell.scene.line import Line
from kshell.scene.loads import LOADS
from kshell.scene.masses import Mass
from kshell.scene.motion import Damping, InitialVelocity
from kshell.scene.options import SolveOptions
from kshell.scene.places import as_probe
from kshell.scene.sections import merged_groups
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

# key of the file: argument of Scene
SIMPLE_KEYS = (
    "title",
    "mesh_size",
    "mesh_order",
    "facets",
    "crease",
    "top_towards",
    "thickness",
    "offset",
    "direction",
)
KEYS = [
    "title",
    "mesh",
    "geometry",
    *SIMPLE_KEYS[1:],
    "layer",
    "material",
    "section",
    "group",
    "chart",
    "imperfection",
    "support",
    "load",
    "probe",
    "case",
    "combination",
    "line",
    "cut",
    "mass",
    "initial",
    "damping",
    "contact",
    "solve",
]
LINE_KEYS = ["name", "from", "to", "n"]
NAMED_SUPPORTS = {
    cls.kind: cls
    for cls in (Clamped, SimplySupported, SoftSupported, Symmetry, Free, Hinge, RigidLink, Elastic)
}


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a TOML file.

    Raises
    ------
    InputError
        If there is no such file or it is not TOML; the message has the line.
    """
    where = clipped(path)
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors begin with a mark of the order of bytes
    except FileNotFoundError:
        near = [p.name for p in path.parent.glob("*.toml")] if is_folder(path.parent) else []
        hint = suggestion(path.name, near)
        raise InputError(f"{where}: no such file. {hint}".rstrip()) from None
    except IsADirectoryError:
        raise InputError(f"{where}: is a folder: give a scene file, .toml") from None
    except UnicodeDecodeError:
        raise InputError(f"{where}: is not text: a scene file is TOML in UTF-8") from None
    except PermissionError:
        raise InputError(f"{where}: may not be read: check its permissions") from None
    except OSError as error:
        raise InputError(
            f"{where}: cannot be read ({error.strerror}): give the path of a scene file"
        ) from None
    try:
        return parsed_toml(text)
    except ValueError as error:
        raise InputError(f"{where}: not valid TOML: {clipped(error)}") from None


def parsed_toml(text: str) -> dict[str, Any]:
    """The tables of a text.

    Raises
    ------
    ValueError
        If it is not TOML, or nested too deeply, or has a whole number of more digits than Python reads.
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("lists or tables nested too deeply") from None


def apply_override(data: dict[str, Any], override: str) -> None:
    """Replace one value in place: "material.E=70e9", "load.0.value=2000", 'title="x"'.

    The value is written as in TOML; what is not TOML is taken as text.
    """
    key, equals, text = override.partition("=")
    override = clipped(override)
    parts = key.strip().split(".")
    if not equals or not all(parts):
        raise InputError(
            f'--set {override}: write KEY=VALUE, for example "material.E=70e9" or "load.0.value=2000"'
        )
    value = value_of(text)
    data.update(set_value(data, parts, value, f"--set {override}"))


def value_of(text: str) -> Any:
    """A value written as in TOML; what is not TOML is text."""
    try:
        return parsed_toml(f"value = {text.strip()}")["value"]
    except ValueError:
        return text.strip()


def set_value(data: Any, parts: Sequence[str], value: Any, what: str) -> Any:
    """A copy of tables and lists with one value replaced, the rest shared.

    Parameters
    ----------
    parts : sequence of str
        Keys from the outside in; of a list a number from 0. A table that is missing is made.
    what : str
        For messages.

    Raises
    ------
    InputError
        If there is no such place.
    """
    return _changed(data, list(parts), value, what, [])


def _changed(table: Any, parts: list[str], value: Any, what: str, above: list[str]) -> Any:
    if not parts:
        return value
    part, *rest = parts
    if isinstance(table, list):
        key = _index(table, part, what, above)
        return [
            _changed(item, rest, value, what, [*above, part]) if number == key else item
            for number, item in enumerate(table)
        ]
    if isinstance(table, dict):
        inner = _changed(table.get(part, {}), rest, value, what, [*above, part])
        return {**table, part: inner}
    raise InputError(f'{what}: "{clipped(".".join(above))}" is {shown(table)} and has no keys')


def _index(items: list[Any], part: str, what: str, above: list[str]) -> int:
    if not part.isascii() or not part.isdigit() or len(part) > 9 or int(part) >= len(items):
        raise InputError(
            f'{what}: "{clipped(".".join(above))}" is a list of {len(items)}: '
            f'"{clipped(part)}" must be a number from 0 to {len(items) - 1}'
        )
    return int(part)


def scene_arguments(data: Mapping[str, Any], folder: Path, source: str) -> dict[str, Any]:
    """What `Scene` takes, from a dict with the keys of a scene file. See `Scene.from_dict`."""
    for key in data:
        if key not in KEYS:
            raise InputError(f"{source}: {unknown_key(key, KEYS)}")
    arguments = {key: data[key] for key in SIMPLE_KEYS if key in data}
    if "mesh" not in data:
        raise InputError(f'{source}: mesh is missing: give the path of the mesh, e.g. mesh = "plate.msh"')
    for key in ("mesh", "geometry"):
        if key in data:
            path = data[key]
            arguments[key] = folder / path if isinstance(path, str | Path) and path else path
    if "material" in data:
        with inside(f"{source}, [material]", "material: "):
            arguments["material"] = material_from_dict(_table(data["material"]))
    if "layer" in data:
        arguments["layers"] = _each(data["layer"], "layer", source, layer_from_dict)
    if "section" in data:
        with inside(f"{source}, [section]", "section: "):
            arguments["section"] = Section(**_table(data["section"]))
    if "group" in data:
        blocks = {}
        for name, block in _table(data["group"]).items():
            with inside(f"{source}, [group.{name}]"):
                blocks[name] = group_from_dict(_table(block))
        with inside(source):
            merged_groups(blocks, arguments)
    if "chart" in data:
        with inside(f"{source}, [chart]"):
            arguments["chart"] = chart_from_dict(_table(data["chart"]))
    if "imperfection" in data:
        with inside(f"{source}, [imperfection]", "imperfection: "):
            arguments["imperfection"] = imperfection_from_dict(_table(data["imperfection"]), folder)
    arguments["supports"] = _each(data.get("support", []), "support", source, support_from_dict)
    arguments["loads"] = _each(data.get("load", []), "load", source, load_from_dict)
    arguments["probes"] = _probes(data.get("probe", []), source)
    arguments["cases"] = _each(data.get("case", []), "case", source, lambda block: Case(**block))
    arguments["combinations"] = _each(
        data.get("combination", []), "combination", source, lambda block: Combination(**block)
    )
    arguments["lines"] = _each(data.get("line", []), "line", source, line_from_dict)
    arguments["cuts"] = [
        name
        for cut in _each(data.get("cut", []), "cut", source, lambda block: Cut(**block))
        for name in cut.on
    ]
    arguments["masses"] = _each(data.get("mass", []), "mass", source, lambda block: Mass(**block))
    if "initial" in data:
        with inside(f"{source}, [initial]", "initial velocity: "):
            arguments["initial_velocity"] = initial_from_dict(_table(data["initial"]))
    if "contact" in data:
        with inside(f"{source}, [contact]", "contact: "):
            given = _table(data["contact"])
            bodies = given.pop("with", [])
            if not isinstance(bodies, list):
                raise InputError(f"with = {shown(bodies)}: must be a list of obstacles")
            arguments["obstacles"] = [obstacle_from(body, folder) for body in bodies]
            arguments["contact"] = Contact(**given)
    if "damping" in data:
        with inside(f"{source}, [damping]", "damping: "):
            arguments["damping"] = Damping(**_table(data["damping"]))
    with inside(f"{source}, [solve]", "[solve]: "):
        arguments["solve"] = SolveOptions(**_table(data.get("solve", {})))
    return arguments


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
        out["material"] = material_from_dict(_table(data["material"]))
    if "layer" in data:
        out["layers"] = [layer_from_dict(dict(_table(layer))) for layer in _blocks(data["layer"])]
    if "section" in data:
        out["section"] = Section(**_table(data["section"]))
    return out


def _blocks(value: Any) -> list[Any]:
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


def initial_from_dict(data: dict[str, Any]) -> InitialVelocity:
    """How a motion begins: its velocity, and where."""
    for key in data:
        if key not in ("velocity", "on"):
            raise InputError(unknown_key(key, ["velocity", "on"]))
    if "velocity" not in data:
        raise InputError("velocity is missing: give [vx, vy, vz]")
    return InitialVelocity(data["velocity"], data.get("on"))


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


def _probes(blocks: Any, source: str) -> dict[str, Any]:
    probes: dict[str, Any] = {}

    def add(data: dict[str, Any]) -> None:
        block = Probe(**data)
        if block.name in probes:
            raise InputError(f'the name "{block.name}" is taken by an earlier probe: give another')
        probes[block.name] = as_probe({"at": block.at, "on": block.on})

    _each(blocks, "probe", source, add)
    return probes


def _each(blocks: Any, name: str, source: str, make: Callable[[dict[str, Any]], Any]) -> list[Any]:
    if not isinstance(blocks, list):
        raise InputError(f"{source}: write [[{name}]] with double brackets: there may be several")
    made = []
    for number, block in enumerate(blocks, start=1):
        with inside(f"{source}, [[{name}]] {number}", f"{name}: "):
            made.append(make(dict(_table(block))))
    return made


def _table(value: Any) -> dict[str, Any]:
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
