"""Shells like beams: the Raasch hook and the twisted beam."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import kshell as ks
from kshell.verify.cases.case import Case, case
from kshell.verify.cases.quantities import Compliance, Moves
from kshell.verify.cases.shell import Parameters, Shell, runs

Floats = NDArray[np.float64]

SMALL, LARGE, BEND = 14.0, 46.0, np.pi / 3  # radii of the hook, angle of its first arc
FIRST, WHOLE = SMALL * BEND, SMALL * BEND + LARGE * np.radians(150.0)


def hook(u: Floats, v: Floats) -> Floats:
    """Arc length and width to two arcs that bend oppositely."""
    first = np.minimum(u / SMALL, BEND)
    second = np.maximum(u - FIRST, 0) / LARGE
    x = SMALL * np.sin(first) + LARGE * (np.sin(second - BEND) + np.sin(BEND))
    z = SMALL * (1 - np.cos(first)) + LARGE * (np.cos(second - BEND) - np.cos(BEND))
    return np.stack([x, v, z], axis=-1)


def hook_slopes(u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Its first derivatives; there is no second one where the arcs meet."""
    turn = np.where(u < FIRST, u / SMALL, BEND - (u - FIRST) / LARGE)
    zero = np.zeros_like(u)
    return np.stack([np.cos(turn), zero, np.sin(turn)], axis=-1), np.stack([zero, zero + 1, zero], axis=-1)


def raasch() -> Iterator[Case]:
    """A curved strip clamped at its root, sheared by a force of 1 at its tip."""
    quarters = 4  # of the cells lie on the first arc: one
    chart = ks.geometry.Chart(hook, [hook_slopes], domain=((0, WHOLE), (0, 20)), name="hook")
    strip = Parameters(
        (0, WHOLE), (0, 20.0), ("root", "tip", "sides", "sides"),
        lambda s: np.interp(s, [0, 1 / quarters, 1], [0, FIRST / WHOLE, 1]),
    )  # fmt: skip
    end = hook(np.array(WHOLE), np.array(10.0))
    scene = {
        "thickness": 2.0,
        "material": ks.Isotropic(E=3300.0, nu=0.3),
        "supports": [ks.Clamped("root")],
        "loads": [ks.LineForce("tip", (0, 0.05, 0))],
    }
    middle = (float(end[0]), 10.0, float(end[2]))
    corner = (middle[0], 0.0, middle[2])
    yield case(
        "shell.raasch",
        "the Raasch hook under a shear force of 1 at its tip",
        Shell(chart, lambda n: strip.mesh(n, max(n // 6, 2)), scene),
        {"u_tip": Moves(middle, (0, 1, 0)), "u_corner": Moves(corner, (0, 1, 0)), "u_mean": Compliance()},
        runs((24, 48), (16, 32), (12, 24)),
    )


def twisted() -> Iterator[Case]:
    """Length 12, width 1.1, turned by 90 degrees, a force at its tip across or along its width there."""
    chart = ks.geometry.Helicoid(c=24 / np.pi)
    strip = Parameters((-0.55, 0.55), (0, np.pi / 2), ("sides", "sides", "root", "tip"))
    tip = (0.0, 0.0, 12.0)
    directions = {"across": (1.0, 0.0, 0.0), "along": (0.0, 1.0, 0.0)}
    for name, thickness, force in (("", 0.32, 1.0), (".thin", 0.0032, 1e-6)):
        for words, direction in directions.items():
            load = tuple(force / 1.1 * part for part in direction)
            scene = {
                "thickness": thickness,
                "material": ks.Isotropic(E=29e6, nu=0.22),
                "supports": [ks.Clamped("root")],
                "loads": [ks.LineForce("tip", load)],
            }
            yield case(
                f"shell.twisted_beam.{words}{name}",
                f"twisted beam, thickness {thickness:g}, force {words} its width at the tip",
                Shell(chart, lambda n: strip.mesh(max(n // 6, 2), n), scene),
                {"u_tip": Moves(tip, direction), "u_mean": Compliance(force)},
                runs((24, 48), (16, 32), (12, 24), argyris=(6, 12) if thickness > 0.1 else (12,)),
            )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (raasch, twisted) for one in family()]
