"""Paths along which a displacement grows instead of the load: through limit points of the load, whatever it does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.load_steps import EASY, HARD, MOST_ATTEMPTS, SMALLEST_STEP
from kshell.equilibrium.march import March
from kshell.equilibrium.path import Critical, PathFollower
from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

Floats = NDArray[np.float64]


class ControlledSteps:
    """Steps of one displacement, with the load factor it takes.

    Parameters
    ----------
    problem : Problem
    row : (unknowns,)
        Its product with x is the displacement.
    until : float
        Last displacement.
    steps : int
        First guess of the number of steps.
    """

    def __init__(self, problem: Problem, row: Floats, until: float, steps: int = 10) -> None:
        self.row, self.until, self.steps = row, until, max(steps, 1)
        self._follower = PathFollower(problem)

    def begin(self, state: State) -> March:
        """The march from a state."""
        return March(state, (self.until - self._value(state)) / self.steps)

    def ended(self, march: March) -> bool:
        """Whether the last displacement is reached."""
        return abs(self.until - self._value(march.state)) <= 1e-9 * abs(self.until)

    def go_on(self, march: March) -> tuple[March, Critical | None]:
        """The next converged state, and the critical point passed on the way, if any.

        Raises
        ------
        SolveError
            If there is none, as where the displacement itself turns back; its `state` is the march so far.
        """
        while march.attempts <= MOST_ATTEMPTS + 2 * self.steps:
            state, left = march.state, self.until - self._value(march.state)
            size = float(np.sign(left) * min(abs(march.size), abs(left)))
            march = replace(march, attempts=march.attempts + 1)
            try:
                step = self._follower.displacement(state, self.row, size)
            except SolveError as error:
                march = replace(march, size=0.5 * size)
                if abs(march.size) < SMALLEST_STEP * abs(self.until):
                    where = f"displacement {self._value(state):.6g}, load factor {state.factor:.6g}"
                    raise SolveError(
                        f"the controlled displacement cannot go on ({where}): it turns back there, or the shell "
                        "branches; control another one, or leave control out",
                        state=march,
                    ) from error
                continue
            found, critical = step.state, None
            if found.negative != state.negative:
                critical = self._follower.critical(state, self._follower.size(step.moved), step.moved)
            if found.iterations <= EASY:
                size *= 1.5
            elif found.iterations > HARD:
                size *= 0.7
            return replace(march, state=found, size=size), critical
        raise SolveError(f"{march.attempts} steps did not reach the displacement {self.until:g}", state=march)

    def _value(self, state: State) -> float:
        return float(self.row @ state.x)
