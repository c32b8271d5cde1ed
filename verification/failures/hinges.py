"""Bending by hinges at the edges, on four families of meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from verification.failures.bending_energy import hinge_energy, koiter_energy
from verification.failures.bent import FAMILIES, half_cylinder, sphere_zone
from verification.failures.failure import Failure, Numbers, columns, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (8, 16, 32)
SURFACES = {"cylinder": half_cylinder, "sphere": sphere_zone}
ORDER = 2
WHERE = {"cylinder": "cells around", "sphere": "cells from south to north"}


def measure(quick: bool) -> Numbers:
    """Energies over the exact ones."""
    rows = []
    for n in (6, 12) if quick else SIZES:
        row = {"cells": float(n)}
        for name, make in SURFACES.items():
            for family in FAMILIES:
                bent = make(n, family)
                row[f"{name}, {family}: hinges"] = hinge_energy(bent, "hinge, angle") / bent.squared
                row[f"{name}, {family}: Koiter"] = koiter_energy(bent, ORDER) / bent.koiter
        rows.append(row)
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """One panel per surface."""
    figure, axes = panels(len(SURFACES), height=4.2)
    n = numbers["cells"]
    for place, name in zip(axes, SURFACES, strict=True):
        for k, family in enumerate(FAMILIES):
            style = {"color": f"C{k}", "marker": "os^v"[k], "markersize": (9, 5, 5, 5)[k]}
            place.plot(n, numbers[f"{name}, {family}: hinges"], label=f"hinges, {family}", **style)
            place.plot(n, numbers[f"{name}, {family}: Koiter"], linestyle="--", **style)
        place.plot([], [], "k--", label=f"Koiter, p = {ORDER}, all four")
        place.axhline(1.0, color="0.6", linewidth=0.8)
        place.set_xscale("log")
        place.set_xticks(n, [f"{int(k)}" for k in n])
        place.minorticks_off()
        place.set(
            xlabel=WHERE[name],
            ylim=(0, 5.5),
            title={"cylinder": "Half cylinder", "sphere": "Zone of a sphere"}[name],
        )
        place.grid(alpha=0.25)
    axes[0].set_ylabel("bending energy / exact")
    axes[1].legend(fontsize=8, loc="upper right")
    return figure


def limits(numbers: Numbers, kind: str) -> dict[str, float]:
    """The finest values of "hinges" or "Koiter"."""
    return {
        name.removesuffix(f": {kind}"): float(e[-1])
        for name, e in numbers.items()
        if name.endswith(f": {kind}")
    }


FAILURE = Failure(
    "hinges",
    "Bending by hinges at the edges",
    "A hinge at every edge with the energy 3/2 D |e|^2 angle^2 / (A1 + A2) (Grinspun and others 2003) is cheap "
    "and needs no more than the vertices. But its limit is a property of the triangulation: a cylinder has 3.0 "
    "times its energy on a grid of one diagonal and 4.4 times on a crossed one, a zone of a sphere 1.5 to 2.0 "
    "times that of squared mean curvature. No stiffness that is fitted to one mesh or one shape is right for "
    "another.",
    "The Koiter triangle measures the angle from each triangle to a director that both sides share, and finds "
    "moments that are in equilibrium with it. All families tend to the same energy, and to the exact one, "
    "with an error like h^2 for p = 1 and h^4 for p = 2.",
    measure,
    draw,
)
