"""How velocity and acceleration at the end of a step follow from the place there.

Every scheme of one equilibrium a step has the form

    v1 = d x1 - v_k,    a1 = c x1 - a_k,    w M a1 + D v1 + f_int(x1) = f1 + r

with constants c, d, w of the scheme and v_k, a_k, r known from the steps before. So a step is an equilibrium with
springs w c M + d D and a constant force.

alpha   generalised alpha of Chung & Hulbert (J. Appl. Mech. 60, 1993), of order 2, with the share rho of the amplitude
        that the fastest vibrations keep in a step
bdf2    backward differences of order 2 for steps of any sizes, which damp fast vibrations
euler   implicit Euler, of order 1: for what is to come to rest
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.motion.state import Before, Motion

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Rule:
    """The constants of one step, as in the module's docstring.

    Attributes
    ----------
    c, d, w : float
    acceleration, velocity : (unknowns,)
        a_k and v_k.
    rest : (unknowns,)
        r.
    """

    c: float
    d: float
    w: float
    acceleration: Floats
    velocity: Floats
    rest: Floats


class Scheme(ABC):
    """A scheme of one equilibrium a step.

    Attributes
    ----------
    error : float
        The error of a step is about this number times step^2 times the change of the acceleration.
    end_share : float
        Share of the force at the end of a step in its impulse.
    """

    error: ClassVar[float]
    end_share: ClassVar[float] = 0.5

    @abstractmethod
    def rule(self, motion: Motion, step: float, mass: sp.csr_matrix) -> Rule:
        """The constants of a step from a motion; `mass` (unknowns, unknowns)."""


class Alpha(Scheme):
    """Generalised alpha.

    Parameters
    ----------
    rho : float
        Spectral radius for infinitely fast vibrations, from 0 (gone in one step) to 1 (undamped).
    """

    error = 0.142  # |beta - 1/6| at rho = 0.8

    def __init__(self, rho: float = 0.8) -> None:
        self.at_mass = (2.0 * rho - 1.0) / (1.0 + rho)
        self.at_force = rho / (1.0 + rho)
        self.gamma = 0.5 - self.at_mass + self.at_force
        self.beta = 0.25 * (1.0 - self.at_mass + self.at_force) ** 2

    def rule(self, motion: Motion, step: float, mass: sp.csr_matrix) -> Rule:
        x, v, a = motion.x, motion.velocity, motion.acceleration
        c = 1.0 / (self.beta * step**2)
        d = self.gamma / (self.beta * step)
        acceleration = c * (x + step * v) + (0.5 / self.beta - 1.0) * a
        velocity = step * self.gamma * acceleration - v - step * (1.0 - self.gamma) * a
        share = 1.0 - self.at_force
        rest = (self.at_force * motion.force - self.at_mass * (mass @ a)) / share
        return Rule(c, d, (1.0 - self.at_mass) / share, acceleration, velocity, rest)


class Euler(Scheme):
    """Implicit Euler."""

    error = 0.5
    end_share = 1.0

    def rule(self, motion: Motion, step: float, mass: sp.csr_matrix) -> Rule:
        return _backward(1.0 / step, motion.x, motion.velocity)


class Bdf2(Scheme):
    """Backward differences of order 2; the first step is one of implicit Euler."""

    error = 0.25

    def rule(self, motion: Motion, step: float, mass: sp.csr_matrix) -> Rule:
        before = motion.before
        if before is None:
            return _backward(1.0 / step, motion.x, motion.velocity)
        ratio = step / before.step
        lead = (1.0 + 2.0 * ratio) / (1.0 + ratio)
        near, far = (1.0 + ratio) / lead, ratio**2 / (1.0 + ratio) / lead
        x = near * motion.x - far * before.x
        v = near * motion.velocity - far * before.velocity
        return _backward(lead / step, x, v)


def _backward(d: float, x: Floats, v: Floats) -> Rule:
    """v1 = d (x1 - x), a1 = d (v1 - v)."""
    return Rule(d * d, d, 1.0, d * d * x + d * v, d * x, np.zeros_like(x))


def earlier(motion: Motion, step: float) -> Before:
    """What a motion leaves for the step after the next."""
    return Before(motion.x, motion.velocity, step)


SCHEMES: dict[str, Callable[[], Scheme]] = {"alpha": Alpha, "bdf2": Bdf2, "euler": Euler}
