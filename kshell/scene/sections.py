"""What a scene says of its cross-section: thickness and material, layers or a stiffness, for all or by group."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kshell.errors import InputError
from kshell.material.by_group import ELSE
from kshell.material.given import Section
from kshell.material.laminate import Layer
from kshell.scene.places import as_point, as_scalar

KEYS = ("thickness", "material", "layers", "section")


def by_group(one: Callable[[Any, str], Any]) -> Callable[[Any], Any]:
    """A check of a value, or of each in a dict by surface group; `one` takes the value and words for whose it is."""

    def check(value: Any) -> Any:
        if value is None:
            return None
        if isinstance(value, Mapping):
            if not value:
                raise ValueError("must name at least one surface group")
            return {str(name): one(part, f'for "{name}" ') for name, part in value.items()}
        return one(value, "")

    return check


def as_thickness(value: Any, whose: str) -> Any:
    """A positive number, an expression, or a function."""
    wanted = "must be a number > 0, an expression in x, y, z, or a function f(x, y, z)"
    if isinstance(value, str) or callable(value):
        return as_scalar(value)
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise ValueError(f"{whose}{wanted}")
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{whose}must be a finite number > 0")
    return float(value)


def as_material(value: Any, whose: str) -> Any:
    """Something with a plane-stress stiffness."""
    if not hasattr(value, "plane_stress") or isinstance(value, Layer):
        raise ValueError(f"{whose}must be ks.Isotropic(...), ks.Orthotropic(...) or ks.Anisotropic(...)")
    return value


def as_layers(value: Any, whose: str) -> tuple[Layer, ...]:
    """Layers bottom to top."""
    if isinstance(value, Layer):
        value = (value,)
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise ValueError(f"{whose}must be a list of layers")
    if not value:
        raise ValueError(f"{whose}is empty: give at least one layer")
    for number, layer in enumerate(value):
        if not isinstance(layer, Layer):
            raise InputError(f"scene: layers[{number}] = {layer!r}: {whose}must be a ks.Layer(...)")
    return tuple(value)


def as_section(value: Any, whose: str) -> Section:
    """A stiffness."""
    if not isinstance(value, Section):
        raise ValueError(f"{whose}must be a ks.Section(A=..., D=...)")
    return value


def as_offset(value: Any, whose: str) -> float:
    """A height."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not np.isfinite(value):
        raise ValueError(f"{whose}must be a finite number")
    return float(value)


def as_direction(value: Any, whose: str) -> Any:
    """A vector that is not zero."""
    try:
        direction = as_point(value)
    except ValueError as error:
        raise ValueError(f"{whose}{error}") from None
    if not any(direction):
        raise ValueError(f"{whose}must not be zero")
    return direction


def require_one_section(scene: Any) -> None:
    """Raise InputError unless there is a section, and only one where nothing is given by group."""
    given = {key: getattr(scene, key) for key in KEYS if getattr(scene, key) is not None}
    if any(isinstance(value, Mapping) for value in given.values()):
        return  # whether each triangle has one is found on the mesh
    for whole, words in (("layers", "layers have their own"), ("section", "a section has its own")):
        others = [key for key in given if key != whole]
        if whole in given and others:
            raise InputError(f"scene: {whole} and {' and '.join(others)} given: {words}, leave them out")
    if "layers" in given or "section" in given:
        return
    if "thickness" not in given:
        raise InputError(
            "scene: thickness is missing: give the thickness of the plate, or layers, or a section"
        )
    if "material" not in given:
        raise InputError("scene: material is missing: give one, e.g. ks.Isotropic(E=210e9, nu=0.3)")


def each(value: Any) -> Iterator[Any]:
    """The value, or all that a dict by group has."""
    if isinstance(value, Mapping):
        yield from value.values()
    elif value is not None:
        yield value


def densities(scene: Any) -> list[float]:
    """Density of every material, mass of every section."""
    out = [material.density for material in each(scene.material)]
    out += [layer.material.density for layers in each(scene.layers) for layer in layers]
    return out + [section.mass for section in each(scene.section)]


def merged_groups(blocks: Mapping[str, Mapping[str, Any]], arguments: dict[str, Any]) -> None:
    """Put what blocks by group say into the arguments of a scene, beside what is given for all."""
    for group, block in blocks.items():
        for key, value in block.items():
            known = arguments.get(key)
            table = known if isinstance(known, dict) else {} if known is None else {ELSE: known}
            if group in table:
                raise InputError(f'{key} of "{group}" is given twice: in {key} and in [group.{group}]')
            arguments[key] = {**table, group: value}
