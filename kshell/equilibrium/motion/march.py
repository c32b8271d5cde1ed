"""Which steps a motion takes: their sizes from the error of each, and from whether it has an answer.

The error of a step is about C h^2 times the change of the acceleration (Zienkiewicz & Xie, Earthquake Engng Struct.
Dyn. 20, 1991), here in the mean over the mass, against the largest amplitude so far. Amplitudes of displacement,
velocity and acceleration are compared as in a vibration of the first mode.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.motion.integrator import MOST_TOUCHING, Integrator
from kshell.equilibrium.motion.state import Motion
from kshell.errors import SolveError

Floats = NDArray[np.float64]

# steps of a period of the first mode, and the error of such a step by generalised alpha, (2 pi / 40)^3 C
PER_PERIOD = 40
ALLOWED = 5.5e-4
# part of the allowed error below which steps grow, and by how much; where few sizes are wanted
GROWTH, GROWTH_OF_FEW = (0.2, 1.25), (0.1, 2.0)
# part of the allowed error above which a step is taken again
AGAIN = 2.0
# a step is given up at this part of the first, and may grow to this part of the time
SMALLEST, LARGEST = 1.0 / 64.0, 0.05
# part of a step by which another of the same size may differ, by rounding: matrices of one size serve again
ALIKE = 1e-9
# a step shorter than this part of the first was cut before
CUT = 0.75
# steps before the end that are made alike, where few sizes are wanted
NEAR = 3
# iterations after which a step that was cut may grow again; with contact
EASY, EASY_TOUCHING = 6, 15


@dataclass(frozen=True)
class Going:
    """A motion and how to go on from it.

    Attributes
    ----------
    motion : Motion
    size : float
        Of the next step.
    amplitude : float
        Largest so far.
    steps, rejected : int
        Made so far, and taken again.
    patient : bool
        Whether steps with contact may take many iterations, as shorter ones took no fewer.
    """

    motion: Motion
    size: float
    amplitude: float = 0.0
    steps: int = 0
    rejected: int = 0
    patient: bool = False


class TimeSteps:
    """Steps up to an end.

    Parameters
    ----------
    integrator : Integrator
    end : float
    step : float
        The first.
    fixed : bool
        Whether steps stay as they are where they have an answer.
    frequency : float
        Circular frequency of the first mode, to compare amplitudes.
    """

    def __init__(
        self, integrator: Integrator, end: float, step: float, fixed: bool, frequency: float
    ) -> None:
        self.integrator, self.end, self.first, self.fixed = integrator, end, step, fixed
        self.frequency = frequency
        self._few = integrator.few_sizes and not fixed

    def begin(self, motion: Motion) -> Going:
        """From a motion."""
        return Going(motion, self.first, self._amplitude(motion))

    def ended(self, going: Going) -> bool:
        """Whether the end is reached."""
        return going.motion.time >= self.end * (1.0 - 1e-12)

    def go_on(self, going: Going) -> Going:
        """A step further.

        Raises
        ------
        SolveError
            If no step has an answer, however short; its `state` is where it began.
        """
        motion, size, rejected = going.motion, going.size, going.rejected
        while True:
            left = self.end - motion.time
            h = left / np.ceil(left / size - 1e-9)  # the last steps are alike
            if abs(h - size) <= ALIKE * size or (self._few and left > NEAR * size):
                h = size
            try:
                found = self.integrator.step(motion, h, going.patient or h < CUT * self.first)
            except SolveError as error:
                size, rejected = 0.5 * h, rejected + 1
                if size < SMALLEST * self.first:
                    raise SolveError(
                        f"the motion cannot go on from t = {motion.time:.6g}: a step of {h:.3g} has no answer "
                        f"({error})",
                        state=going,
                    ) from error
                continue
            if not np.isfinite(found.velocity).all():
                raise SolveError(f"the motion is not finite after t = {motion.time:.6g}", state=going)
            amplitude = max(going.amplitude, self._amplitude(found))
            error_of_step = self._error(motion, found, h) / (amplitude or 1.0)
            if not self.fixed and error_of_step > AGAIN * ALLOWED and 0.5 * h >= SMALLEST * self.first:
                size, rejected = 0.5 * h, rejected + 1
                continue
            after, patient = self._next(size, found, error_of_step), going.patient
            touching = self.integrator.barrier is not None
            if touching and not patient and h < CUT * self.first and found.state.iterations > MOST_TOUCHING:
                after, patient = self.first, True
            return Going(found, after, amplitude, going.steps + 1, rejected, patient)

    def _next(self, size: float, found: Motion, error: float) -> float:
        easy = EASY if self.integrator.barrier is None else EASY_TOUCHING
        if found.state.iterations > easy:
            return size
        if self.fixed:
            return min(2.0 * size, self.first)
        calm, growth = GROWTH_OF_FEW if self._few else GROWTH
        return min(growth * size, LARGEST * self.end) if error < calm * ALLOWED else size

    def _error(self, before: Motion, after: Motion, h: float) -> float:
        return self.integrator.error * h**2 * self._norm(after.acceleration - before.acceleration)

    def _amplitude(self, motion: Motion) -> float:
        w = self.frequency
        return max(
            self._norm(motion.x), self._norm(motion.velocity) / w, self._norm(motion.acceleration) / w**2
        )

    def _norm(self, x: Floats) -> float:
        return float(np.sqrt(max(x @ (self.integrator.mass @ x), 0.0)))
