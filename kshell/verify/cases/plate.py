"""Plates with bending stiffness 1: thickness 1 and E = 12 (1 - nu^2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import kshell as ks
from kshell.verify.cases.case import Run

LINEAR = {"large_deflection": False}  # whatever the loads: the references are
SUPPORTS: dict[str, Callable[[str], Any]] = {
    "C": ks.Clamped,
    "S": ks.SimplySupported,
    "Y": ks.Symmetry,
    "G": lambda on: ks.Fixed(on, "r"),  # guided: no slope, free to move
}


def runs(argyris: int, morley: int, curved: bool = False, koiter: tuple[int, ...] = ()) -> tuple[Run, ...]:
    """Both elements at their refinement; on curved edges Argyris on meshes of order 1 and 2.

    ``koiter`` has the refinements of degree 1, 2, 3, where the plate is solved as a shell, too.
    """
    both = [Run("argyris", argyris), Run("morley", morley)]
    shells = [Run("koiter", n, 2 if curved else 1, degree) for degree, n in enumerate(koiter, 1)]
    return (*both, *([Run("argyris", argyris, order=2)] if curved else []), *shells)


def unit_material(nu: float = 0.3) -> ks.Isotropic:
    """With bending stiffness 1 at thickness 1."""
    return ks.Isotropic(E=12 * (1 - nu**2), nu=nu)


def plate(
    mesh: ks.Mesh | Path,
    held: Mapping[str, str],
    loads: Sequence[Any],
    material: Any = None,
    more: Sequence[Any] = (),
) -> ks.Scene:
    """A plate of thickness 1 held by letters: group to C, S, Y (symmetry), G (guided) or F (free)."""
    supports = [SUPPORTS[letter](on) for on, letter in held.items() if letter != "F"]
    return ks.Scene(
        mesh=mesh,
        thickness=1.0,
        material=material or unit_material(),
        supports=[*supports, *more],
        loads=list(loads),
        solve=LINEAR,
    )
