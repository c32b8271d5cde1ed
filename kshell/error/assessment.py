"""How good a result is: intervals of its energy and its probes, where its error sits, and the budget of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from kshell.error.estimate import Estimate
from kshell.result.result import Result

Floats = NDArray[np.float64]

ENERGY, PROBES = "energy", "probes"
RESTING = 1e-12  # of the largest displacement: what is no motion but rounding, as its half width is
MISSED = 3.0  # times a share of the loads that is missed: what it changes of displacements at most


@dataclass(frozen=True)
class Interval:
    """A displacement and how far it can be from the truth, component by component.

    Attributes
    ----------
    value, half_width, expected : (3,) arrays
        `expected` is the size that the error is likely to have, at most `half_width`.
    kind : "guaranteed" or "estimated"
    common : float
        What of each half width is the size of a vector whose direction is not known.
    """

    value: Floats
    half_width: Floats
    expected: Floats
    kind: Literal["guaranteed", "estimated"]
    common: float = 0.0

    @property
    def relative(self) -> float:
        """Size of the half width over that of the displacement; infinite where that is zero and the former is not."""
        own = np.linalg.norm(np.maximum(self.half_width - self.common, 0.0))
        return _ratio(float(own) + self.common, float(np.linalg.norm(self.value)))

    def widened(self, share: float, size: float = 0.0) -> Interval:
        """The interval with an error of another origin, relative to its value or to a size where that is larger."""
        moves = self.half_width > 0.0
        off = share * max(float(np.linalg.norm(self.value)), size) if moves.any() else 0.0
        more = off * moves
        return Interval(
            self.value, self.half_width + more, self.expected + more, self.kind, self.common + off
        )


@dataclass(frozen=True)
class Missed:
    """A load of which a share is missed.

    Attributes
    ----------
    share : float
    size, energy : float
        The largest displacement and the strain energy under it alone, or under all loads where these are larger.
    """

    share: float
    size: float
    energy: float


@dataclass
class Assessment:
    """What was found about the error of one solution.

    Attributes
    ----------
    energy : Estimate or None
        Of the strain energy.
    probes : dict of str to Interval
    marks : dict of str to (triangle,) array
        By quantity, "energy" or a probe: what each triangle adds to the square of its error, for refinement.
    parts : dict of str to (triangle,) array
        By quantity, what would be left of the half width at least if only these triangles stayed as they are.
    duals : dict of str to (dof,) array
        By probe, the dual solutions of plates, in physical degrees of freedom.
    geometry : float or None
        Relative error because the shape is approximated; None where it is not known.
    shapes : dict of str to float
        By probe, the same of its displacement, where its dual tells it.
    shape_marks : dict of str to (triangle,) array
        By probe, what each triangle adds to that.
    size : float
        Of the largest displacement, if another shape changes displacements everywhere by a share of that.
    loads : float
        What is missed of loads because they change faster than they are integrated, of the largest displacement.
    by_loads : dict of str to float
        By quantity, what that adds to its half width, over its size.
    why_not : str
        Why there is no proof, or no estimate.
    infinite : str
        Why the energy, or a displacement, is infinite or has no interval on any mesh like this, if so.
    told : bool
        Whether the solution tells its error at all; intervals are infinite otherwise, and marks say what to refine.
    """

    energy: Estimate | None = None
    probes: dict[str, Interval] = field(default_factory=dict)
    marks: dict[str, Floats] = field(default_factory=dict)
    parts: dict[str, Floats] = field(default_factory=dict)
    duals: dict[str, Floats] = field(default_factory=dict)
    geometry: float | None = None
    shapes: dict[str, float] = field(default_factory=dict)
    shape_marks: dict[str, Floats] = field(default_factory=dict)
    size: float = 0.0
    loads: float = 0.0
    by_loads: dict[str, float] = field(default_factory=dict)
    why_not: str = ""
    infinite: str = ""
    told: bool = True

    def quantities(self, wanted: str | None) -> list[str]:
        """The quantities that a word means: "energy", "probes", the name of a probe, or None for what there is."""
        if wanted == ENERGY:
            return [ENERGY] if self.energy is not None else []
        if wanted is None or (wanted == PROBES and wanted not in self.probes):
            found = list(self.probes)
            return found if found or wanted is not None or self.energy is None else [ENERGY]
        return [wanted] if wanted in self.probes else []

    def relative(self, quantity: str) -> float:
        """Half width of a quantity over its size."""
        if quantity != ENERGY:
            return self.probes[quantity].relative
        assert self.energy is not None
        return _ratio(self.energy.half_width, abs(self.energy.value))

    def _known(self, quantity: str) -> bool:
        """Whether its interval is finite."""
        if quantity != ENERGY:
            return bool(np.isfinite(self.probes[quantity].half_width).all())
        return self.energy is not None and bool(np.isfinite(self.energy.half_width))

    def floor(self, quantity: str, triangles: NDArray[np.bool_]) -> float:
        """What would be left of `relative` at least if some triangles stayed as they are."""
        left = float(self.parts[quantity][triangles].sum())
        if quantity != ENERGY:
            return _ratio(left, float(np.linalg.norm(self.probes[quantity].value)))
        assert self.energy is not None
        return _ratio(left, abs(self.energy.value))

    def kind(self, quantity: str) -> str:
        """ "guaranteed" or "estimated"."""
        if quantity != ENERGY:
            return self.probes[quantity].kind
        assert self.energy is not None
        return self.energy.kind

    def without_energy(self, why: str) -> None:
        """Take the interval of an energy away that is infinite, if words say why."""
        self.infinite = self.infinite or why
        if why and self.energy is not None:
            value, inf = self.energy.value, float("inf")
            self.energy = Estimate(value, inf, inf, "estimated", why)

    def without_any(self, why: str) -> None:
        """Take all intervals away, if nothing is known, as words say."""
        self.without_energy(why)
        for name in self.probes:
            self.without_probe(name, why)

    def without_probe(self, name: str, why: str) -> None:
        """Take the interval of a probe away that has no limit, as words say."""
        self.infinite = self.infinite or why
        probe = self.probes[name]
        width = np.where(probe.half_width > 0.0, np.inf, 0.0)
        self.probes[name] = Interval(probe.value, width, width, "estimated")

    def with_more_energy(self, more: float) -> None:
        """Widen the interval of the energy."""
        if self.energy is not None:
            e, more = self.energy, float(more)
            self.energy = Estimate(e.value, e.half_width + more, e.expected + more, e.kind, e.why_not)

    def with_more(self, name: str, more: float) -> None:
        """Widen the interval of a probe by the size of a vector."""
        probe = self.probes[name]
        size = float(np.linalg.norm(probe.value))
        self.probes[name] = probe.widened(more / size if size > 0.0 else 0.0, size)

    def resting(self, size: float) -> None:
        """Make exact what does not move: probes on supports, whose values and half widths are rounding of the rest.

        Parameters
        ----------
        size : float
            The largest displacement.
        """
        for name, p in self.probes.items():
            if np.linalg.norm(p.value) + np.linalg.norm(p.half_width) <= RESTING * size:
                still = np.zeros(3)
                self.probes[name] = Interval(still, still, still, p.kind)

    def with_share(self, share: float) -> None:
        """Widen all intervals by a relative error of another origin, as that of the algebra."""
        if self.energy is not None:
            self.with_more_energy(share * abs(self.energy.value))
        self.probes = {name: interval.widened(share, self.size) for name, interval in self.probes.items()}

    def with_shape(self) -> None:
        """Widen all intervals by the error because of the shape."""
        share, before = self.geometry or 0.0, dict(self.probes)
        self.with_share(share)
        for name, own in self.shapes.items():
            interval = before[name]
            if own * float(np.linalg.norm(interval.value)) > share * self.size:
                self.probes[name] = interval.widened(max(own, share))

    def with_loads(self, missed: Sequence[Missed], size: float) -> None:
        """Widen all intervals by what shares of loads that are missed can change; of the largest displacement `size`.

        Measured on 8 loads that jump or peak, on meshes of 8 to 512 triangles: displacements change by up to 2.3 times
        the share of the largest one under the load, the energy by twice as much. Where loads nearly cancel that is the
        one under a load alone; energies U and U_1 of all and of one are apart from that of their sum by 2 sqrt(U U_1).
        """
        most = sum(m.share * m.size for m in missed)
        self.loads = max(sum(m.share for m in missed), _ratio(most, size))
        if self.energy is not None:
            e = self.energy
            both = sum(m.share * float(np.sqrt(m.energy * abs(e.value))) for m in missed)
            more = 2.0 * MISSED * both + sum((MISSED * m.share) ** 2 * m.energy for m in missed)
            self.by_loads[ENERGY] = _ratio(more, abs(e.value))
            self.energy = Estimate(
                e.value, e.half_width + more, e.expected + more / MISSED, e.kind, e.why_not
            )
        for name, p in self.probes.items():
            own = float(np.linalg.norm(p.value))
            wider = MISSED * sum(m.share * max(own, m.size) for m in missed) * (p.half_width > 0.0)
            self.by_loads[name] = _ratio(float(np.linalg.norm(wider)), own)
            self.probes[name] = Interval(
                p.value, p.half_width + wider, p.expected + wider / MISSED, p.kind, p.common
            )

    def intersect(self, other: Assessment) -> None:
        """Narrow guaranteed intervals to what they have in common with those of the same quantities on another mesh."""
        mine, its = self.energy, other.energy
        if mine is not None and its is not None and mine.kind == its.kind == "guaranteed":
            lower, upper = max(mine.lower, its.lower), min(mine.upper, its.upper)
            if lower <= upper:
                half = 0.5 * (upper - lower)
                self.energy = Estimate(lower + half, half, min(mine.expected, half), mine.kind, mine.why_not)
        for name, interval in self.probes.items():
            found = other.probes.get(name)
            if found is None or not interval.kind == found.kind == "guaranteed":
                continue
            low = np.maximum(interval.value - interval.half_width, found.value - found.half_width)
            high = np.minimum(interval.value + interval.half_width, found.value + found.half_width)
            if (low <= high).all():
                half_width = 0.5 * (high - low)
                expected = np.minimum(interval.expected, half_width)
                self.probes[name] = Interval(low + half_width, half_width, expected, interval.kind)

    def document(self, result: Result, quantity: str | None = None) -> None:
        """Fill the entry `error` of a result, and put its probes in the middle of guaranteed intervals."""
        error = result.error
        named = self.quantities(quantity) or self.quantities(None)
        error["estimate"], error["kind"] = None, "none"
        if named:
            relative = self.relative(named[0])
            error["estimate"] = relative if np.isfinite(relative) else None
            error["kind"] = self.kind(named[0]) if self._known(named[0]) else "none"
        if self.energy is not None and self._known(ENERGY):
            e = self.energy
            error["energy"] = {"lower": e.lower, "upper": e.upper, "kind": e.kind}
        error["probes"] = {
            name: {"u": {"half_width": p.half_width, "expected": p.expected, "kind": p.kind}}
            for name, p in self.probes.items()
            if self._known(name)
        }
        for name, p in self.probes.items():
            if not np.array_equal(p.value, result.motion_at_probe(name)):
                result.probes[name]["u"] = result.probe_motions[name] = p.value
        why_not = "; ".join(words for words in (self.infinite, self.why_not) if words)
        if why_not:
            error["why_not"] = why_not
        budget: dict[str, Any] = error["budget"]
        budget["discretisation"] = error["estimate"]
        budget["geometry"] = self.geometry
        if self.geometry is not None and named:
            budget["geometry"] = max(self.geometry, self.shapes.get(named[0], 0.0))
        if self.loads:
            budget["loads"] = self.loads


def _ratio(part: float, whole: float) -> float:
    if part == 0.0:
        return 0.0
    return part / whole if whole > 0.0 else np.inf


def energy_interval(value: float, norm: float, at_rest: bool, why_not: str = "") -> Estimate:
    """The strain energy within what an error of a norm in energy can change.

    At rest, without prescribed motion and initial strains, it is U <= U + |e|^2 / 2; else |U - U_h| is at most
    |e| sqrt(2 U_h) + |e|^2 / 2.
    """
    if at_rest:
        half = 0.25 * norm**2
        return Estimate(value + half, half, half, "estimated", why_not)
    half = norm * float(np.sqrt(2.0 * max(value, 0.0))) + 0.5 * norm**2
    return Estimate(value, half, 0.5 * half, "estimated", why_not)
