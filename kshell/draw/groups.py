"""Names of groups where they lie, for pictures of meshes; and the picture of `kshell check`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.plot import save_figure
from kshell.draw.scene_plot import plot_scene
from kshell.draw.surface_scene_plot import plot_surface_scene
from kshell.mesh import Mesh
from kshell.mesh.check import is_flat

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

MANY = 40  # names that a picture can hold
BOX: dict[str, Any] = {"boxstyle": "round,pad=0.2", "facecolor": "#fff8dc", "alpha": 0.85, "linewidth": 0.4}


def places_of_groups(mesh: Mesh) -> dict[str, Floats]:
    """(3,) a place on each group: the middle of the member that is nearest to the mean of all."""
    out = {}
    for name, group in mesh.groups.items():
        if group.dimension == 0:
            middles = mesh.points[group.members]
        else:
            corners = mesh.edges if group.dimension == 1 else mesh.triangles
            middles = mesh.points[corners[group.members]].mean(axis=1)
        if len(middles):
            off = np.linalg.norm(middles - middles.mean(axis=0), axis=1)
            out[name] = np.asarray(middles[int(np.argmin(off))])
    return out


def plot_named(mesh: Mesh, scene: Scene | None, title: str = "") -> Figure:
    """The mesh with supports and loads, and the names of its groups where they lie.

    Parameters
    ----------
    mesh : Mesh
        In space.
    scene : Scene or None
        None draws the mesh alone.
    title : str
    """
    flat = is_flat(mesh.points)
    figure = (plot_scene if flat else plot_surface_scene)(mesh, scene, title)
    axes: Any = figure.axes[0]
    for name, x in list(places_of_groups(mesh).items())[:MANY]:
        axes.text(*(x[:2] if flat else x), name, fontsize=8, bbox=BOX, ha="center", va="center", zorder=11)
    return figure


def save_named(mesh: Mesh, scene: Scene | None, title: str, path: Path) -> None:
    """Write that picture as PNG."""
    save_figure(plot_named(mesh, scene, title), path)
