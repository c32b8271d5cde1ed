"""Which parts of lines are seen beside a surface: matplotlib draws lines over all faces, also those in front of them.

The faces are sampled into a picture of depths, and of each line the pieces are kept that nothing is nearer than.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.lattice import lattice

Floats = NDArray[np.float64]

PIXELS = 220  # of the picture of depths, each way
FINE = 0.6  # pixels between samples of a face
PIECE = 1.5  # pixels of a piece of a line
DEEPER = 0.012  # of the range of depths: what is no deeper than that lies on the surface


class Depths:
    """Depths of faces as seen in 3D axes, whose limits and view are set.

    Parameters
    ----------
    axes : Axes3D
    faces : (n, 3, 3)
        Corners of triangles.
    """

    def __init__(self, axes: Any, faces: Floats) -> None:
        self._matrix = np.asarray(axes.get_proj(), dtype=float)
        x = self._projected(faces)  # (n, 3, xyz)
        self._low = x[..., :2].min(axis=(0, 1))
        self._scale = (PIXELS - 1) / max(float(np.ptp(x[..., :2], axis=(0, 1)).max()), 1e-300)
        self._slack = DEEPER * max(float(np.ptp(x[..., 2])), 1e-300)
        self._buffer = np.full((PIXELS + 2, PIXELS + 2), np.inf)
        sides = np.linalg.norm(x[:, [1, 2, 0], :2] - x[..., :2], axis=2).max(axis=1) * self._scale
        # few different numbers of samples, each for all faces that need no more
        steps = 2 ** np.ceil(np.log2(np.maximum(sides / FINE, 1.0))).astype(int)
        for step in np.unique(steps).tolist():
            points = (lattice(step) @ x[steps == step]).reshape(-1, 3)
            i, j = self._pixel(points)
            np.minimum.at(self._buffer, (i, j), points[:, 2])
        near = [self._buffer[a : a + PIXELS, b : b + PIXELS] for a in range(3) for b in range(3)]
        # the nearest thing in a pixel hides only what is behind all that is seen around it, too
        seen = np.stack([np.where(np.isfinite(part), part, -np.inf) for part in near]).max(axis=0)
        self._limit = np.where(np.isfinite(seen), seen, np.inf) + self._slack

    def _projected(self, points: Floats) -> Floats:
        ones = np.ones((*points.shape[:-1], 1))
        h = np.concatenate([points, ones], axis=-1) @ self._matrix.T
        return np.asarray(h[..., :3] / h[..., 3:])

    def _pixel(self, projected: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """In the picture with a rim of one pixel."""
        at = np.rint((projected[..., :2] - self._low) * self._scale).astype(np.int64)
        at = np.clip(at, -1, PIXELS) + 1
        return at[..., 0], at[..., 1]

    def visible(self, lines: Floats) -> Floats:
        """(piece, 2, 3) the pieces of polylines (line, point, 3) that no face hides, in their order."""
        if not len(lines):
            return np.zeros((0, 2, 3))
        ends = np.stack([lines[:, :-1], lines[:, 1:]], axis=2).reshape(-1, 2, 3)
        flat = self._projected(ends)[..., :2]
        length = np.linalg.norm(flat[:, 1] - flat[:, 0], axis=1) * self._scale
        count = np.clip(np.ceil(length / PIECE), 1, 4 * PIXELS).astype(int)
        number = np.repeat(np.arange(len(ends)), count)
        k = np.arange(len(number)) - np.repeat(np.cumsum(count) - count, count)
        start, end = (k / count[number])[:, None], ((k + 1) / count[number])[:, None]
        a, b = ends[number, 0], ends[number, 1]
        pieces = np.stack([a + start * (b - a), a + end * (b - a)], axis=1)
        middle = self._projected(pieces.mean(axis=1))
        i, j = self._pixel(middle)
        inside = (i > 0) & (j > 0) & (i <= PIXELS) & (j <= PIXELS)
        limit = np.full(len(pieces), np.inf)
        limit[inside] = self._limit[i[inside] - 1, j[inside] - 1]
        return np.asarray(pieces[middle[:, 2] <= limit])
