"""What is kept of every step of a motion: energies, momenta, and displacements of probes.

balance    |change of momentum - impulse of all forces| against the larger of both, the largest on the way; forces are
           summed from those that loads and strains exert (trapezoidal rule; implicit Euler: those at the end of each
           step), so that it tells how well the steps follow them
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.motion.integrator import Integrator
from kshell.equilibrium.motion.state import Motion

Floats = NDArray[np.float64]

# columns of the table: name, width
COLUMNS = (
    ("time", 1),
    ("kinetic_energy", 1),
    ("strain_energy", 1),
    ("external_work", 1),
    ("dissipated_energy", 1),
    ("momentum", 3),
    ("angular_momentum", 3),
    ("impulse", 3),
    ("reaction", 3),
    ("iterations", 1),
)
WIDTH = sum(width for _, width in COLUMNS)


@dataclass(frozen=True)
class Observed:
    """What one time leaves for the sums over the next step."""

    motion: Motion
    net: Floats  # (3,) sum of all forces
    pressing: dict[str, Floats]  # (3,) force on each obstacle
    acting: Floats  # (unknowns,) loads and reactions


class Observer:
    """Makes the rows of the history.

    Parameters
    ----------
    integrator : Integrator
    rigid : function of x
        (unknowns, 6) rigid motions of the structure moved by x.
    probes : dict of str to (3, unknowns)
        Whose products with x are the displacements of the probes.
    """

    def __init__(self, integrator: Integrator, rigid: Any, probes: Mapping[str, Floats]) -> None:
        self.integrator, self.rigid, self.probes = integrator, rigid, probes
        self.rows: list[Floats] = []
        self._last: Observed | None = None

    def see(self, motion: Motion) -> None:
        """Another row."""
        mass = self.integrator.mass
        rigid = self.rigid(motion.x)
        inertia = mass @ self.integrator.accelerated(motion)
        held = motion.force - inertia  # less what supports exert
        barrier = self.integrator.barrier
        pressing = {} if barrier is None else barrier.on_obstacles(motion.x)
        seen = Observed(motion, rigid[:, :3].T @ inertia, pressing, motion.load - held)
        moving = mass @ motion.velocity
        momenta = rigid.T @ moving
        work, dissipated, impulse = 0.0, 0.0, np.zeros(3)
        if self._last is not None and self.rows:
            before, last = self._last, self.rows[-1]
            step = motion.time - before.motion.time
            turned = motion.state.turned - before.motion.state.turned
            moved = motion.x - before.motion.x + turned
            work = last[3] + 0.5 * float((before.acting + seen.acting) @ moved)
            if barrier is not None:
                work += barrier.work(before.pressing, pressing, before.motion.time, motion.time)
            damping = 0.5 * (before.motion.damping + motion.damping)
            dissipated = last[4] + float(damping @ moved) + _lost(motion) - _lost(before.motion)
            share = self.integrator.end_share
            impulse = last[11:14] + step * ((1.0 - share) * before.net + share * seen.net)
        row = [motion.time, 0.5 * float(motion.velocity @ moving), motion.strain_energy, work, dissipated]
        row += [*momenta, *impulse, *-(rigid[:, :3].T @ held), motion.state.iterations]
        row += [float(part @ motion.x) for rows in self.probes.values() for part in rows]
        if barrier is not None:
            row.append(barrier.gap(motion.x))
            row += [part for force in pressing.values() for part in force]
        self.rows.append(np.array(row))
        self._last = seen

    def go_on(self, rows: Floats, motion: Motion) -> None:
        """Take up rows (step, column) of an interrupted motion, the last of which is of the motion given."""
        self.rows = list(rows[:-1])
        self._last = None
        self.see(motion)
        self.rows[-1] = rows[-1]

    def table(self) -> dict[str, Any]:
        """Columns by name; of probes their displacements."""
        values = np.array(self.rows)
        out: dict[str, Any] = {}
        start = 0
        for name, width in COLUMNS:
            out[name] = values[:, start] if width == 1 else values[:, start : start + width]
            start += width
        out["iterations"] = out["iterations"].astype(int)
        out["probes"] = {}
        for name in self.probes:
            out["probes"][name] = {"u": values[:, start : start + 3]}
            start += 3
        barrier = self.integrator.barrier
        if barrier is not None:
            out["smallest_gap"] = values[:, start]
            names = list(barrier.surfaces.ranges)
            start += 1
            out["contact_force"] = {
                name: values[:, start + 3 * k : start + 3 * k + 3] for k, name in enumerate(names)
            }
        return out


def _lost(motion: Motion) -> float:
    """Energy that the material dissipated so far."""
    lost = getattr(motion.state.memory, "lost", None)
    return 0.0 if lost is None else float(lost.sum())


def balance(table: Mapping[str, Any]) -> float:
    """Change of momentum against impulse, as in the module's docstring."""
    change = table["momentum"] - table["momentum"][0]
    sizes = [np.linalg.norm(table[name], axis=1).max() for name in ("momentum", "impulse")]
    largest = max(*sizes, 1e-300)
    return float(np.linalg.norm(change - table["impulse"], axis=1).max() / largest)
