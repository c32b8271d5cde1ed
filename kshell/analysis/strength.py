"""What is derived from the stresses of a result: those of layers at probes, and how far materials are used.

`utilisation` is the largest von Mises stress over the yield stress there: at the bottom, in the middle and at the top,
and of laminates at the faces of all layers (`kshell.analysis.layers`); in a row of values that several materials share
the smallest yield stress counts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.layers import LayersAtRows, Warmth, add_largest, layers_at_rows, left_in_layers
from kshell.material.part import Layered
from kshell.material.plies import ply_stresses
from kshell.result.peaks import NO_CORNERS
from kshell.result.result import Result
from kshell.scene.structure import Structure

Floats = NDArray[np.float64]

SAME = 1e-9  # stresses that differ by rounding
FACES = ("bottom", "middle", "top")


def add_strength(
    result: Result, structure: Structure, warmth: Warmth = (), corners: Mapping[int, str] = NO_CORNERS
) -> None:
    """Add `layers` to the probes on laminates, and the field, extreme and probe values `utilisation`.

    Parameters
    ----------
    warmth : sequence of Placed
        The temperatures that act.
    corners : mapping of vertices to words
        Where stresses grow without bound besides, as `mark_peaks` takes them.
    """
    inside: list[LayersAtRows] = []
    if any(isinstance(part, Layered) for part in structure.section.parts) and structure.direction is None:
        _add_layers(result, structure, warmth)
        if "moment" in result.fields:
            inside = layers_at_rows(result, structure, warmth)
            add_largest(result, structure, inside, corners)
    if not structure.section.has_yield_stress:
        return
    limits = {
        face: structure.section.yield_stress(side) for face, side in zip(FACES, (-1, 0, 1), strict=True)
    }
    _add_utilisation(result, limits, inside)


def _places(result: Result) -> Iterator[tuple[dict[str, Any], int]]:
    """Values at every probe, and of every sheet at probes where several meet, with their triangles."""
    for (name, group), triangle in result.probe_triangles.items():
        yield result.sheets[name][group] if group else result.probes[name], triangle


def _add_layers(result: Result, structure: Structure, warmth: Warmth) -> None:
    for probe, triangle in _places(result):
        part = structure.section.part_of(triangle)
        if isinstance(part, Layered) and "M" in probe:
            force = probe.get("membrane_stress_resultant", probe["N"])
            offset = float(structure.offset[triangle])
            where = np.array([triangle]), np.asarray(probe["x"])[None]
            left = left_in_layers(part, structure, warmth, *where)[0]
            probe["layers"] = ply_stresses(part.stack, force, probe["M"], probe.get("Q"), offset, left)


def _add_utilisation(result: Result, limits: dict[str, Floats], inside: list[LayersAtRows]) -> None:
    faces = [face for face in FACES if f"von_mises_{face}" in result.fields]
    if not faces:
        return
    rows, used = result.rows, []
    for face in faces:
        limit = np.full(len(rows.vertex), np.inf)
        np.minimum.at(limit, rows.corner.ravel(), np.repeat(limits[face], 3))
        used.append(np.ravel(result.fields[f"von_mises_{face}"]) / limit)
    names = list(faces)
    for layers in inside:
        for k, layer in enumerate(layers.part.stack.layers):
            own = getattr(layer.material, "yield_stress", None)
            if own is None:
                continue
            share = np.zeros(len(rows.vertex))
            # the name of an outer face goes before that of its layer
            share[layers.rows] = (1.0 - SAME) * layers.von_mises[:, k].max(axis=1) / own
            used.append(share)
            names.append(layers.words(k))
    result.fields["utilisation"] = utilisation = np.max(used, axis=0)
    which, place = np.unravel_index(int(np.argmax(used)), np.shape(used))
    result.extremes["utilisation"] = {
        "value": float(utilisation[place]),
        "face": names[which],
        "at": rows.points[place].tolist(),
        "group": str(rows.group[place]) or None,
    }
    for probe, triangle in _places(result):
        shares = [
            float(probe[f"von_mises_{face}"]) / float(limits[face][triangle])
            for face in faces
            if f"von_mises_{face}" in probe
        ]
        shares += [layer["utilisation"] for layer in probe.get("layers", ()) if "utilisation" in layer]
        if shares:
            probe["utilisation"] = max(shares)
