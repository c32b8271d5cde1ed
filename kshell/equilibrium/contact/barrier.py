"""Contact without a state that intersects: a barrier between surfaces, and steps that stop before they meet.

The barrier (Li et al., ACM Trans. Graph. 39(4), 2020, article 49; Li, Kaufman and Jiang, 40(4), 2021, article 170) is
felt within a distance d^ beyond the thickness and grows without bound at the thickness. Its stiffness is a pressure:
at d^ / 2 it carries 1.19 of it. Friction is that of Coulomb, smoothed below a speed of sliding, with the normal forces
of the start of each step. All of it is computed by ipctk, on a triangulation of the shell through its nodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.contact.surfaces import Surfaces
from kshell.errors import SolveError

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# part of the step to the first touch that is made
BACK = 0.9
# obstacles that move leave this part of the smallest gap, and wait where it is below a part of the distance, until the
# shell has followed: a step moves it by less than another part of the distance
LEFT, LOW, CALM = 0.5, 0.1, 0.1
# gap against the distance from which on nothing gives way any more
SHUT = 1e-9


@dataclass(frozen=True)
class Touch:
    """How surfaces touch.

    Attributes
    ----------
    thickness, distance : float
        Distance that is kept, and that beyond it within which the barrier is felt.
    stiffness : float
        Of the barrier, a pressure.
    friction, speed : float
    of_itself : bool
    """

    thickness: float
    distance: float
    stiffness: float
    friction: float
    speed: float
    of_itself: bool


class Barrier:
    """Forces of contact in one motion."""

    def __init__(self, surfaces: Surfaces, touch: Touch, unknowns: int) -> None:
        self.surfaces, self.touch, self.unknowns = surfaces, touch, unknowns
        ipc = surfaces.ipc
        self._barrier = ipc.BarrierPotential(touch.distance, touch.stiffness, use_physical_barrier=True)
        self._friction: Any = ipc.FrictionPotential(touch.speed) if touch.friction > 0.0 else None
        self._clamped, self._true = ipc.PSDProjectionMethod.CLAMP, ipc.PSDProjectionMethod.NONE
        self._ccd = ipc.AdditiveCCD()
        self._sliding: Any = None
        self._calm = True
        self._start, self._slip = surfaces.rest, touch.speed
        self._begin, self._end, self._made = (
            0.0,
            0.0,
            1.0,
        )  # the last: of the way of obstacles within the step
        self._near: tuple[Floats, Any] | None = None  # places and their pairs, as last asked for

    def begin(
        self, x: Floats, begin: float, end: float, arrived: bool = False, slip: float | None = None
    ) -> None:
        """A step from x between two times.

        Parameters
        ----------
        arrived : bool
            Whether obstacles that move are where they end, not where they start.
        slip : float, optional
            Way up to which friction sticks, instead of that of its speed in the time of the step.
        """
        surfaces = self.surfaces
        self._begin, self._end = begin, end
        self._slip = self.touch.speed * (end - begin) if slip is None else slip
        there = surfaces.at(x, end)
        self._start = there if arrived else surfaces.at(x, begin)
        self._made = 1.0 if np.array_equal(self._start, there) else 0.0
        self._sliding, self._calm = None, True
        self._press(self._start)

    def press_again(self, x: Floats) -> None:
        """Friction by the normal forces at x, sliding still counted from the begin of the step."""
        self._press(self._at(x))

    def _press(self, places: Floats) -> None:
        if self._friction is not None:
            near, surfaces = self._pairs(places), self.surfaces
            self._sliding = surfaces.ipc.TangentialCollisions()
            self._sliding.build(surfaces.mesh, places, near, self._barrier, self.touch.friction)

    def advance(self, x: Floats) -> bool:
        """Move obstacles toward their places at the end of the step as far as x lets them; whether they are there.

        Raises
        ------
        SolveError
            If they press against what does not give way.
        """
        if self._made == 1.0:
            return True
        touch, before = self.touch, self._at(x)
        gap = self._gap_of(before)
        if gap < LOW * touch.distance and not self._calm:
            return False
        if gap < SHUT * touch.distance:
            raise SolveError("an obstacle that moves meets a part that supports hold, and cannot go on")
        part = self._free(before, self.surfaces.at(x, self._end))
        made = 1.0 if part >= 1.0 else BACK * part
        while self._gap_of(self._between(x, self._made + made * (1.0 - self._made))) < LEFT * gap:
            made *= 0.5
        self._made += made * (1.0 - self._made)
        return self._made == 1.0

    def _at(self, x: Floats) -> Floats:
        """(point, 3) places, obstacles as far as they have come."""
        return self._between(x, self._made)

    def _between(self, x: Floats, made: float) -> Floats:
        """(point, 3) places, obstacles after a part of their way."""
        places = self.surfaces.at(x, self._end)
        if made < 1.0:
            rest = (1.0 - made) * (self.surfaces.at(x, self._begin) - places)
            places = np.asfortranarray(places + rest)
        return places

    def _gap_of(self, places: Floats) -> float:
        touch = self.touch
        return self.surfaces.gap(places, touch.distance + touch.thickness) - touch.thickness

    def gradient(self, x: Floats) -> Floats:
        """(unknowns,) derivative of the potential: minus the forces on the shell."""
        return self._on_shell(self._forces(self._at(x)))

    def _forces(self, places: Floats) -> Floats:
        """(3 points,) derivative of the potential by all points."""
        surfaces = self.surfaces
        near = self._pairs(places)
        out = self._barrier.gradient(near, surfaces.mesh, places)
        if self._sliding is not None:
            out = out + self._friction.gradient(self._sliding, surfaces.mesh, self._velocity(places))
        return np.asarray(out)

    def _pairs(self, places: Floats) -> Any:
        if self._near is None or not np.array_equal(self._near[0], places):
            touch = self.touch
            self._near = (places, self.surfaces.collisions(places, touch.distance, touch.thickness))
        return self._near[1]

    def _velocity(self, places: Floats) -> Floats:
        return np.asfortranarray((places - self._start) / self._duration)

    @property
    def _duration(self) -> float:
        """Time in which the way of sticking is gone at its speed."""
        return self._slip / self.touch.speed

    def _on_shell(self, forces: Floats) -> Floats:
        out = np.zeros(self.unknowns)
        out[: 3 * self.surfaces.count] = forces[: 3 * self.surfaces.count]
        return out

    def hessian(self, x: Floats, projected: bool) -> sp.csr_matrix | None:
        """(unknowns, unknowns) second derivative, without negative parts if projected; None where nothing touches."""
        surfaces = self.surfaces
        places = self._at(x)
        kind = self._clamped if projected else self._true
        near = self._pairs(places)
        found = self._barrier.hessian(near, surfaces.mesh, places, kind)
        if self._sliding is not None:
            sliding = self._friction.hessian(self._sliding, surfaces.mesh, self._velocity(places), kind)
            found = found + sliding / self._duration
        n = 3 * surfaces.count
        found = found.tocsr()[:n, :n]
        if not found.nnz:
            return None
        found.resize(self.unknowns, self.unknowns)
        return found

    def largest_step(self, x: Floats, change: Floats) -> float:
        """The part of a change of x that may be made before anything touches."""
        self._calm = self.moved(change) < CALM
        part = self._free(self._at(x), self._at(x + change))
        return 1.0 if part >= 1.0 else BACK * part

    def moved(self, change: Floats) -> float:
        """Largest displacement in a change of x, against that within which forces of contact change."""
        felt = self.touch.distance if self._sliding is None else min(self.touch.distance, self._slip)
        return float(np.abs(change[: 3 * self.surfaces.count]).max(initial=0.0)) / felt

    def _free(self, before: Floats, after: Floats) -> float:
        return float(
            self.surfaces.ipc.compute_collision_free_stepsize(
                self.surfaces.mesh, before, after, self.touch.thickness, narrow_phase_ccd=self._ccd
            )
        )

    def on_obstacles(self, x: Floats) -> dict[str, Floats]:
        """(3,) force of the shell on each obstacle at the end of the step."""
        forces = self._forces(self._at(x)).reshape(-1, 3)
        return {name: -forces[part].sum(axis=0) for name, part in self.surfaces.ranges.items()}

    def work(self, before: dict[str, Floats], after: dict[str, Floats], begin: float, end: float) -> float:
        """Work that obstacles that move do between two times, from the forces of the shell on them at both."""
        ways = self.surfaces.travel(begin, end)
        pairs = zip(before.values(), after.values(), ways, strict=True)
        return -sum(0.5 * float((first + second) @ way) for first, second, way in pairs)

    def gap(self, x: Floats) -> float:
        """Smallest distance less the thickness, up to that at which surfaces feel each other."""
        return self._gap_of(self._at(x))

    def require_free(self, x: Floats) -> None:
        """Raise SolveError if something intersects, which no step may leave behind."""
        if self.surfaces.ipc.has_intersections(self.surfaces.mesh, self._at(x)):
            raise SolveError("surfaces intersect after the step")
