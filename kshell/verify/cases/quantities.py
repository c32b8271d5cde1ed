"""What is read off a result and compared: each quantity measures one number.

Moments are positive when they put the face z = +t/2 in tension, as everywhere in kshell; a plate that
sags along a positive pressure has positive moments in its middle and negative ones at clamped edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

import numpy as np

from kshell.result.result import Result

EVERY_ELEMENT = ("argyris", "morley", "koiter")
ARGYRIS_ONLY = ("argyris",)
Point = tuple[float, float]
Place = tuple[float, float, float]
Component = Literal["w", "Mx", "My", "Mxy", "M1", "M2", "laplacian"]


class Quantity(Protocol):
    """One number of a result; not every element gives every one."""

    @property
    def elements(self) -> tuple[str, ...]:
        """The elements that give it."""

    def of(self, result: Result) -> float:
        """Its value."""


@dataclass(frozen=True)
class At:
    """A value at a point: deflection w, a moment, a principal moment (M1 >= M2), or w_xx + w_yy.

    The Laplacian is that of an isotropic plate with bending stiffness 1.
    """

    point: Point
    component: Component
    nu: float = 0.3
    elements: tuple[str, ...] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        values = result.at((*self.point, 0.0))
        if self.component == "w":
            return float(values["u"][0, 2])
        xx, yy, xy = values["M"][0]
        mean, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
        table = {"Mx": xx, "My": yy, "Mxy": xy, "M1": mean + radius, "M2": mean - radius}
        return float(table[self.component] if self.component in table else -2 * mean / (1 + self.nu))


@dataclass(frozen=True)
class Moves:
    """Displacement of a point of a shell along a direction, or its rotation about one."""

    point: Place
    direction: Place
    kind: Literal["u", "rotation"] = "u"
    elements: ClassVar[tuple[str, ...]] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        return float(result.at(self.point)[self.kind][0] @ np.array(self.direction))


@dataclass(frozen=True)
class Tensor:
    """A membrane force N, its conjugate to the membrane strain, or a moment M per length at a point of a shell.

    Components xx, yy, xy: x is the projection of the global x on the surface, or of y where x is normal to it.
    """

    point: Place
    kind: Literal["N", "membrane_stress_resultant", "M"]
    component: Literal["xx", "yy", "xy"]
    elements: ClassVar[tuple[str, ...]] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        return float(result.at(self.point)[self.kind][0][("xx", "yy", "xy").index(self.component)])


@dataclass(frozen=True)
class EdgeForce:
    """Kirchhoff's shear force V = Q_n + dM_nt/ds across the line with a normal along x or y."""

    point: Point
    normal: Literal["x", "y"]
    size: float = 1.0
    elements: ClassVar[tuple[str, ...]] = ARGYRIS_ONLY  # needs third derivatives

    def of(self, result: Result) -> float:
        axis = "xy".index(self.normal)
        step = 1e-4 * self.size * np.eye(3)[1 - axis]
        place = np.array([*self.point, 0.0])
        before, middle, after = (result.at(place + k * step) for k in (-1, 0, 1))
        twist = (after["M"][0, 2] - before["M"][0, 2]) / (2e-4 * self.size)
        return float(middle["Q"][0, axis] + twist)


@dataclass(frozen=True)
class CornerForce:
    """The concentrated force of the supports on a corner of the plate."""

    point: Point
    elements: ClassVar[tuple[str, ...]] = ARGYRIS_ONLY

    def of(self, result: Result) -> float:
        corners = [c for group in result.reactions.values() for c in group.get("corners", [])]
        distance = [np.linalg.norm(np.asarray(c["at"])[:2] - self.point) for c in corners]
        if not corners or min(distance) > 1e-6:
            raise LookupError(f"no corner force at {self.point}")
        return float(np.asarray(corners[int(np.argmin(distance))]["force"])[2])


@dataclass(frozen=True)
class Compliance:
    """Work of the loads on the deflection, twice the strain energy; per force, the mean motion of where it acts."""

    force: float = 1.0
    elements: ClassVar[tuple[str, ...]] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        return 2.0 * result.strain_energy / self.force


@dataclass(frozen=True)
class Reaction:
    """Sum of the forces along z of the supports on the plate, or of one of them."""

    support: str | None = None
    elements: ClassVar[tuple[str, ...]] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        chosen = [self.support] if self.support else list(result.reactions)
        return float(sum(result.reactions[name]["force"][2] for name in chosen))


@dataclass(frozen=True)
class AtSlit:
    """The largest displacement along a direction of the vertices at a place, where a slit has two of them."""

    point: Place
    direction: Place
    elements: ClassVar[tuple[str, ...]] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        here = np.linalg.norm(result.mesh.points - self.point, axis=1) < 1e-6 * result.mesh.size
        return float((result.fields["displacement"][here] @ np.array(self.direction)).max())


@dataclass(frozen=True)
class LimitLoad:
    """The load factor of a limit point of a path, by its number."""

    number: int
    elements: ClassVar[tuple[str, ...]] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        limits = [point["factor"] for point in result.critical if point["kind"] == "limit"]
        return float(limits[self.number]) if self.number < len(limits) else float("nan")
