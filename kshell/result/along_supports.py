"""Forces and moments of supports along lines, as `Result.reaction_along` gives them: rows of samples along edges."""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.along import chains
from kshell.mesh.mesh import Mesh
from kshell.result.deferred import Deferred

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAMPLES = np.linspace(
    0.0, 1.0, 5
)  # where values are given along an edge, from its lower to its higher vertex


@dataclass(frozen=True)
class AlongSupport:
    """What one support exerts along its edges.

    Attributes
    ----------
    edges : (n,) int array
    x : (n, sample, 3) array
        Places of `SAMPLES` on each edge.
    lengths : (n,) array
    force, moment : (n, sample, 3) arrays
        Per length.
    ends : (k,) int array
        Vertices of concentrated forces.
    at_ends : (k, 3) array
        These forces.
    total : (2, 3) array
        Force, and moment about the origin, of all of it.
    """

    edges: Ints
    x: Floats
    lengths: Floats
    force: Floats
    moment: Floats
    total: Floats
    ends: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    at_ends: Floats = field(default_factory=lambda: np.zeros((0, 3)))

    def document(self, mesh: Mesh, stops: NDArray[np.bool_]) -> dict[str, Any]:
        """See `Result.reaction_along`; lines are divided at vertices of `stops`."""
        place = {int(e): k for k, e in enumerate(self.edges)}
        parts: dict[str, list[Any]] = {"line": [], "s": [], "x": [], "force": [], "moment": []}
        for number, chain in enumerate(chains(mesh, self.edges, stops)):
            start = 0.0
            for e, first in zip(chain.edges.tolist(), chain.vertices[:-1].tolist(), strict=True):
                k = place[e]
                way = slice(None) if mesh.edges[e, 0] == first else slice(None, None, -1)
                x = self.x[k, way]
                steps = np.linalg.norm(np.diff(x, axis=0), axis=1)
                parts["line"].append(np.full(len(x), number))
                parts["s"].append(
                    start + np.concatenate([[0.0], np.cumsum(steps)]) * self.lengths[k] / steps.sum()
                )
                parts["x"].append(x)
                parts["force"].append(self.force[k, way])
                parts["moment"].append(self.moment[k, way])
                start += float(self.lengths[k])
        shapes = {"line": (0,), "s": (0,), "x": (0, 3), "force": (0, 3), "moment": (0, 3)}
        out: dict[str, Any] = {
            key: np.concatenate(found) if found else np.zeros(shapes[key]) for key, found in parts.items()
        }
        out["ends"] = [
            {"at": mesh.points[v], "force": force} for v, force in zip(self.ends, self.at_ends, strict=True)
        ]
        out["resultant"] = {"force": self.total[0], "moment": self.total[1]}
        return out


def deferred(
    labels: Mapping[str, Any] | list[str], find: Callable[[str], dict[str, Any]]
) -> MutableMapping[str, dict[str, Any]]:
    """The entries of these supports, found when they are looked at."""
    return Deferred({label: partial(find, label) for label in labels})


def moment_about_origin(x: Floats, force: Floats) -> Floats:
    """(3,) of forces (..., 3) at places (..., 3)."""
    return np.asarray(np.cross(x, force).reshape(-1, 3).sum(axis=0))
