"""Where a path of loads has got to: all that its next step depends on, so that an interrupted one goes on."""

from __future__ import annotations

from dataclasses import dataclass

from kshell.equilibrium.path import Arc
from kshell.equilibrium.problem import State


@dataclass(frozen=True)
class Crossing:
    """The way through limit points.

    Attributes
    ----------
    arc : Arc
    steps : int
        Steps made along it.
    factor, negative : float, int
        Of the state where it began: it ends beyond that load, as stable as there.
    """

    arc: Arc
    steps: int
    factor: float
    negative: int


@dataclass(frozen=True)
class March:
    """A state and how to go on from it.

    Attributes
    ----------
    state : State
    size : float
        Of the next load step.
    moved : float
        Root mean square displacement of the nodes in the last step, 0 before the first.
    rate : float
        The same per growth of the load.
    attempts : int
        Steps tried so far.
    jumps : int
        Made so far.
    branched : bool
        Whether a bifurcation was left along its mode.
    crossing : Crossing, optional
        On the way through limit points.
    """

    state: State
    size: float
    moved: float = 0.0
    rate: float = 0.0
    attempts: int = 0
    jumps: int = 0
    branched: bool = False
    crossing: Crossing | None = None
