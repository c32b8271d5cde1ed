"""Scene files as dicts: from their keys to the arguments of `Scene`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kshell.errors import InputError
from kshell.material.given import Section
from kshell.mesh.words import shown
from kshell.scene.blocks import Cut
from kshell.scene.cases import Case, Combination
from kshell.scene.contact import Contact, obstacle_from
from kshell.scene.masses import Mass
from kshell.scene.motion import Damping, InitialVelocity
from kshell.scene.options import SolveOptions
from kshell.scene.reading import (
    chart_from_dict,
    each_block,
    group_from_dict,
    imperfection_from_dict,
    in_folder,
    initial_from_dict,
    inside,
    layer_from_dict,
    line_from_dict,
    load_from_dict,
    material_from_dict,
    probes_from_blocks,
    support_from_dict,
    table_of,
)
from kshell.scene.sections import merged_groups
from kshell.values.tables import with_tables
from kshell.values.validation import unknown_key

# key of the file: argument of Scene
SIMPLE_KEYS = (
    "title",
    "units",
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


def scene_arguments(data: Mapping[str, Any], folder: Path, source: str) -> dict[str, Any]:
    """What `Scene` takes, from a dict with the keys of a scene file. See `Scene.from_dict`."""
    for key in data:
        if key not in KEYS:
            raise InputError(f"{source}: {unknown_key(key, KEYS)}")
    with inside(source):
        data = with_tables(data, folder)
    arguments = {key: data[key] for key in SIMPLE_KEYS if key in data}
    if "mesh" not in data:
        raise InputError(f'{source}: mesh is missing: give the path of the mesh, e.g. mesh = "plate.msh"')
    for key in ("mesh", "geometry"):
        if key in data:
            path = data[key]
            arguments[key] = folder / path if isinstance(path, str | Path) and path else path
    if "material" in data:
        with inside(f"{source}, [material]", "material: "):
            arguments["material"] = material_from_dict(table_of(data["material"]))
    if "layer" in data:
        arguments["layers"] = each_block(data["layer"], "layer", source, layer_from_dict)
    if "section" in data:
        with inside(f"{source}, [section]", "section: "):
            arguments["section"] = Section(**table_of(data["section"]))
    if "group" in data:
        blocks = {}
        for name, block in table_of(data["group"]).items():
            with inside(f"{source}, [group.{name}]"):
                blocks[name] = group_from_dict(table_of(block))
        with inside(source):
            merged_groups(blocks, arguments)
    if "chart" in data:
        with inside(f"{source}, [chart]"):
            arguments["chart"] = chart_from_dict(table_of(data["chart"]))
    if "imperfection" in data:
        with inside(f"{source}, [imperfection]", "imperfection: "):
            arguments["imperfection"] = imperfection_from_dict(table_of(data["imperfection"]), folder)
    arguments["supports"] = each_block(data.get("support", []), "support", source, support_from_dict)
    arguments["loads"] = each_block(
        data.get("load", []), "load", source, lambda block: load_from_dict(in_folder(block, folder))
    )
    arguments["probes"] = probes_from_blocks(data.get("probe", []), source)
    arguments["cases"] = each_block(data.get("case", []), "case", source, lambda block: Case(**block))
    arguments["combinations"] = each_block(
        data.get("combination", []), "combination", source, lambda block: Combination(**block)
    )
    arguments["lines"] = each_block(data.get("line", []), "line", source, line_from_dict)
    arguments["cuts"] = [
        name
        for cut in each_block(data.get("cut", []), "cut", source, lambda block: Cut(**block))
        for name in cut.on
    ]
    arguments["masses"] = each_block(data.get("mass", []), "mass", source, lambda block: Mass(**block))
    if "initial" in data:
        with inside(f"{source}, [initial]", "initial: "):
            begin = initial_from_dict(table_of(data["initial"]))
            arguments["initial_displacement"] = begin.displacement
            if begin.velocity is not None:
                arguments["initial_velocity"] = InitialVelocity(begin.velocity, begin.on)
    if "contact" in data:
        with inside(f"{source}, [contact]", "contact: "):
            given = table_of(data["contact"])
            bodies = given.pop("with", [])
            if not isinstance(bodies, list):
                raise InputError(f"with = {shown(bodies)}: must be a list of obstacles")
            arguments["obstacles"] = [obstacle_from(body, folder) for body in bodies]
            arguments["contact"] = Contact(**given)
    if "damping" in data:
        with inside(f"{source}, [damping]", "damping: "):
            arguments["damping"] = Damping(**table_of(data["damping"]))
    with inside(f"{source}, [solve]", "[solve]: "):
        arguments["solve"] = SolveOptions(**table_of(data.get("solve", {})))
    return arguments
