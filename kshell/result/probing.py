"""Values at the probes of a scene, and words about probes that lie off the surface or where sheets meet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kshell.material.tensors import principal, principal_angle, von_mises
from kshell.mesh.mesh import Mesh
from kshell.mesh.vectors import cross
from kshell.mesh.words import place
from kshell.result.deferred import Deferred
from kshell.scene.places import Point, ProbePoint

Floats = NDArray[np.float64]


class Evaluates(Protocol):
    """Values of a solution at places: arrays with one row per point, by name, `distance` and `triangle` among them."""

    @property
    def has_sheets(self) -> bool:
        """Whether sheets with values of their own meet anywhere."""

    def at(self, points: Floats) -> dict[str, Floats]:
        """At the nearest points; where sheets meet of that with the largest stress."""

    def motion(self, points: Floats) -> Floats:
        """(n, 3) the displacement u of `at` alone."""

    def on(self, points: Floats, group: str) -> dict[str, Floats]:
        """At the nearest points of a surface group."""

    def sheets(self, point: Floats) -> dict[str, dict[str, Any]]:
        """At one point on every sheet that meets there, by surface group; empty where there is one."""


@dataclass(frozen=True)
class Probed:
    """Values at the probes of a scene.

    Attributes
    ----------
    values : mapping of name to dict
        Each computed when it is first looked at, unless it is to be warned of.
    sheets : dict of name to dict of surface group to dict
        Of probes where sheets meet, unless they say on which they are.
    warnings : list of str
    triangles : mapping of (name, surface group) to int
        Whose the values are; of those in `values` the group is empty.
    motions : mapping of name to (3,) array
        The displacements in `values`, which cost less than all of them.
    """

    values: Deferred[dict[str, Any]] = field(default_factory=Deferred)
    sheets: dict[str, dict[str, dict[str, Any]]] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    triangles: Deferred[int] = field(default_factory=Deferred)
    motions: Deferred[Floats] = field(default_factory=Deferred)


def probe_values(probes: Mapping[str, Point], fields: Evaluates, mesh: Mesh, what: str) -> Probed:
    """Values at named points, with warnings about points farther than a mesh size or where sheets meet.

    Parameters
    ----------
    mesh : Mesh
        In space, for the mesh size.
    what : "plate" or "shell"
        For messages.
    """
    out, together = Probed(), _Together(fields)
    typical = float(np.sqrt(2 * np.median(mesh.areas))) if probes else 0.0
    for name, given in probes.items():
        point = np.array(given, dtype=float)
        on = given.on if isinstance(given, ProbePoint) else None
        if on is None and not fields.has_sheets and _near(mesh.points - point, typical):
            later = together.at(point)
            out.values.make(name, later.completed)
            out.triangles.make((name, ""), later.triangle)
            out.motions.make(name, later.motion)
            continue
        found = fields.at(point[None]) if on is None else fields.on(point[None], on)
        values = {key: value[0] for key, value in found.items()}
        out.triangles[name, ""] = int(values["triangle"])
        distance = float(values["distance"])
        if distance > typical:
            out.warnings.append(
                f"probe {name}: {place(point)} lies {distance:.3g} off the {what if on is None else on}, more than a "
                f"mesh size ({typical:.3g}); the values are those at the nearest point, {place(values['x'])}"
            )
        out.values[name] = _completed(values)
        sheets = fields.sheets(point) if on is None else {}
        if sheets:
            out.triangles.update({(name, group): int(each["triangle"]) for group, each in sheets.items()})
            out.sheets[name] = {group: _completed(each) for group, each in sheets.items()}
            names = [f'"{group}"' for group in sheets]
            shown = max(sheets, key=lambda group: _alike(out.values[name], sheets[group]))
            out.warnings.append(
                f"probe {name}: {', '.join(names[:-1])} and {names[-1]} meet at {place(point)}, where forces, moments "
                f'or stresses differ; the values are those on "{shown}", where the stress is largest, all stand under '
                "`sheets`; on = the name of a surface group chooses one"
            )
    return out


def _near(offsets: Floats, reach: float) -> bool:
    """Whether any of some (n, 3) is no longer than that."""
    return bool((np.einsum("ni,ni->n", offsets, offsets) <= reach**2).any())


class _Together:
    """Values at some points, of all when the first is looked at: they share what is found around them."""

    def __init__(self, fields: Evaluates) -> None:
        self.fields = fields
        self._points: list[Floats] = []

    def at(self, point: Floats) -> _Later:
        """One more point."""
        self._points.append(point)
        return _Later(self, len(self._points) - 1, point)

    @cached_property
    def values(self) -> dict[str, Floats]:
        """Arrays with a row for each point."""
        return self.fields.at(np.array(self._points))


class _Later:
    """Values at one point, when they are looked at."""

    def __init__(self, together: _Together, number: int, point: Floats) -> None:
        self._together, self._number, self._point = together, number, point

    def completed(self) -> dict[str, Any]:
        return _completed({key: value[self._number] for key, value in self._together.values.items()})

    def motion(self) -> Floats:
        if "values" in self._together.__dict__:
            return np.asarray(self._together.values["u"][self._number], dtype=float)
        return self._together.fields.motion(self._point[None])[0]

    def triangle(self) -> int:
        return int(self._together.values["triangle"][self._number])


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    """Less the more the stresses differ."""
    faces = [f"stress_{face}" for face in ("top", "middle", "bottom") if f"stress_{face}" in one]
    return -sum(float(np.abs(one[face] - other[face]).max()) for face in faces)


def _completed(values: Mapping[str, Any]) -> dict[str, Any]:
    """With stresses of von Mises and principal values."""
    probe = {key: value for key, value in values.items() if key not in ("distance", "triangle")}
    probe.setdefault("N", np.zeros(3))
    for face in ("top", "middle", "bottom"):
        if f"stress_{face}" in probe:
            stress = probe[f"stress_{face}"]
            probe[f"von_mises_{face}"] = float(von_mises(stress))
            probe[f"principal_{face}"] = principal(stress)
            probe[f"principal_directions_{face}"] = _directions(probe, stress)
    probe["principal_moments"] = principal(probe["M"])
    if "N" in values:
        probe["principal_forces"] = principal(probe["N"])
    return probe


def _directions(probe: Mapping[str, Any], stress: Floats) -> Floats:
    """(2, 3) unit vectors of the principal stresses, the larger first."""
    first = probe.get("axis_1", np.array([1.0, 0.0, 0.0]))
    second = cross(probe.get("normal", np.array([0.0, 0.0, 1.0])), first)
    angle = principal_angle(stress)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * first + s * second, c * second - s * first])
