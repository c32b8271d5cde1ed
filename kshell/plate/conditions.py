"""What supports and curved lines demand of the degrees of freedom, collected before the unknowns are counted."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass
class Conditions:
    """Rows collected from the supports.

    Attributes
    ----------
    fans, rows, values
        Lists of (n,) fans, which up to the number of vertices are the vertices, (n, per_vertex) rows on scaled
        degrees of freedom, (n,) values.
    edges, edge_values
        Lists of (n,) edges whose degree of freedom is fixed, and (n,) physical values.
    triangle_edges, triangles, triangle_rows, triangle_values
        Lists of (n,) edges, (n,) triangles, (n, local) rows on physical degrees of freedom and their (n,) values, which
        determine the edges' degrees of freedom from the others of the triangle.
    slope_vertices, slopes
        Lists of (n,) vertices and (n, 2) directions in which the slope vanishes, for multigrid.
    along
        Lists of (n, end) vertices and (n, end, 2) tangents of edges, and whether the slope vanishes along and across
        them, for multigrid, too: what holds along an edge, whether the element has gradients at its vertices or not.
    """

    fans: list[Ints] = field(default_factory=list)
    rows: list[Floats] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)
    edges: list[Ints] = field(default_factory=list)
    edge_values: list[Floats] = field(default_factory=list)
    triangle_edges: list[Ints] = field(default_factory=list)
    triangles: list[Ints] = field(default_factory=list)
    triangle_rows: list[Floats] = field(default_factory=list)
    triangle_values: list[Floats] = field(default_factory=list)
    slope_vertices: list[Ints] = field(default_factory=list)
    slopes: list[Floats] = field(default_factory=list)
    along: list[tuple[NDArray[np.integer], Floats, bool, bool]] = field(default_factory=list)

    def vanishing_slopes(self) -> Iterator[tuple[Ints, Floats]]:
        """(n,) vertices and (n, 2) directions in which the slope vanishes there."""
        yield from zip(self.slope_vertices, self.slopes, strict=True)
        for ends, tangents, along, across in self.along:
            t, vertices = tangents.reshape(-1, 2), ends.ravel().astype(np.int64)
            if along:
                yield vertices, t
            if across:
                yield vertices, np.stack([t[:, 1], -t[:, 0]], axis=1)

    def at_vertices(self, fans: NDArray[np.integer], rows: Floats, values: Floats | float = 0.0) -> None:
        """Add one row per fan, or vertex; rows are normalised here."""
        size = np.linalg.norm(rows, axis=1)
        self.fans.append(np.asarray(fans, dtype=np.int64))
        self.rows.append(rows / size[:, None])
        self.values.append(np.broadcast_to(np.asarray(values, dtype=float), size.shape) / size)


@dataclass(frozen=True)
class SharedSlopes:
    """Slopes at the true middles of curved edges inside, common to the triangles on both sides.

    Attributes
    ----------
    edges, triangles : (n,) int arrays
        Each edge twice, with either triangle.
    rows : (n, local) array
        The slope along a normal of the edge, the same for both, on the triangle's physical degrees of freedom.
    """

    edges: Ints
    triangles: Ints
    rows: Floats
