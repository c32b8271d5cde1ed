"""Newton's method on thin strips, plain and with extrapolated stress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from kshell.equilibrium.newton import DIVERGED, FINISHED, correct
from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError
from kshell.shell.koiter import loads
from kshell.shell.section import Section
from verification.failures.bent import rectangle
from verification.failures.failure import Failure, Numbers, columns, lines, panels
from verification.failures.shells import ShellModel

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from scipy.sparse import csr_matrix

    from kshell.solvers.repeated import Factor

Corrector = Callable[[Problem, State, float], State]

RATIOS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)  # t / L
LENGTH = 10.0
BENDING = 100.0  # E I
MOST_ITERATIONS = 50
SMALLEST = 1.0 / 256.0  # step, as a part of the load


@dataclass(frozen=True)
class Counted(Problem):
    """A problem that notes its factorisations, by the number of entries."""

    factors: list[int] = field(default_factory=list)

    def factorise(self, tangent: csr_matrix, definite: bool = True) -> Factor:
        self.factors.append(tangent.nnz)
        return super().factorise(tangent, definite)


def plain(problem: Problem, state: State, factor: float) -> State:
    """Newton's method as in textbooks, with the stopping rules of `kshell.equilibrium.newton`."""
    basis, x, first = problem.reduction.basis, state.x, 0.0
    for iteration in range(1, MOST_ITERATIONS + 1):
        energy, residual, growth = problem.evaluate(x, factor, 2, state.memory)
        reduced = basis.T @ residual
        tangent = problem.factorise(energy.hessian)
        step = tangent.solve(reduced)
        work = abs(float(reduced @ step))
        x = x + basis @ step
        scale = abs(energy.value) + abs(factor * float(growth @ x))
        if iteration > 1 and work <= FINISHED * scale:
            return problem.settle(State(factor, x, state.memory, iteration, tangent.negative))
        if not np.isfinite(work) or (iteration > 2 and work > DIVERGED * first):
            break
        first = max(first, work)
    raise SolveError(f"no equilibrium at the load factor {factor:g}", state=state)


def strip(ratio: float, load: str) -> Counted:
    """A clamped strip of constant bending stiffness under an end force 4 E I / L^2, or the moment of a quarter turn."""
    t = ratio * LENGTH
    mesh = rectangle(8, 1, (LENGTH, 1.0), "alternating")
    model = ShellModel(mesh, 2, Section.isotropic(12 * BENDING / t**3, 0.0, t))
    model.supports.clamp(model.edges(0, 0.0))
    end = model.edges(0, LENGTH)
    if load == "force":
        forces = loads.line_force(model.surface, [0, 0, 4 * BENDING / LENGTH**2], end)
    else:
        forces = loads.edge_moment(model.surface, -0.5 * np.pi * BENDING / LENGTH, end)
    return Counted(model.koiter, model.supports.reduction(), forces)


def work_of(problem: Counted, corrector: Corrector) -> tuple[int, float]:
    """Steps and factorisations up to the full load, failed ones included; NaN where steps become too small."""
    state, size, steps = problem.start(), 1.0, 0
    while state.factor < 1.0 - 1e-12:
        try:
            state = corrector(problem, state, min(1.0, state.factor + size))
            steps += 1
        except SolveError:
            size *= 0.5
            if size < SMALLEST:
                return steps, np.nan
    return steps, float(len(problem.factors))


def measure(quick: bool) -> Numbers:
    """Load steps and factorisations, beginning with the whole load in one step."""
    rows = []
    for ratio in RATIOS[1::2] if quick else RATIOS:
        row = {"t / L": ratio}
        for load in ("force", "moment"):
            for name, corrector in (("plain", plain), ("kshell", correct)):
                steps, factors = work_of(strip(ratio, load), corrector)
                row |= {f"{load}, {name}: steps": float(steps), f"{load}, {name}: factorisations": factors}
        rows.append(row)
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """Factorisations against thickness."""
    figure, (axes,) = panels(height=4.2)
    names = [name for name in numbers if name.endswith("factorisations")]
    lines(axes, {name.removesuffix(": factorisations"): numbers[name] for name in names} | {"t / L": numbers["t / L"]},
          "t / L", [name.removesuffix(": factorisations") for name in names])  # fmt: skip
    axes.invert_xaxis()
    axes.set(
        xlabel="t / L", ylabel="factorisations up to the full load", title="Cantilever strip bent by its end"
    )
    return figure


FAILURE = Failure(
    "newton",
    "Newton's method on thin strips",
    "A cantilever of constant bending stiffness takes an end force 4 E I / L^2, or the moment of a quarter turn. "
    "Plain Newton iterations leave the shape of bending without stretching by a little, and there the membrane "
    "stress, proportional to 1 / t^2, is huge and wrong in the tangent: the thinner the strip, the more "
    "iterations and the more often the step has to be halved, from 16 factorisations at t / L = 1e-2 to hundreds "
    "at 1e-5.",
    "The stress in the tangent is extrapolated linearly from the last iterate, as an unknown of its own "
    "(Magisano, Leonetti and Garcea 2017), while the residual keeps the true stress. The whole load is one step "
    "of 7 or 8 factorisations at every thickness.",
    measure,
    draw,
)
