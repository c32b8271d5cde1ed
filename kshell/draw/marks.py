"""Where a field is largest and smallest: signs and words in pictures, and a view from which the largest is seen."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.result.rows import Rows

Floats = NDArray[np.float64]

# of a plan view: sign, words left of it or right
SIGNS = {"largest": "^", "smallest": "v"}
STYLE: dict[str, Any] = {
    "markersize": 8,
    "color": "white",
    "markeredgecolor": "black",
    "linestyle": "",
    "clip_on": False,
}
BOX: dict[str, Any] = {"boxstyle": "round,pad=0.15", "facecolor": "white", "alpha": 0.75, "linewidth": 0}
# elevations and azimuths in degrees that are tried, the usual one first
USUAL = (28.0, -58.0)
VIEWS = (USUAL, *((up, round_) for up in (28.0, 10.0, -25.0) for round_ in range(-148, 212, 45)))
NEAR = 1e-6  # of the size: triangles that hold the point itself do not hide it


class Mark(NamedTuple):
    """A place in a picture.

    Attributes
    ----------
    kind : "largest" or "smallest"
    node : int
        Of the nodes of the rows of fields.
    words : str
    """

    kind: str
    node: int
    words: str


def marks(values: Floats, rows: Rows) -> list[Mark]:
    """The largest and the smallest of values (node,), with the surface groups they lie in.

    None of a constant field; where all have one sign the one that is nearest to zero says nothing, and is left out.
    """
    high, low = int(np.argmax(values)), int(np.argmin(values))
    if not values[high] > values[low]:
        return []
    many = len(np.unique(rows.group)) > 1
    out = []
    ends = [("largest", high)] if values[high] > 0.0 else []
    ends += [("smallest", low)] if values[low] < 0.0 else []
    for kind, node in ends:
        group = str(rows.group[node]) if many and node < len(rows.group) else ""
        out.append(Mark(kind, node, f"{values[node]:.4g}" + (f" {group}" if group else "")))
    return out


def draw_marks(axes: Any, found: list[Mark], nodes: Floats) -> list[Any]:
    """Draw marks at nodes (node, 2 or 3); what was drawn."""
    drawn: list[Any] = []
    middle = 0.5 * (nodes[:, 0].min() + nodes[:, 0].max())
    for mark in found:
        x = nodes[mark.node]
        drawn += axes.plot(*x[:, None], marker=SIGNS[mark.kind], zorder=9, **STYLE)
        if len(x) == 2:
            right = x[0] < middle
            drawn.append(
                axes.annotate(
                    mark.words,
                    x,
                    xytext=(7 if right else -7, 7),
                    textcoords="offset points",
                    ha="left" if right else "right",
                    fontsize=8,
                    bbox=BOX,
                    zorder=10,
                )
            )
        else:
            drawn.append(axes.text(*x, f"  {mark.words}", fontsize=8, bbox=BOX, zorder=10))
    return drawn


def seeing(nodes: Floats, triangles: NDArray[np.integer], node: int) -> tuple[float, float]:
    """Elevation and azimuth of a view in which nothing hides a node; the usual one where it does, or all are hidden.

    Parameters
    ----------
    nodes : (node, 3)
    triangles : (triangle, 3)
    """
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    corners = nodes[triangles] - nodes[node]
    for view in VIEWS:
        if not _hidden(corners, towards(*view), NEAR * size):
            return view
    return USUAL


def towards(elevation: float, azimuth: float) -> Floats:
    """The direction to the eye."""
    up, around = np.radians([elevation, azimuth])
    return np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])


def _hidden(corners: Floats, eye: Floats, near: float) -> bool:
    """Whether a ray from the origin meets one of the triangles (n, 3, 3), farther away than `near`.

    By Moeller and Trumbore (1997).
    """
    a = corners[:, 0]
    first, second = corners[:, 1] - a, corners[:, 2] - a
    p = np.cross(np.broadcast_to(eye, second.shape), second)
    det = np.einsum("nx,nx->n", first, p)
    flat = np.abs(det) < 1e-12 * np.abs(first).max() * np.abs(second).max()
    inverse = 1.0 / np.where(flat, 1.0, det)
    u = -np.einsum("nx,nx->n", a, p) * inverse
    q = np.cross(-a, first)
    v = (q @ eye) * inverse
    distance = np.einsum("nx,nx->n", second, q) * inverse
    return bool(np.any(~flat & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (distance > near)))
