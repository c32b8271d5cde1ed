"""What a user says about the shell as built: how far its nodes are off, and in which shape."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.values import kinds
from kshell.values.validation import Number, described


def _mode(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise ValueError("must be a whole number > 0")
    return value


def _file(value: Any) -> Any:
    if value is not None and (not isinstance(value, str | os.PathLike) or value == ""):
        raise ValueError("must be the path of a .vtu file, or of a text file with lines x y z dx dy dz")
    return None if value is None else Path(value)


@described("imperfection")
class Imperfection:
    """Nodes moved before anything is solved, without stress; shells of the Koiter element only.

    Attributes
    ----------
    amplitude : float, optional [length]
        Largest offset; negative: the other way. Needed for a mode; of a file absent: offsets as they stand.
    mode : int [1]
        Which linear buckling mode under the loads of the scene, counted from 1, gives the shape. Its largest
        component is positive.
    file : path, optional
        Instead of a mode: text with lines x y z dx dy dz, one for each vertex that is moved (.csv: with commas), or a
        result .vtu of the same mesh.
    field : str
        Of a .vtu, for example the critical mode of a path.

    Examples
    --------
    ```toml
    [imperfection]
    amplitude = 0.001
    mode = 2

    [imperfection]         # or from a file
    file = "offsets.vtu"
    field = "mode_1"
    ```
    """

    amplitude: Number | None = None
    mode: Annotated[Any, BeforeValidator(_mode), WithJsonSchema(kinds.COUNT)] = 1
    file: Annotated[Any, BeforeValidator(_file), WithJsonSchema(kinds.PATH)] = None
    field: str = "mode_1"

    def __post_init__(self) -> None:
        if self.amplitude == 0.0:
            raise InputError("imperfection: amplitude = 0 moves nothing: leave the imperfection out")
        if self.file is None and self.amplitude is None:
            raise InputError("imperfection: amplitude is missing: the largest offset of the mode, a length")
