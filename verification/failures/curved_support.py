"""Simple support on a curved edge that the mesh shows as chords: the paradox of Babuska."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kshell.verify.cases import find, meshes
from verification.failures.failure import Failure, Numbers, columns, deflection, lines, panels, solved
from verification.peers import scikit_fem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DISK = (5 + 0.3) / (1 + 0.3) / 64
POLYGONS = 3 / 64  # the limit of simply supported polygons, for every nu
CLAMPED = 1 / 64
RINGS = (2, 3, 4, 6, 8, 12)
SIDES_PER_RING = 6


def measure(quick: bool) -> Numbers:
    """Deflections in the middle of the disk of radius 1 against the number of sides."""
    rows = []
    for n in (2, 4, 8) if quick else RINGS:
        mesh = meshes.ellipse(n)
        bare = scikit_fem.solve(mesh.points[:, :2], mesh.triangles, "argyris", "supported")
        row = {"sides": float(SIDES_PER_RING * n), "chords held (scikit-fem)": bare.deflection(0.0, 0.0)}
        for element in ("argyris", "morley"):
            row[f"kshell {element}"] = deflection(solved(mesh, {"edge": "S"}, element), 0.0, 0.0)
        rows.append(row)
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """Values beside the three limits."""
    figure, (axes,) = panels()
    lines(axes, numbers, "sides", [name for name in numbers if name != "sides"])
    sides = [3, 4, 5, 6, 8, 12]
    exact = [find(f"polygon.ss.{n}").references["w_c"].value for n in sides]
    axes.plot(sides, exact, "k+--", label="true polygons")
    limits = {"disk 0.0637": DISK, "polygons 3/64": POLYGONS, "clamped 1/64": CLAMPED}
    for name, value in limits.items():
        axes.axhline(value, color="0.6", linewidth=0.8)
        axes.text(2.6, value + 0.0005, name, fontsize=8)
    axes.set_xscale("log")
    axes.set_yscale("linear")
    axes.set_xticks([3, 6, 12, 24, 48, 72], ["3", "6", "12", "24", "48", "72"])
    axes.minorticks_off()
    axes.set(
        xlabel="sides",
        ylabel="deflection in the middle",
        title="Simply supported disk",
        ylim=(0, None),
        xlim=(2.5, 90),
    )
    axes.legend(fontsize=8, loc="center right")
    return figure


FAILURE = Failure(
    "curved_support",
    "Hard simple support on a curved edge",
    "Polygons in a circle tend to the disk, but their simply supported plates do not: at each corner the deflection "
    "vanishes along two directions, so the slope is zero. Their limit is w = 3/64 instead of 0.0637 (Babuska). "
    "Argyris elements that are held along every chord have a corner at every mesh vertex and are stiffer still: "
    "they tend to the clamped plate, 1/64, and nothing warns.",
    "The true curve is rebuilt from the boundary vertices, the conditions are put on its tangent, and turns of the "
    "boundary count as corners only where they are sharp. True polygons keep their corners (dashed).",
    measure,
    draw,
)


def off_by(numbers: Numbers) -> dict[str, float]:
    """The finest value of each method over the true one, less 1."""
    return {
        name: float(np.asarray(values)[-1] / DISK - 1) for name, values in numbers.items() if name != "sides"
    }
