"""What the supports of a plate hold: the data that models, reactions and error estimates read."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from kshell.plate.conditions import Conditions
from kshell.plate.forms import Form
from kshell.plate.holds import CurvedHold, HoldLoad, OfPlace, scaled
from kshell.plate.ties import CurvedTie

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NONE = np.zeros(0, dtype=np.int64)


@dataclass
class HeldGroup:
    """What one support holds, for reactions.

    Attributes
    ----------
    label : str
    vertices : (n,) int array
    edges : (n,) int array
        Edges whose slope is held.
    line : (n,) int array
        Edges along which the deflection is held.
    points : (n,) int array
        Vertices at which the deflection alone is held, without an edge.
    surface : (n,) int array
        Triangles that are held whole.
    turned : bool
        Whether the rotation is held at single points.
    value : function or None
        Prescribed deflection at points (..., 2); None is zero.
    degree : int or None
        Of that deflection as a polynomial; None where it is none, or not known to be one.
    slope : function or None
        Prescribed derivative along the outward normal of `edges` at points (..., 2); None is zero.
    slope_degree : int or None
        Of that derivative as a polynomial.
    rows : range
        Its rows among the conditions.
    """

    label: str
    vertices: Ints
    edges: Ints
    line: Ints
    points: Ints = field(default_factory=lambda: NONE)
    surface: Ints = field(default_factory=lambda: NONE)
    turned: bool = False
    value: OfPlace | None = None
    degree: int | None = 0
    slope: OfPlace | None = None
    slope_degree: int | None = 0
    rows: range = range(0)

    def times(self, motion: float) -> HeldGroup:
        """The same with what it prescribes times a number."""
        return replace(self, value=scaled(motion, self.value), slope=scaled(motion, self.slope))


@dataclass
class Supports:
    """All supports of a scene on one element.

    Attributes
    ----------
    conditions : Conditions
    ties : list of CurvedTie
        Consistency terms of curved edges inside where nothing is held.
    springs : list of (label, Form)
    held : list of HeldGroup
    holds : list of (label, CurvedHold)
        Consistency terms of held curved edges.
    hold_loads : list of HoldLoad
        Their right-hand sides where a deflection or slope is prescribed.
    warnings : list of str
    """

    conditions: Conditions = field(default_factory=Conditions)
    ties: list[CurvedTie] = field(default_factory=list)
    springs: list[tuple[str, Form]] = field(default_factory=list)
    held: list[HeldGroup] = field(default_factory=list)
    holds: list[tuple[str, CurvedHold]] = field(default_factory=list)
    hold_loads: list[HoldLoad] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def times(self, motion: float) -> Supports:
        """The same with what is prescribed times a number; conditions keep theirs."""
        return replace(
            self,
            held=[group.times(motion) for group in self.held],
            hold_loads=[load.times(motion) for load in self.hold_loads],
        )
