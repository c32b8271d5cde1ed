"""Large deflections of a scene: whether they matter, and the loads grown from zero to their full size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np

from kshell.equilibrium.checkpoint import Checkpoints
from kshell.equilibrium.controlled import ControlledSteps
from kshell.equilibrium.linear import LinearSolution
from kshell.equilibrium.load_steps import Limits, LoadSteps, March, stuck
from kshell.equilibrium.path import Critical
from kshell.equilibrium.problem import State
from kshell.errors import InputError, Interrupted, SolveError
from kshell.scene.options import TOLERANCE, SolveOptions
from kshell.shell.problem import ShellProblem
from kshell.values.naming import listing, suggestion


@dataclass(frozen=True)
class Indicator:
    """What large deflections would change about a linear solution.

    Attributes
    ----------
    change : float
        First correction of Newton's method from the linear solution, root mean square over the nodes, relative;
        infinite where the tangent there is singular.
    energy : float
        Energy of the true strains of the linear solution, relative to that of its linear strains.
    negative : int
        Negative eigenvalues of the tangent there: where there are any, the linear solution is not stable.
    tolerance : float
        Change from which large deflections matter.
    """

    change: float
    energy: float
    negative: int = 0
    tolerance: float = TOLERANCE

    @property
    def matters(self) -> bool:
        """Whether the linear solution will not do."""
        return self.negative > 0 or not self.change <= self.tolerance

    def words(self) -> str:
        """For the reasons of the model."""
        limit = f"{100 * self.tolerance:g} %"
        energy = f"the true strains of the linear solution store {self.energy:.3g} times the energy of its linear ones"
        if not np.isfinite(self.change):
            return "large deflections: the tangent stiffness at the linear solution is singular"
        change = f"the displacements by {100 * self.change:.2g} %"
        if self.negative:
            return (
                f"large deflections: the linear solution is unstable ({self.negative} negative eigenvalues of the "
                f"tangent stiffness), the first correction changes {change}; {energy}"
            )
        if self.matters:
            return f"large deflections: they change {change}, more than the tolerance of {limit}; {energy}"
        return f"linear: large deflections change {change}, within the tolerance of {limit}; {energy}"


def indicate(problem: ShellProblem, solution: LinearSolution, tolerance: float = TOLERANCE) -> Indicator:
    """Evaluate the true residual of a linear solution, and correct it once.

    The correction keeps the linear stress in its tangent, as newton.py does: the true stress of the linear
    displacements, which stretches where the shell only turns, would call every cantilever stiff.
    """
    equilibrium = problem.equilibrium()
    weights = np.sqrt(problem.energy.translation_weights())
    size = float(np.linalg.norm(weights * solution.x))
    if size == 0.0:
        return Indicator(0.0, 1.0, 0, tolerance)
    try:
        energy, residual, _ = equilibrium.evaluate(solution.x, 1.0, 2, problem.energy.rest, solution.stress)
        basis = equilibrium.reduction.basis
        tangent = equilibrium.factorise(energy.hessian)
        step = basis @ tangent.solve(basis.T @ residual)
    except SolveError:
        return Indicator(np.inf, np.inf, 0, tolerance)
    strain = problem.energy.linear_strain(solution.x)
    linear = 0.5 * float(np.sum(strain * problem.energy.stress(strain)))
    true = energy.value / linear if linear > 0.0 else 1.0
    return Indicator(float(np.linalg.norm(weights * step)) / size, true, tangent.negative, tolerance)


@dataclass
class Trace:
    """The states of a growing load.

    Attributes
    ----------
    states : list of State
        From rest on.
    critical : list of (int, Critical)
        Each with the number of the state that came after it.
    failure : SolveError or Interrupted, optional
        Why the load is not at its full size.
    """

    states: list[State]
    critical: list[tuple[int, Critical]] = field(default_factory=list)
    failure: SolveError | Interrupted | None = None

    @property
    def iterations(self) -> int:
        """Of all steps."""
        return sum(state.iterations for state in self.states)


class Marching(Protocol):
    """Steps along a path: of the load, or of a displacement."""

    def begin(self, state: State) -> March:
        """The march from a state."""

    def ended(self, march: March) -> bool:
        """Whether the path is complete."""

    def go_on(self, march: March) -> tuple[March, Critical | None]:
        """The next state, and the critical point passed on the way; SolveError if there is none."""


def marching_of(problem: ShellProblem, options: SolveOptions) -> Marching:
    """How the options want the path to be followed.

    Raises
    ------
    InputError
        If the probe to be controlled does not exist, or does not move.
    """
    path = options.analysis == "path"
    steps = options.steps if options.steps != "auto" else (10 if path else 1)
    if options.control is None:
        limits: Limits = "follow" if path else "jump"
        section = problem.energy.section
        thickness = float(np.sqrt(12.0 * np.abs(section.bending).max() / np.abs(section.membrane).max()))
        return LoadSteps(
            problem.equilibrium(), steps, limits=limits, branch=options.branch, aside=0.5 * thickness
        )
    name, letter = options.control.probe, options.control.component
    if name not in problem.scene.probes:
        hint = suggestion(name, problem.scene.probes)
        raise InputError(f'control: no probe "{name}": {hint}the probes are {listing(problem.scene.probes)}')
    found = problem.locator.find(np.array([problem.scene.probes[name]], dtype=float))
    axis = "xyz".index(letter)
    row = problem.discretisation.translation_row(int(found.triangles[0]), found.xi[0], axis)
    if not np.any(problem.reduction.basis.T @ row) and row @ problem.reduction.given == 0.0:
        raise InputError(
            f'control: the supports hold probe "{name}" along {letter}: control another displacement'
        )
    return ControlledSteps(problem.equilibrium(), row, options.control.to, steps)


def grow_load(
    problem: ShellProblem,
    options: SolveOptions,
    progress: Callable[[str], None] | None = None,
    folder: Path | None = None,
    resume: bool = False,
) -> Trace:
    """Grow the loads to their full size, or a displacement to its last value.

    Parameters
    ----------
    options : SolveOptions
    progress : function, optional
        Called with words after each step.
    folder : Path, optional
        Where each converged step is written.
    resume : bool
        Go on after the last step in the folder.

    Raises
    ------
    InputError
        If the folder cannot be written, or what it holds is of another problem.
    """
    equilibrium = problem.equilibrium()
    marching = marching_of(problem, options)
    march = marching.begin(equilibrium.start())
    trace = Trace([march.state])
    saved = None if folder is None else Checkpoints(folder, _fingerprint(problem, options))
    if saved is not None:
        for march, critical in saved.read(problem.energy.rest) if resume else saved.clear():
            _add(trace, march, critical)
    try:
        while not marching.ended(march):
            march, critical = marching.go_on(march)
            _add(trace, march, critical)
            if saved is not None:
                saved.write(len(trace.states) - 1, march, critical)
            if progress is not None:
                progress(_words(trace, march))
    except SolveError as error:
        way = options.control is None
        trace.failure = stuck(trace.states, str(error), None) if way else SolveError(str(error))
    except KeyboardInterrupt:
        trace.failure = Interrupted(f"interrupted at the load factor {trace.states[-1].factor:.6g}")
    return trace


def _add(trace: Trace, march: March, critical: Critical | None) -> None:
    trace.states.append(march.state)
    if critical is not None:
        trace.critical.append((len(trace.states) - 1, critical))


def _words(trace: Trace, march: March) -> str:
    state = march.state
    after = f"next step {march.size:.3g}" if march.crossing is None else "through a limit point"
    return (
        f"solve: load factor {state.factor:.4g}, step {len(trace.states) - 1}, {state.iterations} iterations, "
        f"{after}"
    )


def _fingerprint(problem: ShellProblem, options: SolveOptions) -> str:
    """Tells problems apart: supports, loads, stiffness and steps."""
    import hashlib

    way = (options.analysis, options.steps, options.control, options.branch)
    digest = hashlib.sha256(f"{problem.choice.element} {problem.choice.order} {way}".encode())
    basis = problem.reduction.basis.tocsc()
    arrays = [problem.space.points, problem.space.triangles, problem.load, problem.reduction.given]
    arrays += [basis.indptr, basis.indices, basis.data, problem.energy.stiffness]
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
