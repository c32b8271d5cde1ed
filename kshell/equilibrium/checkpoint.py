"""Converged steps on disk, each whole, from which a path goes on as if it had never stopped."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from kshell.equilibrium.march import Crossing, March
from kshell.equilibrium.path import Arc, Critical
from kshell.equilibrium.problem import State
from kshell.errors import InputError

Saved = Iterator[tuple[March, Critical | None]]


class Store:
    """Files step-0001.npz, step-0002.npz, ... of arrays in a folder.

    Parameters
    ----------
    folder : Path
        Made if needed.
    fingerprint : str
        Of the problem; steps of another problem are refused.

    Raises
    ------
    InputError
        If the folder cannot be made.
    """

    def __init__(self, folder: Path, fingerprint: str) -> None:
        self.folder, self.fingerprint = folder, fingerprint
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{folder}: cannot be made ({error.strerror}): give another folder") from None

    def _path(self, number: int) -> Path:
        return self.folder / f"step-{number:04d}.npz"

    def clear(self) -> Iterator[Any]:
        """Remove the steps of an earlier path; there is nothing to go on from."""
        for path in self.folder.glob("step-*.npz*"):
            path.unlink()
        return iter(())

    def write_content(self, number: int, content: dict[str, Any]) -> None:
        """Write arrays by name: they appear under their number only when they are complete.

        Raises
        ------
        InputError
            If they cannot be written; earlier ones are untouched.
        """
        path = self._path(number)
        unfinished = path.with_suffix(".npz-unfinished")
        try:
            with unfinished.open("wb") as file:
                np.savez(file, fingerprint=self.fingerprint, **content)
                file.flush()
                os.fsync(file.fileno())
            os.replace(unfinished, path)
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror}): make room and resume") from None

    def read_content(self) -> Iterator[dict[str, Any]]:
        """Arrays by name, in the order of their numbers, up to the first one missing.

        Raises
        ------
        InputError
            If a file is damaged or of another problem.
        """
        number = 1
        while (path := self._path(number)).exists():
            try:
                with np.load(path, allow_pickle=False) as file:
                    content = {name: file[name] for name in file.files}
            except (OSError, ValueError, BadZipFile) as error:
                raise InputError(f"{path}: is damaged ({error}): remove it and resume") from None
            if str(content.get("fingerprint")) != self.fingerprint:
                raise InputError(
                    f"{path}: is a step of another problem: mesh, supports, loads, material or steps differ; give "
                    "another folder, or leave --resume out to start anew"
                )
            yield content
            number += 1


class Checkpoints(Store):
    """The steps of a path."""

    def write(self, number: int, march: March, critical: Critical | None) -> None:
        """Write a step.

        Raises
        ------
        InputError
            If it cannot be written; earlier steps are untouched.
        """
        content: dict[str, Any] = state_content("", march.state)
        numbers = [march.size, march.moved, march.rate, march.attempts, march.jumps, march.branched]
        content["march"] = np.array(numbers)
        if march.crossing is not None:
            c = march.crossing
            content["crossing"] = np.array([c.steps, c.factor, c.negative, c.arc.length, c.arc.first])
            if c.arc.moved is not None:
                content["arc_moved"] = c.arc.moved
        if critical is not None:
            content |= {"critical_kind": critical.kind, "critical_mode": critical.mode}
            content["critical_then"] = critical.then
            content |= state_content("critical_", critical.state)
        self.write_content(number, content)

    def read(self, rest: Any) -> Saved:
        """The steps in the folder, in order, up to the first one missing.

        Parameters
        ----------
        rest : object
            Memory of the rest state, None or a dataclass of arrays: that of the states is of its kind.

        Raises
        ------
        InputError
            If a file is damaged or of another problem.
        """
        return (_march(content, rest) for content in self.read_content())


def state_content(prefix: str, state: State) -> dict[str, Any]:
    """The arrays of a state, their names begun with a prefix."""
    out: dict[str, Any] = {
        f"{prefix}x": state.x,
        f"{prefix}state": np.array([state.factor, state.iterations, state.negative]),
        f"{prefix}turned": state.turned,
    }
    if is_dataclass(state.memory):
        for part in fields(state.memory):
            out[f"{prefix}{part.name}"] = getattr(state.memory, part.name)
    return out


def read_state(prefix: str, content: dict[str, Any], rest: Any) -> State:
    """The state among such arrays."""
    factor, iterations, negative = content[f"{prefix}state"]
    memory = None
    if is_dataclass(rest):
        memory = type(rest)(**{part.name: content[f"{prefix}{part.name}"] for part in fields(rest)})  # type: ignore[misc]
    x, turned = content[f"{prefix}x"], content[f"{prefix}turned"]
    return State(float(factor), x, memory, int(iterations), int(negative), turned)


def _march(content: dict[str, Any], rest: Any) -> tuple[March, Critical | None]:
    size, moved, rate, attempts, jumps, branched = content["march"]
    crossing = None
    if "crossing" in content:
        steps, factor, negative, length, first = content["crossing"]
        arc = Arc(float(length), float(first), content.get("arc_moved"))
        crossing = Crossing(arc, int(steps), float(factor), int(negative))
    state = read_state("", content, rest)
    march = March(
        state, float(size), float(moved), float(rate), int(attempts), int(jumps), bool(branched), crossing
    )
    if "critical_kind" not in content:
        return march, None
    where = read_state("critical_", content, rest)
    kind, mode = str(content["critical_kind"]), content["critical_mode"]
    then: Any = str(content["critical_then"])
    return march, Critical(kind, where, mode, then)
