"""Numbers out of the sections of a gmsh file, alike for ASCII and binary files.

The kinds of numbers are those of the format: "int" (4 bytes), "size" (8 bytes, MSH 4.1 only), "double".
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Section:
    """The bytes between $Name and $EndName."""

    name: str
    data: bytes
    source: str

    def fail(self, why: str) -> InputError:
        """An error that names the file and the section."""
        return InputError(
            f"{self.source}: ${self.name} {why}. The file is damaged or cut off: write it again, e.g. with "
            "`gmsh -2 file.geo -o file.msh`"
        )

    def text_floats(self) -> Floats:
        """All numbers of an ASCII section."""
        return self._text(np.float64, _NUMBER)

    def text_integers(self) -> Ints:
        """All numbers of an ASCII section of whole numbers: several times faster than `text_floats`."""
        return self._text(np.int64, _WHOLE)

    def _text(self, dtype: type, pattern: re.Pattern[bytes]) -> NDArray[Any]:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # numpy's word for text that is no number
            try:
                return np.fromstring(self.data.decode("latin-1"), dtype=dtype, sep=" ")
            except (DeprecationWarning, ValueError):
                pass
        broken = next((word for word in self.data.split() if not pattern.fullmatch(word)), b"?")
        raise self.fail(f"holds {broken[:40].decode('latin-1')!r} where a number should stand")


_WHOLE = re.compile(rb"[+-]?\d+")
_NUMBER = re.compile(rb"[+-]?(\d+\.?\d*([eEdD][+-]?\d+)?|\.\d+([eE][+-]?\d+)?|nan|inf)", re.IGNORECASE)


# sections that hold the mesh and its groups
ONCE = ("MeshFormat", "PhysicalNames", "Entities", "PartitionedEntities", "Nodes", "Elements")


def sections(data: bytes, source: str) -> dict[str, Section]:
    """The sections of a gmsh file by name. Of sections that may repeat (data) the first is kept.

    Raises
    ------
    InputError
        If a section is not ended, or one that a mesh is made of comes twice.
    """
    found: dict[str, Section] = {}
    at = 0
    while True:
        at = data.find(b"$", at)
        if at < 0:
            return found
        line_end = data.find(b"\n", at)
        line_end = len(data) if line_end < 0 else line_end
        name = data[at + 1 : line_end].strip().decode("latin-1")
        end = data.find(b"$End" + name.encode("latin-1"), line_end)
        if end < 0:
            short = Section(name[:40], b"", source)
            raise short.fail("is not ended")
        section = Section(name, data[line_end + 1 : end], source)
        if name in found and name in ONCE:
            raise section.fail("comes twice")
        found.setdefault(name, section)
        at = end + len(name) + 4


class Numbers:
    """A section read number by number, front to back.

    Parameters
    ----------
    section : Section
    binary : bool
    byte_order : "<", ">" or "="
    whole : bool
        The section holds no doubles.
    """

    def __init__(self, section: Section, binary: bool, byte_order: str, whole: bool = False) -> None:
        self._section = section
        self._types = {kind: np.dtype(byte_order + code) for kind, code in _CODES.items()}
        self._text: NDArray[Any] | None = None
        if not binary:
            self._text = section.text_integers() if whole else section.text_floats()
        self._at = 0

    def integer(self, kind: str = "int") -> int:
        """The next integer, "int" or "size"."""
        return int(self.integers(kind, 1)[0])

    def integers(self, kind: str, number: int) -> Ints:
        """The next `number` integers, "int" or "size"."""
        values = self._take(kind, number)
        whole = values.astype(np.int64)
        if self._text is not None and (whole != values).any():
            raise self._section.fail("has a fraction where a whole number should stand")
        return whole

    def doubles(self, number: int) -> Floats:
        """The next `number` floating-point numbers."""
        return self._take("double", number).astype(np.float64)

    def fail(self, why: str) -> InputError:
        """An error that names the file and the section."""
        return self._section.fail(why)

    def end(self) -> None:
        """Raise if anything follows."""
        text, data = self._text, self._section.data
        if (len(text) > self._at) if text is not None else data[self._at :].strip():
            raise self._section.fail(
                "holds more than it announces: a count is too small, of cells or nodes or of their blocks"
            )

    def _take(self, kind: str, number: int) -> NDArray[Any]:
        if number < 0:
            raise self._section.fail(f"announces {number} entries")
        values: NDArray[Any]
        if self._text is not None:
            values = self._text[self._at : self._at + number]
            self._at += number
        else:
            dtype = self._types[kind]
            available = (len(self._section.data) - self._at) // dtype.itemsize
            values = np.frombuffer(self._section.data, dtype, min(number, max(available, 0)), self._at)
            self._at += number * dtype.itemsize
        if len(values) < number:
            raise self._section.fail("ends before all announced entries have come")
        return values


_CODES = {"int": "i4", "size": "u8", "double": "f8"}
