"""A cross-section given by its stiffness: sandwich, ribbed or corrugated plates, woven cloth."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import WithJsonSchema

from kshell.errors import InputError
from kshell.values import kinds
from kshell.values.validation import Number, described

Floats = NDArray[np.float64]

LOPSIDED = 1e-9  # difference of M and its transpose, in its largest entry, that rounding may leave


Matrix = Annotated[Any, WithJsonSchema(kinds.matrix(3))]


@described("section")
class Section:
    """Stiffness per length about the middle of the section, in the order xx, yy, xy with engineering shears.

    Attributes
    ----------
    A : (3, 3) [force / length]
        Stretching, force per length: N = A e - B w''.
    D : (3, 3) [force * length]
        Bending, force times length: M = B e - D w'', w'' = (w_xx, w_yy, 2 w_xy).
    B : (3, 3), optional [force]
        Coupling, force; zero if absent.
    mass : float [mass / length^2]
        Mass per area.
    S : (2, 2), optional [force / length]
        Transverse shear, force per length: (Q_x, Q_y) = S (gamma_x, gamma_y). Without it the error that the theory
        makes by having no shear is not known.
    thickness : float, optional [length]
        Without it there are no stresses; with it they are N / t +- 6 M / t^2.

    Raises
    ------
    InputError
        If a matrix is not one of finite numbers, not symmetric, or the energy is not positive for every strain.

    Examples
    --------
    ```toml
    [section]
    A = [[3e7, 9e6, 0], [9e6, 3e7, 0], [0, 0, 1e7]]
    D = [[900, 270, 0], [270, 900, 0], [0, 0, 315]]
    B = [[100, 0, 0], [0, 100, 0], [0, 0, 50]]
    S = [[8e5, 0], [0, 8e5]]
    mass = 12
    thickness = 0.02
    ```
    """

    A: Matrix
    D: Matrix
    B: Matrix = None
    mass: Number = 0.0
    S: Annotated[Any, WithJsonSchema(kinds.matrix(2))] = None
    thickness: Number | None = None

    def __post_init__(self) -> None:
        for key, size in (("A", 3), ("D", 3), ("B", 3), ("S", 2)):
            if getattr(self, key) is not None:
                object.__setattr__(self, key, _symmetric(getattr(self, key), key, size))
        for key in ("A", "D"):
            if getattr(self, key) is None:
                raise InputError(f"section: {key} is missing: give a 3 x 3 matrix")
        for key in ("A", "D", "S"):
            _require_positive(key, getattr(self, key))
        if self.B is not None:
            height = np.sqrt(np.trace(self.bending) / np.trace(self.membrane))  # makes all blocks of one unit
            whole = np.block(
                [
                    [self.membrane, self.coupling / height],
                    [self.coupling / height, self.bending / height**2],
                ]
            )
            if not np.linalg.eigvalsh(whole)[0] > 0.0:
                raise InputError(
                    f"section: B = {self.B!r} is too large for A and D: some strain would have no positive energy"
                )
        if self.mass < 0.0:
            raise InputError(f"section: mass = {self.mass:g} must not be negative (mass per area)")
        if self.thickness is not None and not self.thickness > 0.0:
            raise InputError(f"section: thickness = {self.thickness:g} must be > 0, or left out")

    @property
    def membrane(self) -> Floats:
        """A as an array."""
        return np.array(self.A)

    @property
    def coupling(self) -> Floats:
        """B as an array."""
        return np.zeros((3, 3)) if self.B is None else np.array(self.B)

    @property
    def bending(self) -> Floats:
        """D as an array."""
        return np.array(self.D)

    @property
    def shear(self) -> Floats | None:
        """S as an array."""
        return None if self.S is None else np.array(self.S)

    @property
    def height(self) -> float:
        """The thickness, or where it is not given that of a homogeneous section with the same D / A."""
        if self.thickness is not None:
            return float(self.thickness)
        return float(np.sqrt(12.0 * np.trace(self.bending) / np.trace(self.membrane)))


def _symmetric(given: Any, key: str, size: int) -> tuple[tuple[float, ...], ...]:
    """A symmetric matrix as nested tuples, comparable and immutable."""
    try:
        matrix = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(
            f"section: {key} = {given!r} is not a matrix of numbers: give {size} rows of {size}"
        ) from None
    if matrix.shape != (size, size):
        raise InputError(f"section: {key} has the shape {matrix.shape}: it must be {size} x {size}")
    if not np.isfinite(matrix).all():
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise InputError(
            f"section: {key}{row + 1}{column + 1} = {matrix[row, column]:g} must be a finite number"
        )
    if np.abs(matrix - matrix.T).max() > LOPSIDED * np.abs(matrix).max():
        row, column = np.unravel_index(np.abs(matrix - matrix.T).argmax(), matrix.shape)
        raise InputError(
            f"section: {key} is not symmetric: {key}{row + 1}{column + 1} = {matrix[row, column]:g} but "
            f"{key}{column + 1}{row + 1} = {matrix[column, row]:g}"
        )
    return tuple(map(tuple, (0.5 * (matrix + matrix.T)).tolist()))


def _require_positive(key: str, matrix: Any) -> None:
    if matrix is not None and not np.linalg.eigvalsh(np.array(matrix))[0] > 0.0:
        raise InputError(
            f"section: {key} = {matrix!r} is not positive definite: some strain would have no positive energy"
        )
