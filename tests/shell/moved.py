"""A scene of a shell in other units and another place: lengths times a factor, turned, stresses the same."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import kshell as ks
from kshell.geometry import Chart
from kshell.geometry.smooth import SmoothMap
from kshell.values.varying import values_at

TURNS = {
    "as it is": np.eye(3),
    "a milliradian": Rotation.from_rotvec([0.0, 0.0, 1e-3]).as_matrix(),
    "quarter": Rotation.from_rotvec([0.0, 0.5 * np.pi, 0.0]).as_matrix(),
    "any": Rotation.from_rotvec([0.7, -0.4, 1.1]).as_matrix(),
}
# powers of length in forces per area, per length and at points
POWERS = {"pressure": 0, "traction": 0, "gravity": -1, "line_force": 1, "point_force": 2, "edge_moment": 2}


def moved(scene: ks.Scene, scale: float = 1.0, turn: Any = None) -> ks.Scene:
    """The scene with all places turned by a matrix, and all lengths times `scale`."""
    q = np.eye(3) if turn is None else turn
    changes: dict[str, Any] = {
        "thickness": _scaled(scene.thickness, scale, q),
        "offset": scale * scene.offset,
        "probes": {name: _probe(point, scale, q) for name, point in scene.probes.items()},
        "supports": [_support(support, scale, q) for support in scene.supports],
        "loads": [_load(load, scale, q) for load in scene.loads],
    }
    mesh = scene.read_mesh()
    if scene.chart is None:
        midpoints = None if mesh.midpoints is None else scale * mesh.midpoints @ q.T
        changes["mesh"] = dataclasses.replace(mesh, points=scale * mesh.points @ q.T, midpoints=midpoints)
    else:
        changes["chart"] = Chart(_Moved(scene.chart, scale, q), domain=scene.chart.domain)
    if scene.direction is not None:
        changes["direction"] = tuple(q @ scene.direction)
    return dataclasses.replace(scene, **changes)


def _probe(point, scale, q):
    """The place, on the same surface group."""
    place = _place(point, scale, q)
    return {"at": place, "on": point.on} if hasattr(point, "on") else place


def _place(point: Any, scale: float, q: Any) -> Any:
    return tuple((scale * q @ np.asarray(point, float)).tolist())


class _Moved(SmoothMap):
    """The points of another map, moved."""

    parameters, components = 2, 3

    def __init__(self, chart: Any, scale: float, q: Any) -> None:
        self.map, self.matrix, self.highest = chart.map, scale * q, chart.map.highest

    def partials(self, where: Any, order: int) -> Any:
        found = self.map.partials(where, order)
        return {
            index: [sum(m * part for m, part in zip(row, parts, strict=True)) for row in self.matrix.tolist()]
            for index, parts in found.items()
        }


def _scaled(value: Any, factor: float, q: Any) -> Any:
    if isinstance(value, dict):
        return {name: _scaled(part, factor, q) for name, part in value.items()}
    return factor * value


def _vector(value: Any, factor: float, scale: float, q: Any) -> Any:
    def at(x: Any, y: Any, z: Any) -> Any:
        places = np.stack(np.broadcast_arrays(x, y, z), axis=-1) @ q / scale
        return tuple(factor * q @ np.moveaxis(values_at(value, places, 3), -1, 0))

    return at


def _load(load: Any, scale: float, q: Any) -> Any:
    factor = scale ** POWERS[load.kind]
    on = load.on if load.on is None or isinstance(load.on, str) else _on(load.on, scale, q)
    value = load.value
    value = factor * value if isinstance(value, float) else _vector(value, factor, scale, q)
    return dataclasses.replace(load, on=on, value=value)


def _on(on: Any, scale: float, q: Any) -> Any:
    return _place(on, scale, q) if isinstance(on[0], float) else on


def _support(support: Any, scale: float, q: Any) -> Any:
    if support.kind == "fixed":
        return dataclasses.replace(support, axes=tuple(map(tuple, q.T.tolist())))
    return support
