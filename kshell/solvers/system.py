"""What goes into a solver and what comes out: the space behind the matrix, the solution, the prepared solver.

Symbols
-------
A    symmetric positive definite matrix on the free unknowns q, (n, n)
T    reduction: all degrees of freedom of the element from the free unknowns, u = T q
M    the preconditioner, or the factorisation: an approximate inverse of A
r    residual b - A x; sqrt(r.M r) estimates the error x - A^-1 b in the energy norm sqrt(e.A e)
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.integer[Any]]

Progress = Callable[[int, float], None]  # called with the iteration and its estimated relative energy error

Product = Callable[[Floats], Floats]  # x -> A x


@dataclass(frozen=True, eq=False)
class PlateSpace:
    """The finite element space behind a plate matrix: all that multigrid has to know of it.

    All degrees of freedom, before supports are imposed, are for "morley" the deflection at the vertices,
    then the normal derivative at the midpoints of the edges; for "argyris" (w, w_x, w_y, w_xx, w_xy, w_yy)
    vertex by vertex, then the normal derivative at the midpoints of the edges. The normal of an edge is
    (t_y, -t_x), t being the tangent from its lower to its higher vertex. Behind them stand (w_xx, w_xy, w_yy) of
    further fans, triangles around a vertex that have second derivatives of their own, and further slopes of edges.

    Attributes
    ----------
    element : "morley" or "argyris"
    points : (vertex, 2) float array
    triangles : (triangle, 3) int array
    edges : (edge, 2) int array
        Vertices of each edge, the lower index first.
    edge_normals : (edge, 2) float array
    lengths : (edge,) float array
    reduction : (dofs, unknowns) sparse matrix
        T with u = T q. Its columns carry the scaling of the unknowns and are orthogonal, up to that scaling.
    vertex_basis : (vertex, 3, 3) float array
        Orthogonal columns that span (w, w_x, w_y) at each vertex.
    vertex_mask : (vertex, 3) bool array
        Which of these columns the supports admit.
    stiffness : (triangle,) float array, optional
        Bending stiffness of each triangle in any one measure. Give it where it jumps: the coarse levels then
        follow the interfaces.
    fan_vertex : (fan,) int array, optional
        Vertex of each fan; the first fans are those of the vertices in turn. One fan each if not given.
    corner_fan : (triangle, 3) int array, optional
        Fan of each corner.
    second_slopes : (n,) int array, optional
        Edges of the further slopes.
    """

    element: Literal["morley", "argyris"]
    points: Floats
    triangles: Ints
    edges: Ints
    edge_normals: Floats
    lengths: Floats
    reduction: Any
    vertex_basis: Floats
    vertex_mask: NDArray[np.bool_]
    stiffness: Floats | None = None
    fan_vertex: Ints | None = None
    corner_fan: Ints | None = None
    second_slopes: Ints | None = None

    def __post_init__(self) -> None:
        vertices, edges = len(self.points), len(self.edges)
        if self.element not in ("morley", "argyris"):
            raise InputError(f"no multigrid for the element {self.element!r}: use 'morley' or 'argyris'")
        shapes = {
            "points": (vertices, 2),
            "triangles": (len(self.triangles), 3),
            "edges": (edges, 2),
            "edge_normals": (edges, 2),
            "lengths": (edges,),
            "vertex_basis": (vertices, 3, 3),
            "vertex_mask": (vertices, 3),
        }
        if self.stiffness is not None:
            shapes["stiffness"] = (len(self.triangles),)
        for name, shape in shapes.items():
            found = np.shape(getattr(self, name))
            if found != shape:
                raise InputError(f"PlateSpace.{name} has the shape {found}, {shape} was expected")
        dofs = (vertices if self.element == "morley" else 6 * vertices) + edges
        if self.fan_vertex is not None:
            dofs += 3 * (len(self.fan_vertex) - vertices)
        if self.second_slopes is not None:
            dofs += len(self.second_slopes)
        if self.reduction.shape[0] != dofs:
            raise InputError(f"PlateSpace.reduction has {self.reduction.shape[0]} rows, {dofs} were expected")


@dataclass(frozen=True, eq=False)
class Solution:
    """The answer to one right-hand side, or to several at once.

    Attributes
    ----------
    x : (n,) or (n, load) float array
    name : str
        What solved it, for example "CHOLMOD (cvxopt)" or "multigrid".
    why : str
        Why that solver was taken, in words.
    iterations : int
        Steps of iterative refinement (direct) or of conjugate gradients (multigrid), the most of all loads.
    history : tuple of float
        Estimated relative error in the energy norm before each iteration and after the last, worst load.
    energy_error : float
        The last entry of `history`.
    residual : float
        |b - A x| / |b|, Euclidean, of the worst load. The conditioning of plates (h^-4) keeps it well above
        the error of the deflection.
    seconds : dict of str to float
        "setup" (0 when it was reused) and "solve".
    warnings : tuple of str
    """

    x: Floats
    name: str
    why: str
    iterations: int
    history: tuple[float, ...]
    energy_error: float
    residual: float
    seconds: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def column(self, number: int) -> Solution:
        """The answer to one of several right-hand sides; what is said of its error is that of the worst."""
        return replace(self, x=np.ascontiguousarray(self.x[:, number]))


class Prepared(ABC):
    """A matrix made ready for any number of right-hand sides.

    Attributes
    ----------
    name, why : str
        As in `Solution`.
    setup_seconds : float
    warnings : tuple of str
    """

    name: str
    why: str
    setup_seconds: float
    warnings: tuple[str, ...]

    @abstractmethod
    def solve(
        self,
        rhs: Floats,
        tolerance: float | None = None,
        progress: Progress | None = None,
        product: Product | None = None,
    ) -> Solution:
        """Solve for one load (n,) or several (n, load).

        Parameters
        ----------
        rhs : (n,) or (n, load) float array
        tolerance : float, optional
            Relative error in the energy norm.
        progress : function, optional
            Called with the iteration and its estimated relative energy error.
        product : function, optional
            x -> A x for (n,) and (n, load), more accurate than the entries of the matrix allow. The residuals of the
            refinement are then formed with it, and the answer is that of the more accurate A.

        Raises
        ------
        InputError
            If the load has the wrong length or is not finite.
        SolveError
            If no answer was reached; its `state` is the `Solution` so far.
        """
