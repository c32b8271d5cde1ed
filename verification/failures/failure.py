"""What every entry of the gallery is: numbers, a picture, and words about what kshell does."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import kshell as ks
from kshell.verify.cases import meshes
from kshell.verify.cases.plate import plate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]
MOST_COLUMNS = 12
Numbers = Mapping[str, Floats]  # columns of equal length


@dataclass(frozen=True)
class Failure:
    """A place where methods fail.

    Attributes
    ----------
    id, title : str
    what : str
        What fails, and why.
    kshell : str
        What kshell does about it.
    measure : function
        Quick or not, to columns of numbers.
    draw : function
        The numbers to a picture.
    """

    id: str
    title: str
    what: str
    kshell: str
    measure: Callable[[bool], Numbers]
    draw: Callable[[Numbers], Figure]


def text_table(numbers: Numbers) -> str:
    """Columns under their names; many of them as rows beside their names."""
    if len(numbers) > MOST_COLUMNS:
        start = max(map(len, numbers))
        return "\n".join(
            f"{name:{start}}" + "".join(f"{value:12.4g}" for value in values)
            for name, values in numbers.items()
        )
    width = [max(len(name), 11) for name in numbers]
    lines = ["  ".join(name.rjust(w) for name, w in zip(numbers, width, strict=True))]
    for row in zip(*numbers.values(), strict=True):
        lines.append("  ".join(f"{value:{w}.4g}" for value, w in zip(row, width, strict=True)))
    return "\n".join(lines)


def columns(rows: Sequence[Mapping[str, float]]) -> Numbers:
    """Columns of a list of rows."""
    return {name: np.array([row[name] for row in rows], dtype=float) for name in rows[0]}


def panels(count: int = 1, height: float = 3.8) -> tuple[Figure, list[Axes]]:
    """A figure with panels side by side."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(
        1,
        count,
        figsize=(5.6 * count if count > 1 else 7, height),
        squeeze=False,
        layout="constrained",
        dpi=100,
    )
    return figure, list(axes[0])


def lines(axes: Axes, numbers: Numbers, x: str, names: Sequence[str], floor: float = 1e-16) -> None:
    """Columns over a column, both logarithmic; a cross at the top where there is no answer."""
    at_top = axes.get_xaxis_transform()
    for k, name in enumerate(names):
        y = np.maximum(numbers[name], floor)
        lost = ~np.isfinite(y)
        y[lost] = np.nan
        colour = f"C{k}"
        axes.loglog(
            numbers[x], y, "os^vD"[k % 5] + "-", color=colour, markersize=4.5, linewidth=1.3, label=name
        )
        if lost.any():
            place = np.full(lost.sum(), 0.96 - 0.05 * k)
            words = f"{name}: no answer"
            axes.plot(numbers[x][lost], place, "x", color=colour, markersize=8, transform=at_top, label=words)
    axes.grid(alpha=0.25)
    axes.legend(fontsize=8)


def solved(mesh: ks.Mesh, held: Mapping[str, str], element: str, load: Any = None, **more: Any) -> ks.Result:
    """A plate of bending stiffness 1 under the pressure 1, without warnings on the screen."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ks.KshellWarning)
        scene = plate(mesh, held, [load or ks.Pressure(1.0)], **more)
        return ks.solve(scene, element=element, large_deflection=False)


def deflection(result: ks.Result, x: float, y: float) -> float:
    """At a point."""
    return float(result.at((x, y, 0.0))["u"][0, 2])


def moment(result: ks.Result, x: float, y: float) -> float:
    """M_xx at a point."""
    return float(result.at((x, y, 0.0))["M"][0, 0])


def square(points: Floats, triangles: NDArray[np.int64]) -> ks.Mesh:
    """A mesh with all its boundary in the group edge."""
    return meshes.mesh(points, triangles, {"edge": meshes.everywhere})
