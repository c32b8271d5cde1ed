"""Probes of HHJ plates between vertices, where the deflection is a polynomial of each triangle by itself."""

from __future__ import annotations

import numpy as np

from kshell.elements.reference import VERTICES
from kshell.equilibrium.model import Solved
from kshell.error.plates import AT_VERTEX, on_held_edges
from kshell.plate.hhj.model import HHJModel
from kshell.plate.hhj.recovery import HHJFields
from kshell.plate.sharing import along_edges


class Between:
    """A probe that is no vertex.

    Attributes
    ----------
    apart : float
        What its deflection may be off by because it is one of its triangle, not of the element's unknowns.
    own : float
        The deflection of the element's unknowns.
    on_held : bool
        Whether supports hold it there.
    """

    def __init__(self, model: HHJModel, solved: Solved, name: str) -> None:
        problem = model.problem
        place = np.array(problem.structure.probes[name])[None, :2]
        self.on_held = bool(on_held_edges(problem, place)[0])
        found = problem.locator.find(place)
        triangles, xi = found.triangles.astype(np.int64), found.xi.reshape(1, 1, 2)
        fields = HHJFields(problem, model.loads, model.system(), solved.own)
        self.own = float(fields.of_the_element(triangles, xi, 0).item())
        self.apart = 0.0
        if np.abs(xi[0] - VERTICES).max(axis=1).min() > AT_VERTEX:
            held = np.zeros(len(problem.mesh.edges), dtype=bool)
            for group in problem.supports.held:
                held[group.line] = True
            sides = along_edges(problem.domain, found).located.triangles
            self.apart = max(fields.apart(triangle, held) for triangle in sides.tolist())
