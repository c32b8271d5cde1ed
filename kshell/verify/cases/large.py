"""Large deflections: strips against the elastica, plates against von Karman's equations, shells against tables.

The scenes are those of large_scenes.py. The tables were computed with shells that have shear, which under a force at a
point sink in further; their uncertainty is what that and their meshes leave.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import kshell as ks
from kshell.verify.cases import large_scenes as scenes
from kshell.verify.cases.case import TRUE_SURFACE, Case, Run, case
from kshell.verify.cases.quantities import AtSlit, LimitLoad, Moves, Place, Quantity

UP: Place = (0.0, 0.0, 1.0)
DOWN: Place = (0.0, 0.0, -1.0)
BACK: Place = (-1.0, 0.0, 0.0)
QUICK = ("koiter3",)
Scene = Callable[[int], ks.Scene]


def large(
    id: str,
    description: str,
    scene: Scene,
    quantities: Mapping[str, Quantity],
    degrees: Mapping[int, tuple[int, ...]],
    order: int = 1,
    quick: tuple[str, ...] = QUICK,
    **options: Any,
) -> Case:
    """A case solved with large deflections.

    Parameters
    ----------
    scene : function of the refinement
    degrees : dict of degree to refinements
    order : int
        Of its meshes.
    **options
        Of the solve.
    """
    solve = {"large_deflection": True, **options}
    return case(
        f"large.{id}",
        description,
        lambda refinement, order: replace(scene(refinement), solve=solve),
        quantities,
        tuple(Run("koiter", n, order, degree) for degree, all_n in degrees.items() for n in all_n),
        quick=quick,
    )


def strips() -> Iterator[Case]:
    """Cantilevers of length 10 or 12, width 1, EI = 100."""
    tip: Place = (10.0, 0.5, 0.0)
    moves: dict[str, Quantity] = {"u_tip": Moves(tip, BACK), "w_tip": Moves(tip, UP)}
    degrees = {1: (16, 32), 2: (6, 12), 3: (4, 8)}
    for share in (0.5, 1.0):
        yield large(
            f"cantilever.P{4 * share:g}",
            f"cantilever, t/L = 0.01, end shear {4 * share:g} EI/L^2",
            lambda n, share=share: scenes.cantilever(n, share),  # type: ignore[misc]
            moves,
            degrees,
        )
    for alpha in (1, 2, 5, 10):
        yield large(
            f"elastica.P{alpha}",
            f"thin cantilever, t/L = 0.001, end shear {alpha} EI/L^2",
            lambda n, alpha=alpha: scenes.elastica(alpha, n),  # type: ignore[misc]
            moves,
            degrees,
        )
    for weight in (5, 20):
        yield large(
            f"heavy.G{weight}",
            f"thin cantilever under its own weight of {weight} EI/L^3 per length",
            lambda n, weight=weight: scenes.heavy(weight, n),  # type: ignore[misc]
            {"u_tip": Moves(tip, BACK), "drop": Moves(tip, DOWN)},
            degrees,
        )
    end: Place = (12.0, 0.5, 0.0)
    for turns in (0.5, 1.0):
        yield large(
            f"roll_up.{turns:g}",
            f"cantilever, t/L = 1/120, rolled up by an end moment, {turns:g} turns",
            lambda n, turns=turns: scenes.roll_up(turns, n),  # type: ignore[misc]
            {"u_tip": Moves(end, BACK), "w_tip": Moves(end, UP)},
            {1: (48,), 2: (24,), 3: (12, 24)},
            steps=10,
        )


def plates() -> Iterator[Case]:
    """Clamped, with edges that do not move: stretching carries more and more."""
    centre: dict[str, Quantity] = {"w_c": Moves((0.0, 0.0, 0.0), UP)}
    for Q in (1, 5, 20, 50):
        yield large(
            f"von_karman.Q{Q}",
            f"clamped circular plate, R/h = 100, nu = 0.3, pressure {Q} E h^4/R^4",
            lambda n, Q=Q: scenes.von_karman(Q, n),  # type: ignore[misc]
            centre,
            {1: (12, 24), 2: (6, 12), 3: (4, 8)},
            order=2,
        )
    middle: dict[str, Quantity] = {"w_c": Moves((0.5, 0.5, 0.0), UP)}
    for load in (38.3, 184.0, 402.0):
        yield large(
            f"clamped_square.Q{load:g}",
            f"clamped square plate, a/h = 500, nu = 0.3, pressure {load:g} E h^4/a^4",
            lambda n, Q=load: scenes.clamped_square(Q, n),  # type: ignore[misc]
            middle,
            {1: (16, 32), 2: (8, 16), 3: (5, 10)},
        )


def shells() -> Iterator[Case]:
    """A slit ring lifted, cylinders pulled and pinched."""
    for share in (0.25, 1.0):
        yield large(
            f"annulus.P{share:g}",
            f"ring with a slit, one side of it lifted by {0.8 * share:g} per length",
            lambda n, share=share: scenes.slit_annulus(n, 5 * n, share),  # type: ignore[misc]
            {"w_inner": AtSlit((6.0, 0.0, 0.0), UP), "w_outer": AtSlit((10.0, 0.0, 0.0), UP)},
            {1: (6,), 2: (4, 8), 3: (3, 6)},
            order=TRUE_SURFACE,
            steps=5,
        )
    radius, half = 4.953, 0.5 * 10.35
    pulled: dict[str, Quantity] = {
        "w_A": Moves((0.0, 0.0, radius), UP),
        "u_B": Moves((radius, 0.0, 0.0), BACK),
        "u_C": Moves((radius, half, 0.0), BACK),
    }
    for share in (0.25, 1.0):
        yield large(
            f"pull_out.P{share:g}",
            f"an eighth of an open cylinder pulled apart by two forces of {40000 * share:g}",
            lambda n, share=share: scenes.pull_out(n, 3 * n // 2, share=share),  # type: ignore[misc]
            pulled,
            {2: (6, 10), 3: (5, 8)},
            order=TRUE_SURFACE,
            quick=(),
            steps=5,
        )
    yield large(
        "semi_cylinder",
        "half of a semi-cylinder, clamped at one end, pinched at the other by a force of 2000",
        scenes.semi_cylinder,
        {"w_crown": Moves((0.0, 0.0, 101.6), DOWN)},
        {3: (10,)},
        order=TRUE_SURFACE,
        quick=(),
        steps=10,
    )


def roofs() -> Iterator[Case]:
    """A shallow roof snaps through under a force at its crown: the largest load, and the least after it."""
    kinds: dict[str, tuple[tuple[int, ...], float]] = {
        "isotropic": ((), 12.7),
        "0-90-0": ((0, 90, 0), 12.7),
        "90-0-90.thin": ((90, 0, 90), 6.35),
    }
    for name, (layup, thickness) in kinds.items():
        yield large(
            f"roof.{name}",
            f"hinged shallow roof of thickness {thickness:g}, {'/'.join(map(str, layup)) or 'isotropic'}",
            lambda n, layup=layup, thickness=thickness: scenes.roof(n, layup, thickness),  # type: ignore[misc]
            {"largest": LimitLoad(0), "least": LimitLoad(1)},
            {2: (6,), 3: (4,)},
            order=TRUE_SURFACE,
            quick=(),
            analysis="path",
        )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (strips, plates, shells, roofs) for one in family()]
