"""A model and its loads in time, ready to move: mass, damping, contact, and the steps to take."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from kshell.analysis.first_mode import first_frequency
from kshell.analysis.obstacles import barrier_of
from kshell.analysis.run import Run
from kshell.equilibrium.contact.barrier import Barrier
from kshell.equilibrium.model import NO_DENSITY, FiniteModel
from kshell.equilibrium.motion.history import Observer
from kshell.equilibrium.motion.march import PER_PERIOD, TimeSteps
from kshell.equilibrium.motion.state import Motion
from kshell.equilibrium.motion.steps import Integrator
from kshell.errors import InputError
from kshell.mesh.select import select
from kshell.result.result import Result
from kshell.scene.loads import Gravity
from kshell.scene.motion import Damping
from kshell.scene.structure import Placed, Structure

# times at which loads are looked at, for the stiffness of contact
LOOKS = 9
# times whose loads are kept: those of the ends and the middle of a step
KEPT = 4


class Moving:
    """A model and its loads in time.

    Attributes
    ----------
    words : str
        How it is computed.
    """

    def __init__(self, model: FiniteModel, run: Run) -> None:
        options, scene = run.options, run.scene
        self.model, self.timed = model, run.structure
        self.ramp = options.ramp
        mass = model.full_mass()
        if not mass.diagonal().any():
            raise InputError(NO_DENSITY)
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
        if scheme == "em" and model.structure.section.inelastic():
            raise InputError(
                'scheme = "em" keeps energy, and a material that yields (hardening) or relaxes (relaxation) does not: '
                'take "alpha", "bdf2" or "euler"'
            )
        if viscosity and model.yields:
            raise InputError(
                "damping: ratio and viscosity are for materials that do not yield: take drag, or leave hardening out"
            )
        if touching and scheme == "em":
            raise InputError('scheme = "em" has no contact: take "alpha", "bdf2" or "euler"')
        self._equilibrium = lru_cache(KEPT)(lambda time: self.at(time).equilibrium())
        barrier, how = self._barrier(run, mass) if touching else (None, "")
        self.integrator = Integrator(self._equilibrium, mass, scheme, viscosity, damping.drag, barrier)
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
        if touching:
            self.words += f"; {how}"
        self.velocity, self.displacement = scene.initial_velocity, scene.initial_displacement

    def _barrier(self, run: Run, mass: Any) -> tuple[Barrier, str]:
        """The barrier of contact."""
        contact, model = run.scene.contact, self.model
        assert contact is not None
        area = float(model.structure.space.areas.sum())
        speed = 0.0
        if run.scene.initial_velocity is not None:
            points = model.structure.space.points
            at = Gravity(run.scene.initial_velocity.value).at(points)
            speed = float(np.linalg.norm(at, axis=1).max())
        density = float(mass.sum()) / 3.0 / area
        impact, inertia = 0.5 * density * speed**2, density * self.frequency**2
        times = np.linspace(0.0, run.options.time, LOOKS)
        return barrier_of(
            contact,
            run.scene.obstacles,
            model.contact_surface(),
            model.thickness,
            self._equilibrium,
            times.tolist(),
            impact,
            inertia,
        )

    def _starts_at_rest(self) -> None:
        given = self.at(0.0).equilibrium().reduction.given
        if np.any(given):
            raise InputError(
                "a prescribed motion is not zero at t = 0, so the structure would jump: let it begin at 0, with an "
                'expression in t such as "0.01*min(t/0.1, 1)", or with ramp'
            )

    def at(self, time: float) -> FiniteModel:
        """The model under the loads of a time."""
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

    def start(self) -> Motion:
        """The motion at the time 0."""
        momentum = None
        if self.velocity is not None:
            space, on = self.model.structure.space, self.velocity.on
            place = None if on is None else select(space, on, dimensions=(2,), what="initial velocity")
            # the load of an acceleration is the momentum of a velocity
            pushed: Structure = replace(
                self.model.structure, loads=(Placed(Gravity(self.velocity.value), place),)
            )
            momentum = self.model.loaded(pushed).equilibrium().load
        x = None
        if self.displacement is not None:
            place_of = Gravity(self.displacement.value)
            x = self.model.displaced(place_of.at)
        return self.integrator.start(momentum, x, self.steps.first)

    def observer(self) -> Observer:
        """What keeps the history."""
        model = self.model
        probes = {
            name: np.array([model.probe_row(name, axis) for axis in "xyz"]) for name in model.structure.probes
        }
        return Observer(self.integrator, model.rigid_motions, probes)

    def recover(self, motion: Motion, work: float) -> Result:
        """The result of a state, inertia and damping acting as loads."""
        mass = self.integrator.mass
        inertia = motion.contact - motion.damping - mass @ self.integrator.by_mass(motion.force)
        return self.at(motion.time).recover_state(replace(motion.state, factor=1.0), work, inertia)
