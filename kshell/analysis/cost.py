"""What a solve takes, told beforehand: memory and seconds, from figures measured per unknown.

Seconds and bytes of the assembly, of values and of estimates grow with the unknowns n, operations of the factors of a
surface with n^1.5 and their entries with n log n. The figures are processor seconds of one thread and the peak memory
of a linear solve with an estimate on regular grids of 3e4 to 3e5 unknowns (verification/scale.md), on a machine on
which the reference below takes REFERENCE seconds; on this one they are scaled by what it takes here. Expect them within
a factor of two on a machine that does nothing else.

Shells on one process have fronts, which are found from the pattern of their matrix, without a number in it: entries
and operations are counted, and only the rest is by figures. Expect seconds within a factor of 1.5 then, and memory
within a tenth.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np

from kshell.distributed.partition import share_of_first
from kshell.equilibrium.factor import Factoriser
from kshell.equilibrium.model import Model
from kshell.solvers.frontal import Fronts
from kshell.solvers.memory import available_bytes

# memory of kshell without any problem, of one process, and with PETSc
BASE, BASE_PETSC = 125e6, 120e6
# processor seconds of the reference on the machine of the figures
REFERENCE = 0.0042
# part of the operations of the factors that several processes do at once: the last fronts leave some waiting
EFFICIENT = 0.7
BYTES = 8.0


@dataclass(frozen=True)
class Figures:
    """Of one element, per unknown.

    Attributes
    ----------
    seconds : float
        Of everything but the factors.
    shared : float
        Seconds of that which is not divided: the first process does it alone.
    flops : float
        Of the factors, over n^1.5.
    entries : float
        Of the factors of 3e5 unknowns; `more` of them with each doubling of the unknowns.
    held : float
        Bytes beside the factors that are divided.
    copied : float
        Bytes of the whole, which the first process has alone: of shells while values are found, of plates all the time.
    left : float
        Of shells, bytes of what is divided that are there while values are found.
    """

    seconds: float
    shared: float
    flops: float
    entries: float
    more: float
    held: float
    copied: float
    left: float | None = None

    def beside_factors(self, unknowns: int, processes: int) -> float:
        """Bytes beside the factors, of the process that has most."""
        if self.left is None:
            of_all = self.copied if processes > 1 else 0.0
            return (of_all + self.held / processes) * unknowns
        first = share_of_first(processes)
        others = (1.0 - first) / max(processes - 1, 1)
        return max(self.copied + self.left * first, self.held * max(first, others)) * unknowns

    def factor_flops(self, unknowns: int) -> float:
        """Operations of the factors."""
        return self.flops * unknowns**1.5

    def factor_bytes(self, unknowns: int) -> float:
        """Bytes of the factors."""
        entries = self.entries + self.more * math.log2(max(unknowns, 1) / 3e5)
        return BYTES * unknowns * max(entries, 20.0)


@dataclass(frozen=True)
class Cost:
    """What a linear solve is expected to take.

    Attributes
    ----------
    processes : int
    seconds : float
    memory : float
        Bytes, of the process that takes most.
    """

    processes: int
    seconds: float
    memory: float


FIGURES = {
    ("koiter", 1): Figures(10e-6, 6.0e-6, 130.0, 140.0, 15.0, 1650.0, 1900.0, 1000.0),
    ("koiter", 2): Figures(9.6e-6, 4.0e-6, 150.0, 186.0, 15.0, 2100.0, 900.0, 1200.0),
    ("koiter", 3): Figures(11e-6, 2.5e-6, 200.0, 230.0, 17.0, 3400.0, 850.0, 2200.0),
    ("morley", 2): Figures(4.5e-6, 1.5e-6, 27.0, 75.0, 5.0, 900.0, 500.0),
    ("argyris", 5): Figures(13.5e-6, 3.0e-6, 240.0, 200.0, 13.0, 2300.0, 700.0),
}


@dataclass(frozen=True)
class Counted:
    """Of a shell whose fronts are counted, beside these.

    Attributes
    ----------
    seconds : float
        Per unknown.
    held : float
        Bytes per unknown.
    base : float
        Bytes of kshell, and of the triangles that are worked on at a time.
    """

    seconds: float
    held: float
    base: float

    def cost(self, unknowns: int, operations: float, numbers: float, speed: float = 1.0) -> Cost:
        """With the operations of the factor and its numbers, those of the stack among them."""
        seconds = (self.seconds * unknowns + operations / FRONT_FLOPS) / speed
        return Cost(1, seconds, self.base + self.held * unknowns + BYTES * numbers)


# of regular grids of 7e4 to 1e6 unknowns
COUNTED = {
    ("koiter", 1): Counted(13.5e-6, 1250.0, 150e6),
    ("koiter", 2): Counted(7.2e-6, 830.0, 150e6),
    ("koiter", 3): Counted(8.6e-6, 1560.0, 120e6),
}
FRONT_FLOPS = 3.3e10  # a second, with what the system takes to give memory
FLOPS = 1.5e10  # a second, of the factors, on the machine of the figures
LONGER = "; large deflections, modes and load cases take a multiple of these seconds"


def cost_of(
    model: Model, processes: int = 1, speed: float = 1.0, fronts: Fronts | None = None
) -> Cost | None:
    """What the linear solve of a model takes; None for elements without figures.

    Parameters
    ----------
    model : Model
    processes : int
        How many share it, by PETSc where more than one do.
    speed : float
        Of this machine, against that of the figures; see `speed_of_machine`.
    fronts : Fronts, optional
        Of its factor on one process, see `fronts_of_model`, where there are any.
    """
    known = FIGURES.get((model.element, model.order))
    if known is None:
        return None
    n, p = model.unknowns, processes
    if fronts is not None and p == 1:
        of_rest = COUNTED[model.element, model.order]
        return of_rest.cost(n, fronts.operations, fronts.entries + fronts.stacked, speed)
    factors = known.factor_flops(n) / FLOPS
    memory = known.beside_factors(n, p) + known.factor_bytes(n) / p
    if p == 1:
        return Cost(1, (known.seconds * n + factors) / speed, BASE + memory)
    seconds = known.shared * n + (known.seconds - known.shared) * n / p + factors / (p * EFFICIENT)
    return Cost(p, seconds / speed, BASE_PETSC + memory)


def fronts_of_model(model: Model) -> Fronts | None:
    """What the factor of a model on one process looks like; None where a library makes it, or there are no figures."""
    problem = getattr(model, "problem", None)
    if problem is None or model.kind != "shell" or (model.element, model.order) not in COUNTED:
        return None
    return Factoriser(problem.reduction, problem.energy).fronts()


def speed_of_machine() -> float:
    """How fast this machine is, against that of the figures: by products of small and of larger matrices."""
    rng = np.random.default_rng(0)
    small, large = rng.standard_normal((2000, 24, 24)), rng.standard_normal((400, 400))
    best = math.inf
    for _ in range(3):
        begin = time.process_time()
        _ = small @ small
        _ = large @ large
        best = min(best, time.process_time() - begin)
    return REFERENCE / max(best, 1e-6)


def cost_lines(model: Model, processes: tuple[int, ...] = (1, 2, 4, 16)) -> list[str]:
    """The cost in words: on this machine, and on several processes."""
    if (model.element, model.order) not in FIGURES:
        return [
            f"cost: {model.unknowns} unknowns; no figures were measured for the element {model.element} of order "
            f"{model.order}"
        ]
    speed, have = speed_of_machine(), available_bytes()
    fronts = fronts_of_model(model)
    costs = [cost_of(model, count, speed, fronts) for count in processes]
    near = "; on one process within a factor of 1.5 and memory within a tenth" if fronts is not None else ""
    lines = [f"cost of a linear solve with {model.unknowns} unknowns, within a factor of two{near}{LONGER}:"]
    for count, found in zip(processes, costs, strict=True):
        assert found is not None
        who = "one process" if count == 1 else f"{count} processes (mpiexec -n {count})"
        each = "" if count == 1 else " each at most"
        lines.append(f"  {who}: about {_size(found.memory)}{each}, {_time(found.seconds)}")
        if count == 1 and found.memory > have:
            lines[-1] += f"; {_size(have)} are available here, so it is likely not to fit"
    return lines


def _size(value: float) -> str:
    return f"{value / 1e9:.3g} GB" if value >= 1e9 else f"{round(value / 1e6, -1):.0f} MB"


def _time(seconds: float) -> str:
    if seconds < 1.0:
        return "less than a second"
    return f"{seconds:.2g} s" if seconds < 90 else f"{seconds / 60:.2g} min"
