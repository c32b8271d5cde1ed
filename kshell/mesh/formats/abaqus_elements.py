"""The element types of Abaqus and CalculiX: how many nodes they have and what a shell mesh makes of them."""

from __future__ import annotations

import re
from dataclasses import dataclass

from kshell.mesh.formats.found import SOLID

LEFT_OUT = "left out"

# thin and thick shells, heat transfer in shells, membranes, surfaces, plane stress and strain, plane heat and acoustics
_FLAT = re.compile(
    r"^(S|DS|M3D|SFM3D|CPS|CPE|CPEG|DC2D|AC2D)([34689])(R|RS|RSW|R5|RT|T|RP|P|I|H|IH|RH|M|MH|E|MT|MP)*$"
)
_LINES = re.compile(r"^(B2|B3|PIPE2|PIPE3|ELBOW3|T2D|T3D|DC1D|RB2D|RB3D)([123])(\w*)$")
_SOLID = re.compile(r"^(?:C3D|DC3D|AC3D|SC|CCL|CSS|DCC3D|EC3D|FC3D|F3D)(\d*)\w*$")
_AXISYMMETRIC = re.compile(r"^(?:CGAX|CAX|SAX|DSAX|DCAX|ACAX|MAX|SFMAX)(\d*)\w*$")
_DISCRETE = {"MASS": 1, "ROTARYI": 1, "SPRING1": 1, "DASHPOT1": 1, "SPRING2": 2, "SPRINGA": 2, "DASHPOT2": 2}
_DISCRETE |= {
    "DASHPOTA": 2,
    "GAPUNI": 2,
    "GAPCYL": 2,
    "GAPSPHER": 2,
    "CONN2D2": 2,
    "CONN3D2": 2,
    "DCOUP3D": 1,
}
_RIGID = {"R3D3": 3, "R3D4": 4, "R2D2": 2}


@dataclass(frozen=True)
class ElementType:
    """What becomes of the elements of a type.

    Attributes
    ----------
    kind : str
        As in `Found.blocks`, or `LEFT_OUT`.
    nodes : int
        How many nodes follow the number of an element; 0 if it does not matter.
    says : str
        What is to be said about them, after "12 elements B31 "; empty if nothing.
    """

    kind: str
    nodes: int
    says: str = ""


def element_type(name: str) -> ElementType | None:
    """The type of this name; None if it is not known."""
    name = name.upper()
    if name in ("STRI3", "STRI65"):
        return ElementType("triangle", 3 if name == "STRI3" else 6)
    flat = _FLAT.match(name)
    if flat:
        nodes = int(flat[2])
        says = "(membranes) are taken as shells" if flat[1] in ("M3D", "SFM3D") else ""
        return ElementType("triangle" if nodes in (3, 6) else "quadrilateral", nodes, says)
    if name in _DISCRETE:
        return ElementType(LEFT_OUT, _DISCRETE[name], "are left out: neither stiffness nor mass is read")
    if name in _RIGID:
        return ElementType(LEFT_OUT, _RIGID[name], "(rigid) are left out")
    solid = _SOLID.match(name)
    if solid:
        return ElementType(SOLID, int(solid[1] or 0))
    axisymmetric = _AXISYMMETRIC.match(name)
    if axisymmetric:
        return ElementType("axisymmetric cells", int(axisymmetric[1] or 0))
    line = _LINES.match(name)
    if line:
        degree = int(line[2])
        nodes = degree if line[1] in ("T2D", "T3D", "DC1D") else 3 if degree == 2 and line[1][0] != "R" else 2
        return ElementType("line", nodes, "are taken as lines without stiffness")
    return None
