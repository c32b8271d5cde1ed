"""A support at a point: its force and the deflection converge, the moment over it does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import kshell as ks
from kshell.verify.cases import find, meshes
from verification.failures.failure import Failure, Numbers, columns, lines, moment, panels, solved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (4, 8, 16, 32, 64)


def exact_force() -> float:
    """What holds the middle down: the deflection by pressure over that by a unit force, both without support."""
    pressed, pushed = find("ssss.uniform.ba1"), find("ssss.point.ba1")
    return pressed.references["w_c"].value / pushed.references["w_c"].value


def measure(quick: bool) -> Numbers:
    """The square on four simply supported sides and a point in the middle, Argyris."""
    pressed, pushed = find("ssss.uniform.ba1").references, find("ssss.point.ba1").references
    force = exact_force()
    compliance = pressed["compliance"].value - force**2 * pushed["w_c"].value
    held = dict.fromkeys(("x0", "x1", "y0", "y1"), "S")
    rows = []
    for n in SIZES[:4] if quick else SIZES:
        mesh = meshes.rectangle(1.0, 1.0, n)
        result = solved(mesh, held, "argyris", more=[ks.Fixed((0.5, 0.5, 0.0), "z")])
        found = sum(group["force"][2] for group in result.reactions.values())
        point = min(group["force"][2] for name, group in result.reactions.items() if name not in held)
        rows.append(
            {
                "cells": float(n),
                "force, error": abs(-point / force - 1),
                "compliance, error": abs(2 * result.strain_energy / compliance - 1),
                "moment over it": moment(result, 0.5, 0.5),
                "balance": abs(found + 1),
            }
        )
    return columns(rows)


def growth(numbers: Numbers) -> float:
    """Moment added by each halving of the mesh, mean over the last two."""
    return float(np.mean(np.diff(numbers["moment over it"])[-2:]))


def draw(numbers: Numbers) -> Figure:
    """What converges to the left, what does not to the right."""
    figure, (left, right) = panels(2)
    lines(left, numbers, "cells", ["force, error", "compliance, error"])
    n = numbers["cells"]
    left.loglog(n, 0.5 * n**-2.0, "--", color="0.6", linewidth=1, label="order 2")
    right.semilogx(n, numbers["moment over it"], "o-", color="C3", label="Argyris")
    theory = -exact_force() * 1.3 / (4 * np.pi) * np.log(2)
    middle = len(n) // 2
    right.semilogx(
        n, numbers["moment over it"][middle] + theory * np.log2(n / n[middle]), "--", color="0.6",
        label="P (1 + nu) / (4 pi) log h",
    )  # fmt: skip
    left.set(xlabel="cells per side", ylabel="relative error", title="Force of the support, compliance")
    right.set(xlabel="cells per side", ylabel="M_xx over the support", title="Moment over the support")
    for axes in (left, right):
        axes.set_xticks(n, [f"{int(k)}" for k in n])
        axes.minorticks_off()
        axes.legend(fontsize=8)
        axes.grid(alpha=0.25)
    return figure


FAILURE = Failure(
    "point_supports",
    "Supports at points",
    "A plate may be held at a point, because its deflection is continuous where a membrane's is not. But the moment "
    "over the support is that of a point force, P (1 + nu) / (4 pi) log h: it grows by the same amount whenever the "
    "mesh is halved, and whatever is printed there is a property of the mesh.",
    "Forces and deflections converge with order 2, faster with layers of smaller triangles around the point. A moment "
    "for design needs the true size of the support: hold a small group of edges or spread the stiffness over an area.",
    measure,
    draw,
)
