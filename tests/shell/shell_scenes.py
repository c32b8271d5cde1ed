"""Scenes that the tests of shells share."""

from pathlib import Path

import numpy as np

import kshell as ks
from tests.scene.fabricated import square_mesh
from tests.shell.shapes import joined, panel

MESHES = Path(__file__).parents[2] / "meshes"


STEEL = ks.Isotropic(E=210e9, nu=0.3, density=7850)


def plate(**changes):
    data = {
        "mesh": square_mesh(8),
        "thickness": 0.01,
        "material": STEEL,
        "supports": [ks.Clamped("left"), ks.SimplySupported(["right", "bottom"])],
        "loads": [ks.Pressure("1e3*(1 + x)")],
        "probes": {"p": (0.5, 0.5, 0.0), "q": (0.8, 0.3, 0.0)},
    }
    return ks.Scene(**{**data, **changes})


def cantilever_of_two(**changes):
    """Two strips end to end along x, width 1, joined at x = 1."""
    mesh = joined(panel((0, 0, 0), (1, 0, 0), (0, 1, 0)), panel((1, 0, 0), (1, 0, 0), (0, 1, 0)))
    x = mesh.points[mesh.edges][:, :, 0]
    groups = {
        n: mesh.edges[(np.abs(x - v) < 1e-9).all(axis=1)] for n, v in (("a", 0.0), ("b", 1.0), ("c", 2.0))
    }
    data = {
        "mesh": ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups),
        "thickness": 0.01,
        "material": ks.Isotropic(E=210e9, nu=0.0),
        "supports": [ks.Clamped("a"), ks.SimplySupported("c"), ks.Hinge("b")],
        "loads": [ks.LineForce("b", (0, 0, -10.0))],
        "probes": {"joint": (1, 0.5, 0)},
    }
    return ks.Scene(**{**data, **changes})


def two_panels(**changes):
    """Two squares apart from each other, each with a group for its left side."""
    a, b = panel((0, 0, 0), (1, 0, 0), (0, 1, 0)), panel((3, 0, 0), (1, 0, 0), (0, 0, 1))
    points, triangles = np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1] + len(a[0])])
    plain = ks.Mesh(points, triangles.astype(np.int32))
    x = points[plain.edges][:, :, 0]
    groups = {n: plain.edges[(np.abs(x - v) < 1e-9).all(axis=1)] for n, v in (("one", 0.0), ("two", 3.0))}
    data = {"mesh": ks.Mesh.from_arrays(points, triangles, groups), "thickness": 0.01, "material": STEEL}
    return ks.Scene(**{**data, "loads": [ks.Pressure(1.0)], **changes})
