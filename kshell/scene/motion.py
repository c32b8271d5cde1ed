"""How a motion begins and what damps it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.scene.places import On, VectorValue
from kshell.values import kinds
from kshell.values.validation import Number, described


@described("initial velocity")
class InitialVelocity:
    """The velocity at the time 0.

    Attributes
    ----------
    value : vector [length / time]
        Numbers or expressions in x, y, z, or a function f(x, y, z) that returns three components.
    on : str or list of str, optional
        Surface groups that move; everything if absent.
    """

    value: VectorValue
    on: On | None = None


@described("initial")
class Initial:
    """How a motion begins.

    Attributes
    ----------
    velocity : vector, optional [length / time]
        At the time 0; numbers or expressions in x, y, z.
    displacement : vector, optional [length]
        At the time 0; from there it moves.
    on : str or list of str, optional
        Surface groups that have the velocity; everything if absent.

    Examples
    --------
    ```toml
    [initial]
    velocity = [0, 0, "2*x"]
    displacement = [0, 0, "0.01*sin(pi*x)"]
    on = "plate"
    ```
    """

    velocity: VectorValue = None
    displacement: VectorValue = None
    on: On | None = None


@described("initial displacement")
class InitialDisplacement:
    """The displacement at the time 0.

    Attributes
    ----------
    value : vector [length]
        Numbers or expressions in x, y, z, or a function f(x, y, z) that returns three components.
    """

    value: VectorValue


def initial_displacement(value: Any) -> InitialDisplacement | None:
    """From what a scene takes: a vector or a function."""
    return value if value is None or isinstance(value, InitialDisplacement) else InitialDisplacement(value)


def initial_velocity(value: Any) -> InitialVelocity | None:
    """From what a scene takes: a vector, a function, or a dict with value and on."""
    if value is None or isinstance(value, InitialVelocity):
        return value
    return InitialVelocity(**value) if isinstance(value, Mapping) else InitialVelocity(value)


def _ratio(value: Any) -> Any:
    """None, a ratio, or a tuple of them."""
    if value is None:
        return None
    many = isinstance(value, list | tuple)
    numbers = tuple(value) if many else (value,)
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, int | float) or not np.isfinite(number):
            raise ValueError("must be a number such as 0.02, or a list of them, one for each mode")
        if number < 0:
            raise ValueError("must not be negative")
    if not numbers:
        raise ValueError("must be a number such as 0.02, or a list of them, one for each mode")
    return tuple(float(number) for number in numbers) if many else float(value)


@described("damping")
class Damping:
    """What damps a motion, or a response to harmonic loads.

    Attributes
    ----------
    ratio : float or list of float, optional [1]
        Of the first mode, to critical damping, by a viscous material: mode k gets omega_k / omega_1 times that. A
        list, for a response by modes: of each mode, those beyond the last one have that of the last.
    viscosity : float, optional [time]
        Time tau of a material of Kelvin and Voigt instead: its stress is that of the strain plus tau times its rate.
    drag : float [1 / time]
        Force against the velocity, per mass: 1 / time.

    Examples
    --------
    ```toml
    [damping]
    ratio = 0.02
    drag = 0.5

    [damping]              # or by a time instead of a ratio
    viscosity = 1e-4
    ```
    """

    ratio: Annotated[
        Any, BeforeValidator(_ratio), WithJsonSchema(kinds.either(kinds.NUMBER, kinds.listed(kinds.NUMBER)))
    ] = None
    viscosity: Number | None = None
    drag: Number = 0.0

    def __post_init__(self) -> None:
        if self.ratio is not None and self.viscosity is not None:
            raise InputError(
                "damping: ratio and viscosity given: the ratio makes a viscosity of its own, leave one out"
            )
        for key in ("viscosity", "drag"):
            value = getattr(self, key)
            if value is not None and value < 0.0:
                raise InputError(f"damping: {key} = {value:g} must not be negative")

    @property
    def per_mode(self) -> tuple[float, ...] | None:
        """Ratios of the modes one by one; None where a material and drag damp them."""
        return self.ratio if isinstance(self.ratio, tuple) else None

    def material(self, omega: float) -> float:
        """Viscosity of the material, where the first mode has a circular frequency."""
        if self.ratio is None or self.per_mode is not None:
            return float(self.viscosity or 0.0)
        return 2.0 * float(self.ratio) / omega


def damping(value: Any) -> Damping | None:
    """From what a scene takes."""
    if value is None or isinstance(value, Damping):
        return value
    if not isinstance(value, Mapping):
        raise InputError(
            f"scene: damping = {value!r}: must be ks.Damping(...), for example ks.Damping(ratio=0.02)"
        )
    return Damping(**value)
