"""Motion by small deflections: plates, and shells where they are asked for."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.moving import KEPT, Moving
from kshell.analysis.run import Run
from kshell.equilibrium.motion.small import SmallIntegrator
from kshell.equilibrium.motion.state import Motion
from kshell.equilibrium.moving_model import MovingModel
from kshell.errors import InputError
from kshell.result.result import Result
from kshell.scene.loads import Gravity

Floats = NDArray[np.float64]

# deflection of a plate, in its thickness, from which what it stretches is not small
LARGE = 1.0
# part of the largest displacement that is rounding, and that which supports may hold of one that is given
ROUNDING, HELD = 1e-12, 1e-6


class SmallMotion(Moving[MovingModel]):
    """A model of small deflections and its loads in time."""

    large = False

    def __init__(self, model: MovingModel, run: Run) -> None:
        self._oscillator = lru_cache(KEPT)(lambda time: self.at(time).oscillator())
        super().__init__(model, run)

    def _integrator(
        self, run: Run, scheme: str, viscosity: float, drag: float
    ) -> tuple[SmallIntegrator, str]:
        return SmallIntegrator(self._oscillator, scheme, viscosity, drag), "small deflections"

    def _given(self, model: MovingModel) -> Floats:
        return model.oscillator().given

    def _load(self, model: MovingModel) -> Floats:
        return model.oscillator().load

    def _displaced(self) -> Floats:
        """At nodes, or nearest in the mean over the mass to what is given."""
        model, given = self.model, self.displacement
        assert given is not None
        place = Gravity(given.value)
        if model.nodal:
            return model.displaced(place.at)
        points = model.structure.space.points
        wanted = place.at(points)
        largest = float(np.abs(wanted).max(initial=0.0))
        if model.kind == "plate" and np.abs(wanted[:, :2]).max(initial=0.0) > ROUNDING * largest:
            raise InputError(
                'initial displacement: a plate moves along z only: make x and y zero, or take model = "shell"'
            )
        x = self.integrator.by_mass(self.pushed(given.value))
        found = model.motion_at(x, points)
        off = np.where(np.abs(found) <= ROUNDING * largest, np.abs(wanted), 0.0).max(initial=0.0)
        if off > HELD * largest:
            raise InputError(
                f"initial displacement: it moves what supports hold, by up to {off:.3g}: make it zero there"
            )
        return x

    def recover(self, motion: Motion, work: float) -> Result:
        return self.at(motion.time).recover_motion(motion.x, work, self.inertia(motion))

    def doubts(self, motions: list[Motion]) -> list[str]:
        if self.model.kind != "plate":
            return []
        largest = max(
            float(np.abs(self.model.motion_fields(motion.x)["displacement"]).max()) for motion in motions
        )
        thickness = self.model.thickness
        if largest <= LARGE * thickness:
            return []
        return [
            f"deflections reach {largest:.3g}, {largest / thickness:.2g} times the thickness: they stretch the plate, "
            "which small deflections leave out; leave model and large_deflection out, or large_deflection = true"
        ]

    @property
    def solver_words(self) -> str:
        integrator = self.integrator
        assert isinstance(integrator, SmallIntegrator)
        return f"factorised {integrator.factorised} times, once for every size of the steps; {self.words}"
