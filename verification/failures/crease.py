"""A flat sheet folded to a sharp crease, at nine angles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from verification.failures.bending_energy import HINGES, hinge_energy, koiter_energy
from verification.failures.bent import vee
from verification.failures.failure import Failure, Numbers, columns, lines, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OPENINGS = (3 / 4, 1 / 2, 3 / 8, 1 / 4, 3 / 16, 1 / 8, 3 / 32, 1 / 16, 1 / 32)  # of pi
ORDERS = (1, 2, 3)


def measure(quick: bool) -> Numbers:
    """Energies over that of a circular arc in the place of the crease, as long as a cell is wide."""
    n = 2 if quick else 4
    rows = []
    for opening in OPENINGS:
        bent = vee(n, opening * np.pi)
        row = {"opening (degrees)": 180 * opening}
        row |= {name: hinge_energy(bent, name) / bent.squared for name in HINGES}
        row |= {f"Koiter {p}": koiter_energy(bent, p) / bent.koiter for p in ORDERS}
        rows.append(row)
    return columns(rows)


def growth(form: str | int, opening: float = 0.25, sizes: tuple[int, int] = (2, 4)) -> float:
    """How the energy grows when the mesh is halved, of a hinge or of a Koiter order: 2 for 1 / h."""
    found = []
    for n in sizes:
        bent = vee(n, opening * np.pi)
        found.append(hinge_energy(bent, form) if isinstance(form, str) else koiter_energy(bent, form))
    return found[1] / found[0]


def draw(numbers: Numbers) -> Figure:
    """Ratios against the angle of the fold."""
    figure, (axes,) = panels(height=4.2)
    x = "fold (degrees)"
    lines(
        axes,
        {x: 180 - numbers["opening (degrees)"], **numbers},
        x,
        [name for name in numbers if name != "opening (degrees)"],
    )
    axes.set_xscale("linear")
    axes.set_xticks([45, 90, 112.5, 135, 157.5, 180], ["45", "90", "112.5", "135", "157.5", "180"])
    axes.minorticks_off()
    axes.set(
        xlabel="angle of the fold (degrees)",
        ylabel="energy / (D angle² L / 2h)",
        title="A flat sheet with a sharp crease",
    )
    return figure


FAILURE = Failure(
    "crease",
    "A sharp crease in a flat sheet",
    "A sheet of 0.01 by 0.1 folded along its middle at nine angles has infinite bending energy; every mesh gives "
    "it a finite one that grows like 1 / h. What differs is how it grows with the angle: the tangent of half the "
    "angle is a barrier that costs 180 times too much at a fold of 174 degrees, the sine lets the sheet fold flat"
    " for half of what it should cost.",
    "kshell measures angles: the energy of a crease is the same multiple of angle^2 / h at every angle, that of a"
    " circular arc as wide as about a cell. A crease that belongs to the shape at rest is kept and costs nothing,"
    " one that turns freely is a hinge. Where a solution makes sharp creases of its own, its energy is a property"
    " of the mesh, and refining shows it.",
    measure,
    draw,
)
