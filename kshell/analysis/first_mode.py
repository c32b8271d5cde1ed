"""The slowest vibration of a model, from which time steps and damping are taken."""

from __future__ import annotations

import numpy as np

from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.solvers.eigen import smallest
from kshell.solvers.pencil import Pencil


def first_frequency(model: Model) -> float:
    """Circular frequency of the first mode at rest that is no rigid motion.

    Raises
    ------
    InputError
        If nothing can vibrate, or there is no mass.
    """
    mass = model.mass()
    if not model.unknowns:
        raise InputError("the supports hold everything: nothing can move")
    rigid = model.rigid_modes(mass).vectors
    found = smallest(Pencil(model.stiffness(), mass, rigid, energy=model.energies), 1)
    value = float(found.values[0])
    if not value > 0.0:
        raise InputError("the structure has no vibration to take time steps from: give step")
    return float(np.sqrt(value))
