"""Motion in time under finite deformation, by implicit steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.first_mode import first_frequency
from kshell.analysis.obstacles import barrier_of
from kshell.analysis.run import Run, described
from kshell.equilibrium.checkpoint import Store
from kshell.equilibrium.contact.barrier import Barrier
from kshell.equilibrium.model import NO_DENSITY, FiniteModel, Model
from kshell.equilibrium.motion import saved
from kshell.equilibrium.motion.history import Observer, balance
from kshell.equilibrium.motion.march import PER_PERIOD, Going, TimeSteps
from kshell.equilibrium.motion.state import Motion
from kshell.equilibrium.motion.steps import Integrator
from kshell.errors import InputError, Interrupted, SolveError
from kshell.mesh.select import select
from kshell.result.result import Result
from kshell.scene.loads import Gravity
from kshell.scene.motion import Damping
from kshell.scene.structure import Placed, Structure

Floats = NDArray[np.float64]

# times at which loads are looked at, for the stiffness of contact
LOOKS = 9
# times whose loads are kept: those of the ends and the middle of a step
KEPT = 4


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
    if not isinstance(model, FiniteModel):
        raise InputError(
            f'a {model.kind} with the element {model.element} does not move in time: model = "shell"'
        )
    with run.clock.stage("solve"):
        moving = Moving(model, run)
        film = _film(moving, run)
    with run.clock.stage("recover"):
        result = _answer(moving, film)
    solver = {
        "name": "direct",
        "why": f"every step is factorised; {moving.words}",
        "iterations": int(result.history["iterations"].sum()),
        "steps": film.going[-1].steps,
        "rejected": film.going[-1].rejected,
    }
    warmth = moving.at(film.going[-1].motion.time).warmth()
    described(result, model, run, [moving.words], solver, large=True, warmth=warmth)
    if film.failure is not None:
        film.failure.state = result
        raise film.failure
    return result


class Moving:
    """A model and its loads in time.

    Attributes
    ----------
    words : str
        How it is computed.
    """

    def __init__(self, model: FiniteModel, run: Run) -> None:
        options, scene = run.options, run.scene
        self.model, self.timed = model, run.structure
        self.ramp = options.ramp
        mass = model.full_mass()
        if not mass.diagonal().any():
            raise InputError(NO_DENSITY)
        self._starts_at_rest()
        self.frequency = first_frequency(model)
        damping = Damping() if scene.damping is None else scene.damping
        if damping.per_mode is not None:
            raise InputError(
                'damping: a ratio for every mode is for analysis = "response": a motion is damped by its material; '
                "give the ratio of the first mode, a number"
            )
        viscosity = damping.material(self.frequency)
        touching = scene.contact is not None
        scheme = options.scheme if options.scheme != "auto" else "bdf2" if touching else "alpha"
        if scheme == "em" and model.structure.section.inelastic():
            raise InputError(
                'scheme = "em" keeps energy, and a material that yields (hardening) or relaxes (relaxation) does not: '
                'take "alpha", "bdf2" or "euler"'
            )
        if viscosity and model.yields:
            raise InputError(
                "damping: ratio and viscosity are for materials that do not yield: take drag, or leave hardening out"
            )
        if touching and scheme == "em":
            raise InputError('scheme = "em" has no contact: take "alpha", "bdf2" or "euler"')
        self._equilibrium = lru_cache(KEPT)(lambda time: self.at(time).equilibrium())
        barrier, how = self._barrier(run, mass) if touching else (None, "")
        self.integrator = Integrator(self._equilibrium, mass, scheme, viscosity, damping.drag, barrier)
        fixed = options.step != "auto"
        step = options.step if fixed else 2.0 * np.pi / self.frequency / PER_PERIOD
        self.steps = TimeSteps(
            self.integrator, options.time, min(step, options.time), fixed or touching, self.frequency
        )
        self.words = (
            f"motion: scheme {scheme}, first step {self.steps.first:.4g}; the first mode has the period "
            f"{2.0 * np.pi / self.frequency:.6g}"
        )
        if viscosity:
            self.words += (
                f"; viscosity {viscosity:.4g}: damping ratio {0.5 * viscosity * self.frequency:.4g} of the first mode, "
                "of others in the ratio of their frequencies"
            )
        if touching:
            self.words += f"; {how}"
        self.velocity, self.displacement = scene.initial_velocity, scene.initial_displacement

    def _barrier(self, run: Run, mass: Any) -> tuple[Barrier, str]:
        """The barrier of contact."""
        contact, model = run.scene.contact, self.model
        assert contact is not None
        area = float(model.structure.space.areas.sum())
        speed = 0.0
        if run.scene.initial_velocity is not None:
            points = model.structure.space.points
            at = Gravity(run.scene.initial_velocity.value).at(points)
            speed = float(np.linalg.norm(at, axis=1).max())
        density = float(mass.sum()) / 3.0 / area
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

    def _starts_at_rest(self) -> None:
        given = self.at(0.0).equilibrium().reduction.given
        if np.any(given):
            raise InputError(
                "a prescribed motion is not zero at t = 0, so the structure would jump: let it begin at 0, with an "
                'expression in t such as "0.01*min(t/0.1, 1)", or with ramp'
            )

    def at(self, time: float) -> FiniteModel:
        """The model under the loads of a time."""
        factor = 1.0 if self.ramp is None else min(time / self.ramp, 1.0)
        now = self.timed.at_time(time)
        structure = replace(self.model.structure, loads=now.loads, supports=now.supports)
        if not self._changes and factor == 1.0:
            return self.model
        return self.model.loaded(structure, factor)

    @property
    def _changes(self) -> bool:
        every: list[Placed[Any]] = [*self.timed.loads, *self.timed.supports]
        return any(placed.depends_on_time for placed in every)

    def start(self) -> Motion:
        """The motion at the time 0."""
        momentum = None
        if self.velocity is not None:
            space, on = self.model.structure.space, self.velocity.on
            place = None if on is None else select(space, on, dimensions=(2,), what="initial velocity")
            # the load of an acceleration is the momentum of a velocity
            pushed: Structure = replace(
                self.model.structure, loads=(Placed(Gravity(self.velocity.value), place),)
            )
            momentum = self.model.loaded(pushed).equilibrium().load
        x = None
        if self.displacement is not None:
            place_of = Gravity(self.displacement.value)
            x = self.model.displaced(place_of.at)
        return self.integrator.start(momentum, x, self.steps.first)

    def observer(self) -> Observer:
        """What keeps the history."""
        model = self.model
        probes = {
            name: np.array([model.probe_row(name, axis) for axis in "xyz"]) for name in model.structure.probes
        }
        return Observer(self.integrator, model.rigid_motions, probes)

    def recover(self, motion: Motion, work: float) -> Result:
        """The result of a state, inertia and damping acting as loads."""
        mass = self.integrator.mass
        inertia = motion.contact - motion.damping - mass @ self.integrator.by_mass(motion.force)
        return self.at(motion.time).recover_state(replace(motion.state, factor=1.0), work, inertia)


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


def _film(moving: Moving, run: Run) -> Film:
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


def _resumed(store: Store, moving: Moving, film: Film) -> Going | None:
    """The last state written, with all before it taken up; None where there is none."""
    rows: list[Floats] = []
    going: Going | None = None
    for content in store.read_content():
        going, more = saved.read(content, moving.model.equilibrium().energy.rest)
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


def _fingerprint(moving: Moving, run: Run) -> str:
    """Tells motions apart: model, loads in time, and steps."""
    options, scene = run.options, run.scene
    way = (options.time, options.step, options.scheme, options.output, options.ramp)
    given: tuple[Any, ...] = (scene.contact, scene.obstacles, scene.cuts)
    given += (scene.loads, scene.supports, scene.initial_velocity, scene.initial_displacement, scene.damping)
    return f"{moving.model.fingerprint()} {moving.integrator.mass.sum()!r} {way} {given}"


def _answer(moving: Moving, film: Film) -> Result:
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
    result.warnings += _doubts(moving, table)
    return result


def _doubts(moving: Moving, table: dict[str, Any]) -> list[str]:
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
