"""Motion in time, by implicit steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.moving import Moving
from kshell.analysis.run import Run, described
from kshell.equilibrium.checkpoint import Store
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.model import Model
from kshell.equilibrium.motion import saved
from kshell.equilibrium.motion.history import Observer, balance
from kshell.equilibrium.motion.march import Going
from kshell.equilibrium.moving_model import MovingModel
from kshell.errors import InputError, Interrupted, SolveError
from kshell.result.result import Result

Floats = NDArray[np.float64]


def analyse(model: Model, run: Run) -> Result:
    """The motion from rest, or from an initial velocity, up to the end.

    Raises
    ------
    InputError
        If there is no mass, or options do not fit.
    SolveError
        If the motion cannot go on; its `state` is the result of the last good step.
    Interrupted
        If the user stopped it; its `state` as above.
    """
    options = run.options
    if options.time is None:
        raise InputError(
            'time is missing: analysis = "dynamic" needs the end of the motion, such as time = 1.0'
        )
    with run.clock.stage("solve"):
        moving = _moving(model, run)
        film = _film(moving, run)
    with run.clock.stage("recover"):
        result = _answer(moving, film)
    solver = {
        "name": "direct",
        "why": moving.solver_words,
        "iterations": int(result.history["iterations"].sum()),
        "steps": film.going[-1].steps,
        "rejected": film.going[-1].rejected,
    }
    warmth = moving.at(film.going[-1].motion.time).warmth()
    described(result, model, run, [moving.words], solver, large=moving.large, warmth=warmth)
    if film.failure is not None:
        film.failure.state = result
        raise film.failure
    return result


def _moving(model: Model, run: Run) -> Moving[Any]:
    """The motion of a model, by large deflections where it has them and small ones are not asked for."""
    if isinstance(model, FiniteModel) and run.options.large_deflection is not False:
        from kshell.analysis.moving_large import LargeMotion

        return LargeMotion(model, run)
    if isinstance(model, MovingModel):
        from kshell.analysis.moving_small import SmallMotion

        return SmallMotion(model, run)
    raise InputError(
        f"a {model.kind} with the element {model.element} does not move in time: its moments and inner deflections are "
        'eliminated triangle by triangle, and it has no mass matrix; take element = "argyris" or "morley", or '
        'model = "shell"'
    )


@dataclass
class Film:
    """The states kept of a motion, and its history.

    Attributes
    ----------
    going : list of Going
    places : list of int
        Row of the history of each.
    observer : Observer
    failure : SolveError or Interrupted, optional
    """

    observer: Observer
    going: list[Going] = field(default_factory=list)
    places: list[int] = field(default_factory=list)
    failure: SolveError | Interrupted | None = None

    def keep(self, going: Going) -> None:
        """Another state, whose row is the last."""
        self.going.append(going)
        self.places.append(len(self.observer.rows) - 1)


def _film(moving: Moving[Any], run: Run) -> Film:
    """The motion, step by step."""
    options, steps = run.options, moving.steps
    film = Film(moving.observer())
    store = None if run.folder is None else Store(run.folder, _fingerprint(moving, run))
    going: Going | None = None
    if store is not None and run.resume:
        going = _resumed(store, moving, film)
    elif store is not None:
        store.clear()
    if going is None:
        going = steps.begin(moving.start())
        film.observer.see(going.motion)
        film.keep(going)
        _write(store, film)
    try:
        while not steps.ended(going):
            before = going.motion.time
            going = steps.go_on(going)
            film.observer.see(going.motion)
            due = np.floor(going.motion.time / options.time * options.output + 1e-9)
            if due > np.floor(before / options.time * options.output + 1e-9) or steps.ended(going):
                film.keep(going)
                _write(store, film)
            run.tell(_words(going, film))
    except SolveError as error:
        film.failure = SolveError(f"{error}; the states up to there are kept")
    except KeyboardInterrupt:
        film.failure = Interrupted(f"interrupted at t = {going.motion.time:.6g}")
    if film.failure is not None and film.places[-1] != len(film.observer.rows) - 1:
        film.keep(going)
    return film


def _write(store: Store | None, film: Film) -> None:
    if store is None:
        return
    begin = film.places[-2] + 1 if len(film.places) > 1 else 0
    saved.write(store, len(film.places), film.going[-1], film.observer.rows[begin:])


def _resumed(store: Store, moving: Moving[Any], film: Film) -> Going | None:
    """The last state written, with all before it taken up; None where there is none."""
    rows: list[Floats] = []
    going: Going | None = None
    for content in store.read_content():
        going, more = saved.read(content, moving.rest)
        rows += list(more)
        film.going.append(going)
        film.places.append(len(rows) - 1)
    if going is not None:
        film.observer.go_on(np.array(rows), going.motion)
    return going


def _words(going: Going, film: Film) -> str:
    row = film.observer.rows[-1]
    return (
        f"solve: t = {going.motion.time:.4g}, step {going.steps}, {going.motion.state.iterations} iterations, "
        f"kinetic energy {row[1]:.3g}, strain energy {row[2]:.3g}"
    )


def _fingerprint(moving: Moving[Any], run: Run) -> str:
    """Tells motions apart: model, loads in time, and steps."""
    options, scene = run.options, run.scene
    way = (options.time, options.step, options.scheme, options.output, options.ramp)
    given: tuple[Any, ...] = (scene.contact, scene.obstacles, scene.cuts)
    given += (scene.loads, scene.supports, scene.initial_velocity, scene.initial_displacement, scene.damping)
    return f"{moving.model.fingerprint()} {moving.integrator.mass.sum()!r} {way} {given} {moving.large}"


def _answer(moving: Moving[Any], film: Film) -> Result:
    """The result of the last state, with the history and the states before."""
    table = film.observer.table()
    works = table["external_work"]
    makers: list[Callable[[], Result]] = [
        partial(moving.recover, going.motion, float(works[place]))
        for going, place in zip(film.going, film.places, strict=True)
    ]
    result = makers[-1]()
    result.series = [(going.motion.time, make) for going, make in zip(film.going, makers, strict=True)]
    result.history = table
    result.balance = balance(table)
    result.warnings = [words for words in result.warnings if not words.startswith("there is no load")]
    result.warnings += moving.doubts([going.motion for going in film.going]) + _doubts(moving, table)
    return result


def _doubts(moving: Moving[Any], table: dict[str, Any]) -> list[str]:
    """What the history shows that a user should know."""
    out = []
    gained = table["kinetic_energy"] + table["strain_energy"] + table["dissipated_energy"]
    gained = gained - gained[0] - table["external_work"]
    largest = max(float(np.abs(table[name]).max()) for name in ("kinetic_energy", "strain_energy"))
    touching = moving.integrator.barrier is not None
    if largest > 0.0 and gained.max() > (GAINED_IN_CONTACT if touching else GAINED) * largest:
        better = "bdf2" if touching else "em"
        where = "" if touching else " where the structure turns far"
        out.append(
            f"the steps added energy, {gained.max() / largest:.1e} of the largest on the way: take shorter steps, or "
            f'scheme = "{better}"{where}'
        )
    return out


# energy that steps may add without a word; with contact some is in the barrier
GAINED, GAINED_IN_CONTACT = 0.02, 0.1
