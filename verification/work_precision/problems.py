"""The plates that are measured, with references, meshes and methods. All methods get the same meshes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

import kshell as ks
from verification.cases import find, meshes


@dataclass(frozen=True)
class Problem:
    """A plate of bending stiffness 1, nu = 0.3, under the pressure 1, all edges alike.

    Attributes
    ----------
    id, title : str
    kind : "clamped" or "supported"
    build : function of the cells per side
    place : point where w and M_xx are read
    references : dict of "compliance", "w", "M" to values; those it has are compared
    uncertainty : float
        Relative, of the worst of them: errors below mean nothing.
    sizes : dict of family of methods to cells per side
    """

    id: str
    title: str
    kind: str
    build: Callable[[int], ks.Mesh]
    place: tuple[float, float]
    references: dict[str, float]
    uncertainty: float
    sizes: dict[str, tuple[int, ...]]

    def arrays(self, cells: int) -> dict[str, NDArray[Any]]:
        """Points, triangles and boundary edges."""
        mesh = self.build(cells)
        edges = mesh.edges[mesh.boundary_edges]
        return {"points": mesh.points[:, :2], "triangles": mesh.triangles, "edges": edges}


@dataclass(frozen=True)
class Method:
    """A program, its element and its solver.

    Attributes
    ----------
    id : str
    program : "kshell", "scikit-fem" or "ngsolve"
    element : str
        Or the order, of NGSolve.
    solver : str
        Of kshell.
    """

    id: str
    program: str
    element: str
    solver: str = ""


METHODS = (
    Method("kshell Argyris direct", "kshell", "argyris", "direct"),
    Method("kshell Argyris multigrid", "kshell", "argyris", "multigrid"),
    Method("kshell Morley direct", "kshell", "morley", "direct"),
    Method("kshell Morley multigrid", "kshell", "morley", "multigrid"),
    Method("scikit-fem Argyris", "scikit-fem", "argyris"),
    Method("scikit-fem Morley", "scikit-fem", "morley"),
    Method("NGSolve HHJ order 2", "ngsolve", "2"),
    Method("NGSolve HHJ order 3", "ngsolve", "3"),
    Method("NGSolve HHJ order 4", "ngsolve", "4"),
    Method("NGSolve HHJ order 5", "ngsolve", "5"),
)

# NGSolve on a mesh graded by 22 layers, orders 6 to 9: 5.5915668, 5.5915269, 5.5915182, 5.5915163e-5 and so on;
# Argyris stays below, as it must
L_SHAPE = {"compliance": 5.5915158e-5, "w": 1.9557138e-4, "M": 7.4942854e-3}
L_SHAPE_UNCERTAINTY = 3e-7
LAYERS = 16


def _square() -> Problem:
    known = find("ssss.uniform.ba1").references
    return Problem(
        "square",
        "Simply supported square (smooth but for r^4 log r in the corners)",
        "supported",
        lambda n: meshes.mesh(*meshes.grid(n, n), {"edge": meshes.everywhere}),
        (0.5, 0.5),
        {"compliance": known["compliance"].value, "w": known["w_c"].value, "M": known["Mx_c"].value},
        1e-13,
        {"argyris": (4, 8, 16, 32, 64, 104), "morley": (8, 16, 32, 64, 128, 158), "hhj": (4, 8, 16, 32, 64)},
    )


def _l_shape() -> Problem:
    return Problem(
        "l_shape",
        "Clamped L-shape (singular corner; triangles graded towards it)",
        "clamped",
        lambda n: meshes.l_shape(n, LAYERS),
        (0.25, 0.25),
        L_SHAPE,
        L_SHAPE_UNCERTAINTY,
        {"argyris": (4, 8, 16, 32, 64), "morley": (8, 16, 32, 64, 128), "hhj": (4, 8, 16, 32, 64)},
    )


PROBLEMS = {problem.id: problem for problem in (_square(), _l_shape())}
