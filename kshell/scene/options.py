"""How to solve: the keys of [solve] in a scene file and the options of `kshell.solve`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.values import kinds
from kshell.values.validation import Number, described

# change of the displacements from which large deflections matter
TOLERANCE = 0.01
LOOKS = 16  # at about so many times loads that move are looked at


def _large(value: Any) -> Any:
    if value is not True and value is not False and value != "auto":
        raise ValueError('must be "auto", true or false')
    return value


def _steps(value: Any) -> Any:
    if value != "auto" and (isinstance(value, bool) or not isinstance(value, int) or value < 1):
        raise ValueError('must be "auto" or a whole number > 0')
    return value


@described("control")
class Control:
    """A displacement that is prescribed along a path; the load factor is what it takes.

    Attributes
    ----------
    probe : str
        Name of a probe of the scene.
    component : "x", "y" or "z"
    to : float [length]
        Last value of this component of its displacement.
    """

    probe: str
    component: Literal["x", "y", "z"]
    to: Number

    def __post_init__(self) -> None:
        if self.to == 0.0:
            raise InputError("control: to = 0 goes nowhere: give the last displacement of the probe")


CONTROL = kinds.table(probe=kinds.TEXT, component={"enum": ["x", "y", "z"]}, to=kinds.NUMBER)


def _control(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Control(**value)
    if value is not None and not isinstance(value, Control):
        raise ValueError('must be a table such as {probe = "tip", component = "z", to = -0.1}')
    return value


def as_tolerance(value: Any) -> Any:
    """A relative tolerance from a number, or from words such as "1%"."""
    if value is None:
        return None
    wanted = 'must be a number between 0 and 1, such as 0.01, or a percentage, such as "1%"'
    number = value
    if isinstance(value, str):
        text = value.strip()
        try:
            number = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
        except ValueError:
            raise ValueError(wanted) from None
    if isinstance(number, bool) or not isinstance(number, (int, float)) or not 0.0 < number < 1.0:
        raise ValueError(wanted)
    return float(number)


SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0}
BYTES = {"kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}


def _limit(value: Any) -> Any:
    """A time or a size of memory, as text; see `SolveOptions.time_limit`."""
    if value is None:
        return None
    units = {**SECONDS, **BYTES}
    found = (
        re.fullmatch(r"\s*([0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([A-Za-z]+)\s*", value)
        if isinstance(value, str)
        else None
    )
    try:
        number = 0.0 if found is None else float(found[1])
    except ValueError:
        number = 0.0
    if found is None or found[2] not in units or not 0.0 < number < float("inf"):
        raise ValueError(
            f'must be a time or a size of memory such as "60 s" or "4 GB"; units: {", ".join(units)}'
        )
    return f"{number:g} {found[2]}"


def _quantity(value: Any) -> Any:
    if value is not None and (not isinstance(value, str) or not value):
        raise ValueError('must be "energy", "probes" or the name of a probe')
    return value


def _branch(value: Any) -> Any:
    if isinstance(value, bool) or value not in (-1, 0, 1):
        raise ValueError(
            "must be 0 (stay on the path), 1 or -1 (leave it along the critical mode, or against it)"
        )
    return value


def _count(value: Any) -> Any:
    if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 1):
        raise ValueError("must be a whole number > 0")
    return value


def _duration(value: Any) -> Any:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < float("inf"):
        raise ValueError("must be a number > 0")
    return float(value)


Duration = Annotated[Any, BeforeValidator(_duration), WithJsonSchema(kinds.POSITIVE)]


def _time_step(value: Any) -> Any:
    return value if value == "auto" else _duration(value)


def _output(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise ValueError("must be a whole number > 0")
    return value


def _prestress(value: Any) -> Any:
    if isinstance(value, bool):
        return float(value)
    if not isinstance(value, int | float) or not 0.0 <= value < float("inf"):
        raise ValueError("must be true, false, or a load factor > 0")
    return float(value)


def _range(value: Any) -> Any:
    if value is None:
        return None
    pair = tuple(value) if isinstance(value, list | tuple) else ()
    plain = all(isinstance(f, int | float) and not isinstance(f, bool) for f in pair)
    if len(pair) != 2 or not plain or not 0 <= pair[0] < pair[1] < float("inf"):
        raise ValueError("must be two frequencies that rise, such as [0, 100]")
    return float(pair[0]), float(pair[1])


MOVED = {
    "damping": "it stands in a block of its own, for motions and responses alike: [damping] with ratio = 0.02, in "
    'Python ks.Scene(..., damping={"ratio": 0.02})'
}


@described("[solve]", MOVED)
class SolveOptions:
    """Options of a solve.

    Attributes
    ----------
    analysis : "static", "path", "modes", "buckling", "response" or "dynamic"
        Deflection under the loads, or under loads that grow from zero with a factor, through limit points; natural
        frequencies; factors by which loads may grow before the structure buckles; steady vibration under harmonic
        loads; motion in time.
    model : "auto", "plate" or "shell"
        The Kirchhoff plate in bending, or the Koiter shell: bending and stretching together.
    element : "auto", "morley", "argyris", "hhj" or "koiter"
        Morley: quadratic plates, cheap. Argyris: of degree five, plates and charts, accurate where the solution
        is smooth. HHJ: plates, of any order, moments in equilibrium. Koiter: shells on any surface, and flat ones;
        with model = "plate" the same as "hhj".
    order : "auto", 1, 2, ... 12
        Of the Koiter element, up to 4, and of HHJ plates.
    large_deflection : "auto", True or False
        "auto": small deflections first, large ones where they differ by more than 1 %. Of a motion "auto" is large, but
        for plates (model = "plate", or their elements).
    tolerance : float, optional [1]
        Relative: the mesh is refined until what is asked for is known that well, with the element that is named or
        the one that suits. Absent: it is solved as given.
    quantity : str, optional
        What the tolerance is for: "energy", "probes", or the name of one; the probes where there are any if absent.
    limit : str, optional
        A time or a size of memory, "60 s" or "4 GB", at which the mesh is refined no more.
    solver : "auto", "direct", "multigrid" or "petsc"
        How the linear system is solved. On several processes PETSc does it, which "petsc" takes on one, too.
    steps : "auto" or int [1]
        First guess of the number of load steps; they adapt. "auto": 10 on a path, 1 otherwise.
    control : Control or dict, optional
        Of a path: the displacement of a probe grows in steps instead of the load.
    branch : 0, 1 or -1
        Of a path: what to do at its first bifurcation: stay on it, or follow the branch that leaves along the
        critical mode, or against it.
    count : int, optional [1]
        How many modes (6 if not given) or buckling factors (3).
    range : (f1, f2), optional [1 / time]
        Modes with frequencies in a range, instead of a number of them.
    prestress : bool or float [1]
        Of modes: the loads act before the structure vibrates; a number is the factor at which they do, but those that
        are fixed. Of a response: those with fixed = true act at rest, the others shake.
    error : "auto" or "off"
        Whether intervals are found for what is computed.
    time : float, optional [time]
        Of a motion: its end.
    step : "auto" or float [time]
        Of a motion: "auto" begins with a fortieth of the period of the first mode and adapts; a number stays where
        the step has an answer.
    scheme : "auto", "alpha", "em", "bdf2", "euler", "modes" or "direct"
        Of a motion: generalised alpha (auto); energy and momentum conserved; backward differences of order 2 and 1,
        which damp. Of a response: by modes (auto), or a complex system for every frequency.
    output : int [1]
        Of a motion: how many states are kept and written, evenly in time.
    ramp : float, optional [time]
        Of a motion: time over which all loads and prescribed motions grow from zero.

    Examples
    --------
    ```toml
    [solve]
    analysis = "static"
    model = "shell"
    element = "koiter"
    order = 2
    large_deflection = true
    tolerance = "1%"
    quantity = "centre"
    limit = "60 s"
    solver = "direct"
    error = "auto"

    [solve]                # a path
    analysis = "path"
    steps = 20
    control = {probe = "crown", component = "z", to = -0.03}
    branch = 1

    [solve]                # modes
    analysis = "modes"
    count = 10
    prestress = true

    [solve]                # all modes between two frequencies
    analysis = "modes"
    range = [0, 100]

    [solve]                # a response to loads that oscillate
    analysis = "response"
    scheme = "modes"

    [solve]                # a motion
    analysis = "dynamic"
    time = 0.5
    step = 0.001
    scheme = "alpha"
    output = 100
    ramp = 0.1
    ```
    """

    analysis: Literal["static", "path", "modes", "buckling", "response", "dynamic"] = "static"
    model: Literal["auto", "plate", "shell"] = "auto"
    element: Literal["auto", "morley", "argyris", "hhj", "koiter"] = "auto"
    order: Literal["auto", 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12] = "auto"
    large_deflection: Annotated[
        Any, BeforeValidator(_large), WithJsonSchema({"enum": ["auto", True, False]})
    ] = "auto"
    tolerance: Annotated[
        Any, BeforeValidator(as_tolerance), WithJsonSchema(kinds.either(kinds.POSITIVE, kinds.TEXT))
    ] = None
    quantity: Annotated[Any, BeforeValidator(_quantity), WithJsonSchema(kinds.TEXT)] = None
    limit: Annotated[Any, BeforeValidator(_limit), WithJsonSchema(kinds.TEXT)] = None
    solver: Literal["auto", "direct", "multigrid", "petsc"] = "auto"
    steps: Annotated[Any, BeforeValidator(_steps), WithJsonSchema(kinds.either(kinds.AUTO, kinds.COUNT))] = (
        "auto"
    )
    control: Annotated[Any, BeforeValidator(_control), WithJsonSchema(CONTROL)] = None
    branch: Annotated[Any, BeforeValidator(_branch), WithJsonSchema({"enum": [0, 1, -1]})] = 0
    count: Annotated[Any, BeforeValidator(_count), WithJsonSchema(kinds.COUNT)] = None
    range: Annotated[Any, BeforeValidator(_range), WithJsonSchema(kinds.listed(kinds.NUMBER, 2, 2))] = None
    prestress: Annotated[
        Any, BeforeValidator(_prestress), WithJsonSchema(kinds.either({"type": "boolean"}, kinds.POSITIVE))
    ] = 0.0
    error: Literal["auto", "off"] = "auto"
    time: Duration = None
    step: Annotated[
        Any, BeforeValidator(_time_step), WithJsonSchema(kinds.either(kinds.AUTO, kinds.POSITIVE))
    ] = "auto"
    scheme: Literal["auto", "alpha", "em", "bdf2", "euler", "modes", "direct"] = "auto"
    output: Annotated[Any, BeforeValidator(_output), WithJsonSchema(kinds.COUNT)] = 50
    ramp: Duration = None

    @property
    def time_limit(self) -> float:
        """Seconds after which the mesh is refined no more; infinite where there is no such limit."""
        return self._limited(SECONDS)

    @property
    def memory_limit(self) -> float:
        """Bytes beyond which the mesh is refined no more; infinite where there is no such limit."""
        return self._limited(BYTES)

    def _limited(self, units: Mapping[str, float]) -> float:
        number, _, unit = (self.limit or " ").partition(" ")
        return float(number) * units[unit] if unit in units else float("inf")

    @property
    def large_asked(self) -> bool:
        """Whether large deflections are asked for, in so many words or as a path."""
        return self.large_deflection is True or self.analysis == "path"

    def updated(self, **changes: Any) -> SolveOptions:
        """These options with some changed.

        Raises
        ------
        InputError
            If an option does not exist or has a value that does not.
        """
        return SolveOptions(**{f.name: getattr(self, f.name) for f in fields(self)} | changes)

    @property
    def without_errors(self) -> bool:
        """Whether no error is asked for, by a tolerance either."""
        return self.error == "off" and self.tolerance is None

    @property
    def looks(self) -> tuple[float, ...]:
        """Times of a motion at which loads that move are looked at, the start first; steps where these are given."""
        if self.analysis != "dynamic" or self.time is None:
            return (0.0,)
        end = float(self.time)
        steps = LOOKS if isinstance(self.step, str) else max(round(end / self.step), 1)
        size = end / steps if isinstance(self.step, str) else self.step
        return tuple(k * size for k in range(0, steps + 1, max(1, steps // LOOKS)))
