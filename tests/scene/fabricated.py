"""A result made by hand: the fields of a known deflection, without any solver."""

from __future__ import annotations

from typing import Any

import numpy as np

import kshell as ks
from kshell.result.result import Result


def square_mesh(n: int = 8, order: int = 1, side: float = 1.0) -> ks.Mesh:
    """A square of 2 n^2 right triangles with its four sides, corner, middle and halves as groups."""
    s = np.linspace(0.0, side, n + 1)
    x, y = (a.ravel() for a in np.meshgrid(s, s, indexing="ij"))
    index = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )

    def line(nodes: Any) -> Any:
        return np.stack([nodes[:-1], nodes[1:]], axis=1)

    centre = x[triangles].mean(axis=1)
    groups = {
        "left": line(index[0]),
        "right": line(index[-1]),
        "bottom": line(index[:, 0]),
        "top": line(index[:, -1]),
        "corner": np.array([index[0, 0]]),
        "west": triangles[centre < side / 2],
        "east": triangles[centre > side / 2],
        "plate": triangles,
    }
    mesh = ks.Mesh.from_arrays(np.stack([x, y], axis=1), triangles, groups)
    if order == 1:
        return mesh
    midpoints = mesh.points[mesh.edges].mean(axis=1)
    return ks.Mesh.from_arrays(mesh.points, triangles, groups, midpoints=midpoints)


def scene_on(mesh: ks.Mesh, **changes: Any) -> ks.Scene:
    """A plate held in many ways under many loads."""
    data: dict[str, Any] = {
        "mesh": mesh,
        "thickness": 0.01,
        "material": ks.Isotropic(E=210e9, nu=0.3, density=7850),
        "supports": [ks.Clamped("left"), ks.SimplySupported("bottom"), ks.Symmetry("top")],
        "loads": [
            ks.Pressure(-1e3),
            ks.LineForce("right", (10.0, 0, 50.0)),
            ks.PointForce((0.5, 0.5, 0), (0, 0, 1)),
        ],
        "probes": {"centre": (0.5, 0.5, 0.0)},
        "title": "Steel plate",
    }
    return ks.Scene(**{**data, **changes})


def fabricated_result(mesh: ks.Mesh | None = None, **changes: Any) -> Result:
    """The fields of w = sin(pi x) sin(pi y) on the unit square, with D = 1 and nu = 0.3, t = 0.1."""
    mesh = square_mesh() if mesh is None else mesh
    values = fields_at(mesh.points)
    at_centre = {name: row[0] for name, row in fields_at(np.array([[0.5, 0.5, 0.0]])).items()}
    data: dict[str, Any] = {
        "mesh": mesh,
        "fields": values,
        "unknowns": 3 * len(mesh.points),
        "model": {
            "kind": "plate",
            "large_deflection": False,
            "element": "morley",
            "order": 2,
            "reasons": ["planar mesh, so bending alone describes it"],
        },
        "title": "Steel plate",
        "probes": {
            "centre": {
                "x": np.array([0.5, 0.5, 0.0]),
                "u": at_centre["displacement"],
                "rotation": at_centre["rotation"],
                "M": at_centre["moment"],
                "N": np.zeros(3),
                "stress_top": at_centre["stress_top"],
                "stress_bottom": at_centre["stress_bottom"],
            }
        },
        "reactions": {"left": {"force": np.array([0.0, 0.0, -5.0]), "moment": np.zeros(3)}},
        "balance": 1e-12,
        "strain_energy": 0.5,
        "external_work": 0.5,
        "cell_fields": {"thickness": np.full(len(mesh.triangles), 0.1)},
        "evaluate": values_at,
        "solver": {
            "name": "direct",
            "iterations": 2,
            "seconds": {"read": 0.0, "assemble": 0.01, "solve": 0.02, "recover": 0.01},
            "peak_memory_mb": 100.0,
        },
        "scene": scene_on(mesh),
    }
    return Result(**{**data, **changes})


def fields_at(points: np.ndarray) -> dict[str, np.ndarray]:
    """Fields of the known deflection at points (n, 3)."""
    x, y = np.pi * points[:, 0], np.pi * points[:, 1]
    w = np.sin(x) * np.sin(y)
    zero = np.zeros_like(w)
    w_x, w_y = np.pi * np.cos(x) * np.sin(y), np.pi * np.sin(x) * np.cos(y)
    moment = np.pi**2 * np.stack([1.3 * w, 1.3 * w, -0.7 * np.cos(x) * np.cos(y)], axis=1)
    stress = 6.0 * moment / 0.1**2
    von_mises = np.sqrt(
        stress[:, 0] ** 2 + stress[:, 1] ** 2 - stress[:, 0] * stress[:, 1] + 3 * stress[:, 2] ** 2
    )
    return {
        "displacement": np.stack([zero, zero, w], axis=1),
        "rotation": np.stack([w_y, -w_x, zero], axis=1),
        "moment": moment,
        "shear": 2.0 * np.pi**3 * np.stack([np.cos(x) * np.sin(y), np.sin(x) * np.cos(y)], axis=1),
        "stress_top": stress,
        "stress_bottom": -stress,
        "von_mises_top": von_mises,
        "von_mises_bottom": von_mises,
    }


def values_at(points: np.ndarray) -> dict[str, np.ndarray]:
    """The same with the names of `Result.at`."""
    fields = fields_at(points)
    names = {"u": "displacement", "M": "moment", "Q": "shear"}
    return {**fields, **{key: fields[name] for key, name in names.items()}, "x": points}
