"""Reactions along supports: force and moment per length over the place on each line, forces at ends in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.result.result import Result
from kshell.values.units import labelled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

MOST = 8  # supports drawn: those with the largest forces
SMALL = 1e-3  # components smaller than this part of the largest of all supports are not drawn
SOME = 0.02  # forces at ends smaller than this part of the largest resultant are not named
MOST_ENDS = 2
ROUNDING = 1e-9  # of the largest resultant, what is nothing
COLUMNS = 2
# inches: width of a panel, height of its curves, and what is left beside these; what titles of panels, numbers, a line
# of words below them and the title of the picture take. Places are set here: to find them from the sizes of texts takes
# longer than to draw everything.
WIDE, UP, LEFT, RIGHT, ABOVE, NUMBERS, LINE, HEAD = 3.75, 1.75, 0.66, 0.12, 0.3, 0.26, 0.12, 0.27
# powers of force and length in their units
KEYS: dict[str, tuple[int, int]] = {"force": (1, -1), "moment": (1, 0)}
COLOURS = ("#b2182b", "#1a7a4c", "#2166ac")  # of x, y, z


def reactions_figure(result: Result) -> Figure:
    """A panel for the forces of each support, and one for its moments where there are some."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    every = {name: result.reaction_along(name) for name in result.along_supports}
    lines = {name: found for name, found in every.items() if len(found["s"])}
    chosen = sorted(lines, key=lambda name: -np.linalg.norm(lines[name]["resultant"]["force"]))[:MOST]
    chosen = [name for name in lines if name in chosen]
    largest = {key: max((np.abs(lines[n][key]).max() for n in chosen), default=0.0) for key in KEYS}
    panels = [
        (name, key)
        for name in chosen
        for key in KEYS
        if largest[key] > 0.0 and np.abs(lines[name][key]).max() >= SMALL * largest[key]
    ] or [(name, "force") for name in chosen]
    columns = min(COLUMNS, len(panels))
    words = [_over(lines[name]) + (_at_ends(every, name) if key == "force" else "") for name, key in panels]
    rows = [words[k : k + columns] for k in range(0, len(panels), columns)]
    below = [NUMBERS + LINE * (1 + max(text.count("\n") for text in row)) for row in rows]
    wide = WIDE * columns
    tall = (HEAD if result.title else 0.0) + (ABOVE + UP) * len(rows) + sum(below)
    figure = Figure(figsize=(wide, tall))
    FigureCanvasAgg(figure)
    if result.title:
        figure.suptitle(result.title, fontsize=11, y=1.0 - 0.1 / tall)
    for number, (name, key) in enumerate(panels):
        row, column = divmod(number, columns)
        bottom = (ABOVE + UP) * (len(rows) - 1 - row) + sum(below[row:])
        place = ((WIDE * column + LEFT) / wide, bottom / tall, (WIDE - LEFT - RIGHT) / wide, UP / tall)
        axes = figure.add_axes(place)
        _curves(axes, lines[name], key, largest[key])
        axes.set_title(labelled(f"{name}: {key} per length", result.units, *KEYS[key]), fontsize=9, y=1.0)
        axes.legend(fontsize=8)
        axes.set_xlabel(words[number], fontsize=6.5)
        axes.xaxis.set_label_coords(0.5, -NUMBERS / UP)
    return figure


def _curves(axes: Axes, found: dict[str, Any], key: str, largest: float) -> None:
    """Each component over the length; lines after each other with a gap."""
    starts = np.flatnonzero(np.diff(found["line"])) + 1
    s, start = np.array(found["s"], dtype=float), 0.0
    for part in np.split(np.arange(len(s)), starts):
        s[part] += start
        start = s[part[-1]]
        axes.axvline(start, color="0.8", linewidth=0.8)
    gaps = np.insert(s, starts, np.nan)
    for axis, letter in enumerate("xyz"):
        values = found[key][:, axis]
        if np.abs(values).max() >= SMALL * largest:
            broken = np.insert(values, starts, np.nan)
            axes.plot(gaps, broken, color=COLOURS[axis], linewidth=1.1, label=letter)
    axes.axhline(0.0, color="black", linewidth=0.5)
    axes.tick_params(labelsize=7)
    axes.locator_params(nbins=5)
    axes.set_xlim(0.0, max(start, 1e-300))


def _over(found: dict[str, Any]) -> str:
    """What is drawn over."""
    if found["line"][0] != found["line"][-1]:
        return "length along the lines, one after the other"
    return f"length from {_place(found['x'][0])} to {_place(found['x'][-1])}"


def _place(x: Floats) -> str:
    return f"({', '.join(f'{part:.4g}' for part in x)})"


def _at_ends(every: dict[str, dict[str, Any]], name: str) -> str:
    """The largest forces at ends of a support in words."""
    scale = max(float(np.linalg.norm(found["resultant"]["force"])) for found in every.values())
    words = []
    ends = sorted(every[name]["ends"], key=lambda end: -float(np.linalg.norm(end["force"])))
    for end in ends[:MOST_ENDS]:
        force = np.array(end["force"])
        if np.linalg.norm(force) >= SOME * scale:
            force[np.abs(force) < ROUNDING * scale] = 0.0
            words.append(f"\nforce {_place(force)} at {_place(end['at'])}")
    return "".join(words)
