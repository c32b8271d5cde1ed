"""Equilibrium paths through limit points and bifurcations.

The load factor is one more unknown, and one more equation says how far to go: along the path
(arc length in the displacements, after Riks and Crisfield, linearised), or in one displacement. The stress
in the tangent is extrapolated as in newton.py.

Symbols
-------
q, f       free unknowns, load factor
a          K^-1 times the growth of the load: how the shell moves with the factor
b          K^-1 times the residual
W          weights of the translations, so that q . W q is the mean square displacement of the nodes
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError
from kshell.solvers.repeated import Factor

Floats = NDArray[np.float64]
Then = Literal["followed", "jumped", "branched"]

MOST_ITERATIONS = 15
FINISHED = 1e-13
# iterations of a step that leave its length as it is
GOOD = 6
SHORTEST = 1.0 / 2048.0
LONGEST = 16.0
BISECTIONS = 8
# short steps after the last bisection in which the critical point must lie
MARGIN = 4


@dataclass(frozen=True)
class Critical:
    """A point of the path where the stability changes.

    Attributes
    ----------
    kind : str
        "limit" or "bifurcation"; "jump" where the path could not be followed any more.
    state : State
        Close to it.
    mode : (unknowns,)
        Motion without stiffness, largest translation 1.
    then : "followed", "jumped" or "branched"
        How it went on: along the path, to a stable state elsewhere, or along the branch that leaves there.
    """

    kind: str
    state: State
    mode: Floats
    then: Then = "followed"


@dataclass(frozen=True)
class Step:
    """A converged step: the state and how the free unknowns moved."""

    state: State
    moved: Floats


class Low(NamedTuple):
    """A state before a critical point, and the motion of the free unknowns to it."""

    state: State
    moved: Floats | None


@dataclass(frozen=True)
class Arc:
    """What the next step along a path takes over from the last one.

    Attributes
    ----------
    length : float
        Of the next step.
    first : float
        Of the first step, which bounds the later ones.
    moved : (free unknown,), optional
        Motion of the last step, which tells forward from back.
    made : float
        Length of the last step.
    """

    length: float
    first: float
    moved: Floats | None = None
    made: float = 0.0


class PathFollower:
    """Steps along the path of a problem.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        basis = problem.reduction.basis
        self.weights = basis.multiply(basis).T @ problem.energy.translation_weights()

    def arc(self, state: State, length: float, before: Floats | None, along: Floats | None = None) -> Step:
        """A step of a length, on from the motion `before`; or first along a given motion `along` at constant load.

        Raises
        ------
        SolveError
            If the iteration does not converge.
        """

        def predict(a: Floats, b: Floats) -> tuple[Floats, float]:
            if along is not None:
                return along * (length / self.size(along)), 0.0
            sign = 1.0 if before is None else (1.0 if (self.weights * a) @ before >= 0 else -1.0)
            factor = sign * length / self.size(a)
            return factor * a + b, factor

        def correct(first: Floats, a: Floats, b: Floats) -> float:
            row = self.weights * first
            across = row @ a
            return -(row @ b) / across if across != 0.0 else 0.0

        return self._step(state, predict, correct)

    def go_on(
        self, state: State, arc: Arc, along: Floats | None = None
    ) -> tuple[State, Arc, Critical | None]:
        """The next state, shorter steps tried where needed; and the critical point passed on the way, if any.

        Raises
        ------
        SolveError
            If steps become too short.
        """
        length = arc.length
        while True:
            try:
                step = self.arc(state, length, arc.moved, along)
                break
            except SolveError as error:
                length *= 0.5
                if length < SHORTEST * arc.first:
                    raise SolveError(
                        f"the path cannot be followed beyond the load factor {state.factor:.6g}: {error}"
                    ) from error
        critical = None
        if step.state.negative != state.negative and along is None:
            critical = self.critical(state, length, arc.moved)
        made = length
        grow = float(np.clip(GOOD / step.state.iterations, 0.5, 2.0))
        length = float(np.clip(length * grow, SHORTEST * arc.first, LONGEST * arc.first))
        return step.state, Arc(length, arc.first, step.moved, made), critical

    def displacement(self, state: State, row: Floats, change: float) -> Step:
        """A step in which a displacement, the product of (unknowns,) `row` and x, changes by a given amount."""
        given = float(row @ self.problem.reduction.rate(state.factor))
        row = self.problem.reduction.basis.T @ row

        def predict(a: Floats, b: Floats) -> tuple[Floats, float]:
            factor = (change - row @ b) / (row @ a + given)
            return factor * a + b, float(factor)

        return self._step(state, predict, lambda _, a, b: -float(row @ b) / float(row @ a + given))

    def size(self, q: Floats) -> float:
        """Root mean square displacement of the nodes of free unknowns."""
        return float(np.sqrt(self.weights @ q**2))

    def _step(
        self,
        state: State,
        predict: Callable[[Floats, Floats], tuple[Floats, float]],
        correct: Callable[[Floats, Floats, Floats], float],
    ) -> Step:
        problem = self.problem
        reduction = problem.reduction
        basis, given = reduction.basis, reduction.rate(state.factor)
        x, factor, stress = state.x, state.factor, None
        first: Floats | None = None
        moved = np.zeros(basis.shape[1])
        definite = state.negative == 0
        for iteration in range(1, MOST_ITERATIONS + 1):
            energy, residual, growth = problem.evaluate(x, factor, 2, state.memory, stress)
            tangent = problem.factorise(energy.hessian, definite)
            definite = tangent.definite
            reduced = basis.T @ residual
            if np.any(given):
                growth = growth - energy.hessian @ given
            a, b = tangent.solve(basis.T @ growth), tangent.solve(reduced)
            work = abs(float(reduced @ b))
            if first is None:
                change, more = predict(a, b)
                first = change
            else:
                more = correct(first, a, b)
                change = b + more * a
            full = basis @ change + more * given
            if reduction.following is not None:
                start = state.factor
                full = basis @ change + reduction.shift(start, factor + more) - reduction.shift(start, factor)
            stress = problem.energy.extrapolated_stress(energy.linear, full)
            x, factor, moved = x + full, factor + more, moved + change
            scale = abs(energy.value) + abs(factor * float(growth @ x))
            if not np.all(np.isfinite(change)) or not np.isfinite(energy.value):
                break
            if self.size(moved) > 10 * self.size(first):
                break
            if iteration > 1 and work <= FINISHED * scale:
                found = State(factor, x, state.memory, iteration, tangent.negative, state.turned)
                return Step(problem.settle(found), moved)
        raise SolveError(
            f"no equilibrium found on the path near the load factor {state.factor:.6g}", state=state
        )

    def critical(self, before: State, length: float, along: Floats | None) -> Critical:
        """The critical point within a step of a length from `before`, by bisection."""
        return self.softest_motion(self._bisected(before, length, along)[0].state)

    def bracketed(self, before: State, length: float) -> tuple[Critical, State | None]:
        """The same; and the last state of the path where its stability is not seen to change in a last short step.

        Then a step that ended less stable, or more, left the path for another one.
        """
        low, length = self._bisected(before, length, None)
        state, direction = low
        critical = self.softest_motion(state)
        for _ in range(MARGIN):
            try:
                step = self.arc(state, length, direction)
            except SolveError:
                return critical, None  # nothing is known against it
            if step.state.negative != before.negative:
                return critical, None
            state, direction = step.state, step.moved
        return critical, state

    def _bisected(self, before: State, length: float, along: Floats | None) -> tuple[Low, float]:
        """The last state as stable as the first, with the motion to it, and the length of the last step."""
        low, direction = before, along
        for _ in range(BISECTIONS):
            length *= 0.5
            try:
                step = self.arc(low, length, direction)
            except SolveError:
                continue
            if step.state.negative == before.negative:
                low, direction = step.state, step.moved
        return Low(low, direction), length

    def softest_motion(self, low: State) -> Critical:
        """A state taken for critical: its softest motion, and whether the load works on it."""
        energy, _, growth = self.problem.evaluate(low.x, low.factor, 2, low.memory, None)
        basis = self.problem.reduction.basis
        tangent = self.problem.factorise(energy.hessian, low.negative == 0)
        mode = softest(tangent, basis.shape[1])
        load = basis.T @ growth
        # at a limit point the load works on the mode, at a bifurcation it does not
        motion = tangent.solve(load)
        alike = abs((self.weights * mode) @ motion) / (self.size(mode) * self.size(motion))
        full = basis @ mode
        kind = "limit" if alike > 0.5 else "bifurcation"
        largest = np.abs(full[self.problem.energy.translation_weights() > 0.0]).max()
        return Critical(kind, low, full / largest)


