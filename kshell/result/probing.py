"""Values at the probes of a scene, and words about probes that lie off the surface."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.tensors import principal, von_mises
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.scene.places import Point

Floats = NDArray[np.float64]


def probe_values(
    probes: Mapping[str, Point], evaluate: Callable[[Floats], dict[str, Floats]], mesh: Mesh, what: str
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Values at named points, and warnings about points farther than a mesh size.

    Parameters
    ----------
    evaluate : function
        Points (n, 3) to x, u, rotation, M, stress_top, stress_bottom and more, and `distance` (n,) to the point
        used.
    mesh : Mesh
        In space, for the mesh size.
    what : "plate" or "shell"
        For messages.
    """
    if not probes:
        return {}, []
    points = np.array(list(probes.values()), dtype=float)
    values = evaluate(points)
    typical = float(np.sqrt(2 * np.median(mesh.areas)))
    warnings = [
        f"probe {name}: {place(point)} lies {distance:.3g} off the {what}, more than a mesh size ({typical:.3g}); "
        f"the values are those at the nearest point, {place(x)}"
        for name, point, distance, x in zip(probes, points, values["distance"], values["x"], strict=True)
        if distance > typical
    ]
    out = {}
    for k, name in enumerate(probes):
        probe: dict[str, Any] = {key: value[k] for key, value in values.items() if key != "distance"}
        probe.setdefault("N", np.zeros(3))
        for face in ("top", "middle", "bottom"):
            if f"stress_{face}" in probe:
                probe[f"von_mises_{face}"] = float(von_mises(probe[f"stress_{face}"]))
        probe["principal_moments"] = principal(probe["M"])
        if "N" in values:
            probe["principal_forces"] = principal(probe["N"])
        out[name] = probe
    return out, warnings
