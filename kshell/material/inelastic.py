"""What makes a material remember its past: relaxation of its stress, and yielding with hardening.

Symbols
-------
E(t)        E (1 - sum_k g_k (1 - exp(-t / tau_k))): stress over strain a time t after a sudden strain (Prony series)
sigma_y     yield stress
H           growth of the yield stress per plastic strain: isotropic, kinematic
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.values import kinds

Floats = NDArray[np.float64]

Terms = tuple[tuple[float, float], ...]
# the same with the part (triangle,) that each term has in each triangle
Relaxing = tuple[tuple[Floats, float], ...]


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and np.isfinite(value)


def _relaxation(value: Any) -> Any:
    if value is None:
        return None
    pairs = [tuple(pair) if isinstance(pair, list | tuple) else () for pair in _listed(value)]
    if not pairs or not all(len(pair) == 2 and all(map(_number, pair)) for pair in pairs):
        raise ValueError(
            "must be a list of pairs [part of the stiffness, time], such as [[0.3, 1.0], [0.2, 10.0]]"
        )
    terms = tuple((float(g), float(tau)) for g, tau in pairs)
    if any(not g > 0.0 or not tau > 0.0 for g, tau in terms):
        raise ValueError("parts and times must be > 0")
    total = sum(g for g, _ in terms)
    if total >= 1.0:
        raise ValueError(
            f"the parts sum up to {total:g}: they must leave some of the stiffness, less than 1 in all"
        )
    return terms


def _hardening(value: Any) -> Any:
    if value is None:
        return None
    parts = (value, 0.0) if _number(value) else tuple(_listed(value))
    if len(parts) != 2 or not all(_number(part) and part >= 0.0 for part in parts):
        raise ValueError("must be a number >= 0, isotropic, or two such numbers [isotropic, kinematic]")
    return float(parts[0]), float(parts[1])


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else []


PAIR = kinds.listed(kinds.POSITIVE, 2, 2)
Relaxation = Annotated[Any, BeforeValidator(_relaxation), WithJsonSchema(kinds.listed(PAIR))]
Hardening = Annotated[
    Any,
    BeforeValidator(_hardening),
    WithJsonSchema(kinds.either(kinds.NUMBER, kinds.listed(kinds.NUMBER, 2, 2))),
]


def require_yield_stress(hardening: Any, yield_stress: float | None) -> None:
    """Raise InputError if a material hardens that never yields."""
    if hardening is not None and yield_stress is None:
        raise InputError(
            "material: hardening needs yield_stress: give it, or leave hardening out (a yield stress alone is only "
            "held against stresses, as utilisation)"
        )


@dataclass(frozen=True)
class Yielding:
    """Where and how a shell yields.

    Attributes
    ----------
    stress : (triangle,)
        Yield stress, infinite where the material is elastic.
    isotropic, kinematic : (triangle,)
        H.
    thickness : (triangle,)
    """

    stress: Floats
    isotropic: Floats
    kinematic: Floats
    thickness: Floats


@dataclass(frozen=True)
class Inelastic:
    """What a shell remembers of its past; at most one of both.

    Attributes
    ----------
    relaxation : tuple of ((triangle,) g, tau)
        Empty where there is none.
    yielding : Yielding, optional
    """

    relaxation: Relaxing = ()
    yielding: Yielding | None = None

    def __bool__(self) -> bool:
        return bool(self.relaxation) or self.yielding is not None


def relaxation_of(materials: Sequence[Sequence[Any]], part: NDArray[np.integer]) -> Relaxing:
    """The terms of all parts of a structure, with their share in each triangle.

    Parameters
    ----------
    materials : sequence of sequences
        Of each part those of its layers; None where it has none.
    part : (triangle,) int

    Raises
    ------
    InputError
        If layers of one part differ in it.
    """
    own: list[Terms] = []
    for layers in materials:
        found = {getattr(material, "relaxation", None) or () for material in layers}
        if len(found) > 1:
            raise InputError("material: relaxation differs between layers: all must have the same, or none")
        own.append(found.pop() if found else ())
    out = []
    for tau in sorted({tau for terms in own for _, tau in terms}):
        share = np.array([sum(g for g, mine in terms if mine == tau) for terms in own])
        out.append((share[part], tau))
    return tuple(out)


def yielding_of(materials: Sequence[Any], part: NDArray[np.integer], thickness: Floats) -> Yielding | None:
    """Yielding of parts of one material each, None where none hardens.

    Parameters
    ----------
    materials : sequence
        One for each part, None for parts of several or of none.
    part : (triangle,) int
    thickness : (triangle,)
    """
    hard = [getattr(material, "hardening", None) for material in materials]
    if all(one is None for one in hard):
        return None
    limits = [
        np.inf if one is None else float(material.yield_stress)
        for one, material in zip(hard, materials, strict=True)
    ]
    rows = np.array([(0.0, 0.0) if one is None else one for one in hard])
    return Yielding(np.array(limits)[part], rows[part, 0], rows[part, 1], thickness)
