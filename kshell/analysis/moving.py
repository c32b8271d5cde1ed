"""A model and its loads in time, ready to move: mass, damping, conditions at the start, and the steps to take.

What differs between small and large deflections is in `moving_small.py` and `moving_large.py`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from functools import lru_cache
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.first_mode import first_frequency
from kshell.analysis.run import Run
from kshell.equilibrium.model import NO_DENSITY
from kshell.equilibrium.motion.history import Observer
from kshell.equilibrium.motion.integrator import Integrator
from kshell.equilibrium.motion.march import PER_PERIOD, TimeSteps
from kshell.equilibrium.motion.state import Motion
from kshell.equilibrium.moving_model import MovingModel
from kshell.errors import InputError
from kshell.mesh.select import select
from kshell.result.result import Result
from kshell.scene.loads import Gravity
from kshell.scene.motion import Damping
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure

Floats = NDArray[np.float64]
M = TypeVar("M", bound=MovingModel)

# times whose loads are kept: those of the ends and the middle of a step
KEPT = 4


class Moving(ABC, Generic[M]):
    """A model and its loads in time.

    Attributes
    ----------
    large : bool
        Whether deflections are large.
    rest : object
        What the model remembers of its rest state; None where it remembers nothing.
    words : str
        How it is computed.
    warnings : list of str
    """

    large: bool
    rest: Any = None

    def __init__(self, model: M, run: Run) -> None:
        options, scene = run.options, run.scene
        self.model, self.timed, self.ramp = model, run.structure, options.ramp
        self.warnings: list[str] = []
        self.mass = model.full_mass()
        if not self.mass.diagonal().any():
            raise InputError(NO_DENSITY)
        self._at = lru_cache(KEPT)(self._loaded)
        self._starts_at_rest()
        self.frequency = first_frequency(model)
        damping = Damping() if scene.damping is None else scene.damping
        if damping.per_mode is not None:
            raise InputError(
                'damping: a ratio for every mode is for analysis = "response": a motion is damped by its material; '
                "give the ratio of the first mode, a number"
            )
        viscosity = damping.material(self.frequency)
        touching = scene.contact is not None
        scheme = options.scheme if options.scheme != "auto" else "bdf2" if touching else "alpha"
        self.integrator, how = self._integrator(run, scheme, viscosity, damping.drag)
        fixed = options.step != "auto"
        step = options.step if fixed else 2.0 * np.pi / self.frequency / PER_PERIOD
        self.steps = TimeSteps(
            self.integrator, options.time, min(step, options.time), fixed or touching, self.frequency
        )
        self.words = (
            f"motion: scheme {scheme}, first step {self.steps.first:.4g}; the first mode has the period "
            f"{2.0 * np.pi / self.frequency:.6g}"
        )
        if viscosity:
            self.words += (
                f"; viscosity {viscosity:.4g}: damping ratio {0.5 * viscosity * self.frequency:.4g} of the first mode, "
                "of others in the ratio of their frequencies"
            )
        self.words += f"; {how}" if how else ""
        self.velocity, self.displacement = scene.initial_velocity, scene.initial_displacement

    @abstractmethod
    def _integrator(self, run: Run, scheme: str, viscosity: float, drag: float) -> tuple[Integrator, str]:
        """The steps of a scheme, and words about what is special of them."""

    @abstractmethod
    def _given(self, model: M) -> Floats:
        """(unknowns,) prescribed motion."""

    @abstractmethod
    def _load(self, model: M) -> Floats:
        """(unknowns,) dead loads."""

    @abstractmethod
    def _displaced(self) -> Floats:
        """(unknowns,) the displacement at the start."""

    @abstractmethod
    def recover(self, motion: Motion, work: float) -> Result:
        """The result of a state, inertia and damping acting as loads."""

    @abstractmethod
    def doubts(self, motions: list[Motion]) -> list[str]:
        """What the states kept show that a user should know."""

    @property
    @abstractmethod
    def solver_words(self) -> str:
        """How systems are solved."""

    def _starts_at_rest(self) -> None:
        if np.any(self._given(self.at(0.0))):
            raise InputError(
                "a prescribed motion is not zero at t = 0, so the structure would jump: let it begin at 0, with an "
                'expression in t such as "0.01*min(t/0.1, 1)", or with ramp'
            )

    def at(self, time: float) -> M:
        """The model under the loads of a time."""
        return self._at(time)

    def _loaded(self, time: float) -> M:
        factor = 1.0 if self.ramp is None else min(time / self.ramp, 1.0)
        now = self.timed.at_time(time)
        structure = replace(self.model.structure, loads=now.loads, supports=now.supports)
        if not self._changes and factor == 1.0:
            return self.model
        return self.model.loaded(structure, factor)

    @property
    def _changes(self) -> bool:
        every: list[Placed[Any]] = [*self.timed.loads, *self.timed.supports]
        return any(placed.depends_on_time for placed in every)

    def pushed(self, value: Any, place: Any = None) -> Floats:
        """(unknowns,) load of an acceleration: the momentum of that velocity."""
        structure: Structure = replace(self.model.structure, loads=(Placed(Gravity(value), place),))
        return self._load(self.model.loaded(structure))

    def start(self) -> Motion:
        """The motion at the time 0."""
        momentum = None
        if self.velocity is not None:
            space, on = self.model.structure.space, self.velocity.on
            place = None if on is None else select(space, on, dimensions=(2,), what="initial velocity")
            momentum = self.pushed(self.velocity.value, place)
        x = None if self.displacement is None else self._displaced()
        return self.integrator.start(momentum, x, self.steps.first)

    def observer(self) -> Observer:
        """What keeps the history."""
        model = self.model
        probes = {
            name: np.array([model.probe_row(name, axis) for axis in "xyz"]) for name in model.structure.probes
        }
        return Observer(self.integrator, model.rigid_motions, probes)

    def inertia(self, motion: Motion) -> Floats:
        """(unknowns,) forces of inertia, damping and contact, as loads."""
        inertia = self.integrator.mass @ self.integrator.accelerated(motion)
        return motion.contact - motion.damping - inertia
