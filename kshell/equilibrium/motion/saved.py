"""A motion on disk, from which it goes on as if it had never stopped."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.checkpoint import Store, read_state, state_content
from kshell.equilibrium.motion.march import Going
from kshell.equilibrium.motion.state import Before, Motion

Floats = NDArray[np.float64]

VECTORS = ("velocity", "acceleration", "force", "load", "damping", "contact", "strain")


def write(store: Store, number: int, going: Going, rows: Sequence[Floats]) -> None:
    """Write a state with the rows of the history since the one before.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    motion = going.motion
    content: dict[str, Any] = state_content("", motion.state)
    content |= {name: getattr(motion, name) for name in VECTORS}
    content["motion"] = np.array([motion.time, motion.strain_energy])
    content["going"] = np.array([going.size, going.amplitude, going.steps, going.rejected, going.patient])
    content["rows"] = np.array(rows)
    if motion.before is not None:
        content |= {"before_x": motion.before.x, "before_velocity": motion.before.velocity}
        content["before_step"] = motion.before.step
    store.write_content(number, content)


def read(content: dict[str, Any], rest: Any) -> tuple[Going, Floats]:
    """The state and its rows (step, column)."""
    time, energy = content["motion"]
    before = None
    if "before_x" in content:
        before = Before(content["before_x"], content["before_velocity"], float(content["before_step"]))
    vectors = {name: content[name] for name in VECTORS}
    state = read_state("", content, rest)
    motion = Motion(float(time), state, strain_energy=float(energy), before=before, **vectors)
    size, amplitude, steps, rejected, patient = content["going"]
    going = Going(motion, float(size), float(amplitude), int(steps), int(rejected), bool(patient))
    return going, content["rows"]
