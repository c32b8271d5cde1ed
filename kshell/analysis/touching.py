"""A shell at rest that touches itself and obstacles: loads grow and obstacles move while t goes from 0 to 1."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.obstacles import barrier_of
from kshell.analysis.run import Run, described
from kshell.equilibrium.contact.barrier import Barrier
from kshell.equilibrium.contact.rest import Lost, come_to_rest
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.model import Model
from kshell.equilibrium.problem import Problem, State
from kshell.errors import InputError, Interrupted, SolveError
from kshell.result.result import Result

Floats = NDArray[np.float64]

# times at which loads and obstacles are looked at, for the stiffness of contact
LOOKS = 5
# steps where something moves to a place, and otherwise; how small a step may get
MOVING, STILL, SMALLEST = 10, 1, 1.0 / 64.0
# part by which a step grows after one that had an answer
GROWTH = 1.5


def analyse(model: Model, run: Run) -> Result:
    """The state of rest, with the forces on obstacles, step by step.

    Raises
    ------
    InputError
        If options do not fit, or surfaces cross at the start.
    SolveError
        If there is no rest; its `state` is the result of the last step that had one.
    Interrupted
        If the user stopped it; its `state` as above.
    """
    if run.scene.cases:
        raise InputError(
            "contact has one set of loads: what touches depends on all of them; leave the cases out, or take one of "
            "them, ks.solve(scene.of_case(name))"
        )
    if not isinstance(model, FiniteModel):
        raise InputError(f'contact is that of a shell: a {model.kind} has none, take model = "shell"')
    with run.clock.stage("solve"):
        resting = Resting(model, run)
        rests = resting.grow()
    with run.clock.stage("recover"):
        result = resting.answer(rests)
    solver: dict[str, Any] = {"name": "direct", "why": f"shells are factorised; {resting.words}"}
    solver |= {"iterations": rests.iterations, "steps": len(rests.states) - 1}
    described(
        result,
        model,
        run,
        ["large deflections: contact", resting.words],
        solver,
        large=True,
        warmth=model.warmth(),
    )
    if rests.failure is not None:
        rests.failure.state = result
        raise rests.failure
    return result


@dataclass
class Rests:
    """States of rest from t = 0 on.

    Attributes
    ----------
    times : list of float
    states : list of State
        At the factor 1 of the loads at their times, but for the first.
    contact : list of (unknowns,)
        Forces on the shell.
    rows : list of dict
        Energies, gap and forces on obstacles.
    failure : SolveError or Interrupted, optional
        Why the last is not that at t = 1.
    """

    times: list[float] = field(default_factory=list)
    states: list[State] = field(default_factory=list)
    contact: list[Floats] = field(default_factory=list)
    rows: list[dict[str, Any]] = field(default_factory=list)
    failure: SolveError | Interrupted | None = None

    @property
    def iterations(self) -> int:
        """Of all steps."""
        return sum(state.iterations for state in self.states)


class Resting:
    """A model that comes to rest under loads that grow with t from 0 to 1.

    Attributes
    ----------
    words : str
        How it is computed.
    """

    def __init__(self, model: FiniteModel, run: Run) -> None:
        self.model, self.run = model, run
        end = model.equilibrium()
        obstacles = run.scene.obstacles
        moves = bool(np.any(end.reduction.given)) or any(one.motion is not None for one in obstacles)
        steps = run.options.steps
        self.first = 1.0 / (steps if steps != "auto" else MOVING if moves else STILL)
        self.barrier: Barrier
        self.barrier, how = barrier_of(
            run.scene.contact,
            obstacles,
            model.contact_surface(),
            model.thickness,
            self.at,
            np.linspace(0.0, 1.0, LOOKS).tolist(),
            0.0,
            resistance(model, self._way(obstacles)) if moves else 0.0,
        )
        self.words = f"to rest while t goes from 0 to 1, loads in proportion; {how}"

    def _way(self, obstacles: Any) -> Floats:
        """(3,) the longest way of an obstacle, of the supports if none moves."""
        ways = [one.displacement(1.0) - one.displacement(0.0) for one in obstacles]
        longest = max(ways, key=lambda way: float(np.linalg.norm(way)), default=np.zeros(3))
        if np.any(longest):
            return np.asarray(longest)
        points, _ = self.model.contact_surface()
        given = self.model.equilibrium().reduction.given[: points.size].reshape(-1, 3)
        return np.asarray(given[np.argmax(np.linalg.norm(given, axis=1))])

    def at(self, time: float) -> Problem:
        """The equilibrium under the loads and prescribed motions of a time, all at the factor 1."""
        return self.model.loaded(self.model.structure, time).equilibrium()

    def grow(self) -> Rests:
        """All states of rest."""
        rests, size = Rests(), self.first
        start = self.at(0.0)
        self.barrier.begin(start.start().x, 0.0, 0.0, slip=self.barrier.touch.speed)
        self._keep(rests, 0.0, start, replace(start.start(), factor=1.0), None)
        try:
            while rests.times[-1] < 1.0:
                size = self._step(rests, size)
        except SolveError as error:
            rests.failure = SolveError(
                f"no rest beyond t = {rests.times[-1]:.6g}, the part of the loads and of the ways of obstacles: "
                f"{error}; the states up to there are kept"
            )
        except KeyboardInterrupt:
            rests.failure = Interrupted(f"interrupted at t = {rests.times[-1]:.6g}")
        return rests

    def _step(self, rests: Rests, size: float) -> float:
        """Another state of rest; how long the next step may be."""
        before, last = rests.times[-1], rests.states[-1]
        while True:
            left = 1.0 - before
            time = 1.0 if size >= left * (1.0 - 1e-9) else before + size
            problem = self.at(time)
            given = problem.reduction.given - self.at(before).reduction.given
            growing = replace(problem, reduction=problem.reduction._replace(given=given, following=None))
            try:
                found = come_to_rest(
                    growing, self.barrier, replace(last, factor=0.0), (before, time), self.run.tell
                )
            except Lost:
                raise
            except SolveError:
                size *= 0.5
                if size < SMALLEST * self.first:
                    raise
                continue
            self._keep(rests, time, problem, found, last)
            self.run.tell(f"solve: at rest at t = {time:.4g}, {found.iterations} iterations")
            return min(GROWTH * size, self.first)

    def _keep(self, rests: Rests, time: float, problem: Problem, state: State, before: State | None) -> None:
        energy = problem.energy.energy(state.x, 1, state.memory, None, problem.initial)
        acting, stored = energy.gradient, energy.value
        if problem.springs is not None:
            pull = problem.springs @ state.x
            acting, stored = acting + pull, stored + 0.5 * float(state.x @ pull)
        contact = -self.barrier.gradient(state.x)
        acting = acting - contact  # loads and reactions
        work, pressing = 0.0, self.barrier.on_obstacles(state.x)
        if before is not None:
            last = rests.rows[-1]
            moved = (state.x + state.turned) - (before.x + before.turned)
            work = last["external_work"] + 0.5 * float((last["acting"] + acting) @ moved)
            work += self.barrier.work(last["contact_force"], pressing, rests.times[-1], time)
        row = {"strain_energy": stored, "external_work": work, "acting": acting}
        row |= {"smallest_gap": self.barrier.gap(state.x), "contact_force": pressing}
        rests.times.append(time)
        rests.states.append(state)
        rests.contact.append(contact)
        rests.rows.append(row)

    def answer(self, rests: Rests) -> Result:
        """The result of the last state, with those before."""
        makers = [
            partial(self._recover, time, state, row["external_work"], contact)
            for time, state, row, contact in zip(
                rests.times, rests.states, rests.rows, rests.contact, strict=True
            )
        ]
        result = makers[-1]()
        result.series = list(zip(rests.times, makers, strict=True))
        result.history = self._history(rests)
        still = "there is no load"  # obstacles that move are one
        result.warnings = [words for words in result.warnings if not words.startswith(still)]
        return result

    def _recover(self, time: float, state: State, work: float, contact: Floats) -> Result:
        return self.model.loaded(self.model.structure, time).recover_state(state, work, contact)

    def _history(self, rests: Rests) -> dict[str, Any]:
        rows = rests.rows
        out: dict[str, Any] = {"time": np.array(rests.times)}
        out |= {
            name: np.array([row[name] for row in rows])
            for name in ("strain_energy", "external_work", "smallest_gap")
        }
        out["iterations"] = np.array([state.iterations for state in rests.states])
        out["contact_force"] = {
            name: np.array([row["contact_force"][name] for row in rows]) for name in rows[0]["contact_force"]
        }
        out["probes"] = {}
        for name in self.model.structure.probes:
            axes = [self.model.probe_row(name, axis) for axis in "xyz"]
            out["probes"][name] = {
                "u": np.array([[axis @ state.x for axis in axes] for state in rests.states])
            }
        return out


def resistance(model: FiniteModel, way: Floats) -> float:
    """Pressure per displacement of a shell pushed evenly along a way (3,), or bent, if nothing holds it."""
    points, faces = model.contact_surface()
    sides = points[faces]
    area = 0.5 * float(
        np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1).sum()
    )
    problem = model.equilibrium()
    weights = problem.energy.translation_weights()
    along = np.zeros(problem.energy.unknowns)
    along[: points.size] = np.tile(way / max(float(np.linalg.norm(way)), 1e-300), len(points))
    push = weights * along  # a force of 1 in all
    try:
        stiffness = problem.energy.linear_stiffness()
        if problem.springs is not None:
            stiffness = (stiffness + problem.springs).tocsr()
        basis = problem.reduction.basis
        found = float(push @ (basis @ problem.factorise(stiffness).solve(basis.T @ push)))
    except SolveError:
        found = 0.0
    elastic: Any = problem.energy  # of the Koiter element, the only one that touches
    bent = elastic.section.bending.max() / area**2
    return max(1.0 / (found * area), bent) if np.isfinite(found) and found > 0.0 else float(bent)
