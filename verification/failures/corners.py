"""Obtuse supported corners and re-entrant corners: the rate is lost, and what layers of triangles give back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kshell.verify.cases import find, meshes
from verification.failures.failure import Failure, Numbers, columns, deflection, lines, panels, solved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (4, 8, 16, 32)
LAYERS = {"without": 0, "with": 12}
LETTERS = {"skew": "S", "L-shape": "C"}


def measure(quick: bool) -> Numbers:
    """Relative errors of Argyris: deflection of the rhombus with 30 degrees, compliance of the L-shape."""
    skew, l_shape = find("skew.ss.30").references, find("lshape.clamped").references
    t = np.radians(30)
    middle = ((1 + np.cos(t)) / 2, np.sin(t) / 2)
    rows = []
    for n in SIZES[:3] if quick else SIZES:
        row = {"cells": float(n)}
        for name, layers in LAYERS.items():
            result = solved(meshes.rhombus(30, n, layers), {"edge": "S"}, "argyris")
            row[f"skew, {name} layers"] = abs(deflection(result, *middle) / skew["w_c"].value - 1)
            result = solved(meshes.l_shape(n, layers), {"edge": "C"}, "argyris")
            row[f"L-shape, {name} layers"] = abs(2 * result.strain_energy / l_shape["compliance"].value - 1)
        rows.append(row)
    return columns(rows)


def rates(numbers: Numbers) -> dict[str, float]:
    """Slope over the last two meshes."""
    n = numbers["cells"]
    return {
        name: float(np.log(e[-2] / e[-1]) / np.log(n[-1] / n[-2]))
        for name, e in numbers.items()
        if name != "cells"
    }


def draw(numbers: Numbers) -> Figure:
    """Errors with the theoretical slopes."""
    figure, (axes,) = panels(height=4.2)
    lines(axes, numbers, "cells", [name for name in numbers if name != "cells"])
    n = numbers["cells"]
    for slope, first, words in ((0.4, 0.2, "order 2/5"), (1.09, 8e-3, "order 1.09")):
        axes.loglog(n, first * (n / n[0]) ** -slope, "--", color="0.6", linewidth=1)
        axes.text(
            n[-1], first * (n[-1] / n[0]) ** -slope, words, fontsize=8, color="0.4", va="bottom", ha="right"
        )
    axes.set_xticks(n, [f"{int(k)}" for k in n])
    axes.minorticks_off()
    axes.set(xlabel="cells per side", ylabel="relative error", title="Argyris elements at singular corners")
    return figure


FAILURE = Failure(
    "corners",
    "Obtuse supported and re-entrant corners",
    "At a simply supported corner of 150 degrees w grows like r^(6/5), at a clamped re-entrant one of 270 degrees like "
    "r^1.54: moments are unbounded, and elements of any degree converge with the order 2 (6/5 - 1) = 0.4 and "
    "1.09 in energy and deflection, slower than Morley on a smooth plate.",
    "A warning names such corners with their angle. Layers of ever smaller triangles towards the corner cost few "
    "unknowns and lower the error by powers of ten; moments next to the corner stay mesh dependent and are not "
    "to be designed by.",
    measure,
    draw,
)