def softest(tangent: Factor, size: int) -> Floats:
    """Unit vector of the eigenvalue closest to zero, by inverse iteration."""
    q = np.random.default_rng(0).normal(size=size)
    for _ in range(8):
        q = tangent.solve(q)
        q /= np.linalg.norm(q)
    return q


@dataclass(frozen=True)
class Path:
    """An equilibrium path.

    Attributes
    ----------
    states : list of State
    critical : list of Critical
        Where the number of negative eigenvalues changed.
    """

    states: list[State]
    critical: list[Critical]


def follow(
    problem: Problem,
    length: float,
    stop: Callable[[State], bool],
    start: State | None = None,
    along: Floats | None = None,
    most_steps: int = 200,
    record: Callable[[State], None] | None = None,
) -> Path:
    """Follow a path by its arc length.

    Parameters
    ----------
    length : float
        First step: root mean square displacement of the nodes. Later steps adapt to the iterations needed.
    stop : callable
        Tells from a state whether to end there.
    start : State, optional
        The rest state if absent.
    along : (unknowns,), optional
        Direction of the first step, for a branch: the mode of a `Critical`.
    record : callable, optional
        Called with every converged state.

    Raises
    ------
    SolveError
        If steps become too short; `state` is the `Path` so far.
    """
    follower = PathFollower(problem)
    path = Path([problem.start() if start is None else start], [])
    arc = Arc(length, length)
    first = None if along is None else problem.reduction.basis.T @ along
    while len(path.states) <= most_steps and not (len(path.states) > 1 and stop(path.states[-1])):
        try:
            state, arc, critical = follower.go_on(path.states[-1], arc, first)
        except SolveError as error:
            raise SolveError(str(error), state=path) from error
        first = None
        path.states.append(state)
        if critical is not None:
            path.critical.append(critical)
        if record is not None:
            record(state)
    return path
