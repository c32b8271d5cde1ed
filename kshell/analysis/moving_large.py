"""Motion by large deflections, with contact and materials that remember."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.moving import KEPT, Moving
from kshell.analysis.obstacles import barrier_of
from kshell.analysis.run import Run
from kshell.equilibrium.contact.barrier import Barrier
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.motion.state import Motion
from kshell.equilibrium.motion.steps import FiniteIntegrator
from kshell.errors import InputError
from kshell.result.result import Result
from kshell.scene.loads import Gravity

Floats = NDArray[np.float64]

# times at which loads are looked at, for the stiffness of contact
LOOKS = 9


class LargeMotion(Moving[FiniteModel]):
    """A model of finite deformation and its loads in time."""

    large = True

    def __init__(self, model: FiniteModel, run: Run) -> None:
        self._equilibrium = lru_cache(KEPT)(lambda time: self.at(time).equilibrium())
        super().__init__(model, run)
        self.rest = self._equilibrium(0.0).energy.rest

    def _integrator(
        self, run: Run, scheme: str, viscosity: float, drag: float
    ) -> tuple[FiniteIntegrator, str]:
        touching = run.scene.contact is not None
        if scheme == "em" and self.model.structure.section.inelastic():
            raise InputError(
                'scheme = "em" keeps energy, and a material that yields (hardening) or relaxes (relaxation) does not: '
                'take "alpha", "bdf2" or "euler"'
            )
        if viscosity and self.model.yields:
            raise InputError(
                "damping: ratio and viscosity are for materials that do not yield: take drag, or leave hardening out"
            )
        if touching and scheme == "em":
            raise InputError('scheme = "em" has no contact: take "alpha", "bdf2" or "euler"')
        barrier, how = self._barrier(run) if touching else (None, "")
        return FiniteIntegrator(self._equilibrium, self.mass, scheme, viscosity, drag, barrier), how

    def _barrier(self, run: Run) -> tuple[Barrier, str]:
        """The barrier of contact."""
        contact, model = run.scene.contact, self.model
        assert contact is not None
        area = float(model.structure.space.areas.sum())
        speed = 0.0
        if run.scene.initial_velocity is not None:
            points = model.structure.space.points
            at = Gravity(run.scene.initial_velocity.value).at(points)
            speed = float(np.linalg.norm(at, axis=1).max())
        density = float(self.mass.sum()) / 3.0 / area
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

    def _given(self, model: FiniteModel) -> Floats:
        return model.equilibrium().reduction.given

    def _load(self, model: FiniteModel) -> Floats:
        return model.equilibrium().load

    def _displaced(self) -> Floats:
        assert self.displacement is not None
        return self.model.displaced(Gravity(self.displacement.value).at)

    def recover(self, motion: Motion, work: float) -> Result:
        inertia = self.inertia(motion)
        return self.at(motion.time).recover_state(replace(motion.state, factor=1.0), work, inertia)

    def doubts(self, motions: list[Motion]) -> list[str]:
        return []

    @property
    def solver_words(self) -> str:
        return f"every step is factorised; {self.words}"
