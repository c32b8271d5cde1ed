"""What a scene asks of every result besides its fields: values along lines."""

from __future__ import annotations

import numpy as np

from kshell.mesh.words import place
from kshell.result.result import Result
from kshell.scene.scene import Scene


def answer_asked(result: Result, scene: Scene) -> None:
    """Add `lines` to a result, where the scene asks for them and the result has values."""
    if result.evaluate is not None:
        for line in scene.lines:
            result.lines[line.name] = result.along(line.start, line.end, line.n)
            result.warnings += _off(result, line.name)


def _off(result: Result, name: str) -> list[str]:
    values = result.lines[name]
    worst = int(np.argmax(values["distance"]))
    typical = float(np.sqrt(2 * np.median(result.mesh.areas)))
    distance = float(values["distance"][worst])
    if distance <= typical:
        return []
    return [
        f'line "{name}": it runs {distance:.3g} off the {result.model["kind"]}, more than a mesh size ({typical:.3g}); '
        f"values are those at the nearest points, there {place(values['x'][worst])}"
    ]
