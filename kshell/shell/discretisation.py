"""What a discretisation of the shell offers to the words of a scene: the base of Koiter triangles and of the chart.

What builds a problem from a structure works with either: conditions of supports, springs, points of quadrature, rigid
motions and recovery. Functions that turn values into forces are a module of the discretisation, `loads`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.energy import StrainEnergy
from kshell.equilibrium.reduction import Reduction
from kshell.material.inelastic import Inelastic
from kshell.mesh.select import Selection
from kshell.result.along_supports import AlongSupport
from kshell.shell.evaluate import OfPlace
from kshell.shell.initial import StressFree
from kshell.shell.section import Section

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
# edges, points, forces held, forces of springs, where lines stop, and the motion, to what acts along them
Distribution = Callable[..., tuple[AlongSupport, NDArray[np.bool_]]]


class Conditions(ABC):
    """Conditions on the motion, from selections of a mesh; every method adds some."""

    @abstractmethod
    def translations(self, chosen: Selection, letters: str, value: OfPlace, axes: Any = None) -> None:
        """Hold the components named by letters, in own axes (3, 3) if given, on vertices, edges or triangles."""

    @abstractmethod
    def rotations(self, chosen: Selection, what: str, value: OfPlace | None = None) -> None:
        """Hold the rotation about edges, at zero or at values in the sense of an edge moment.

        Raises
        ------
        InputError
            Where there is none.
        """

    @abstractmethod
    def symmetry(self, edges: Ints, normal: Floats | None = None) -> Floats:
        """A plane of symmetry through edges; its normal (3,), which is found where none is given."""

    @abstractmethod
    def reduction(self) -> Reduction:
        """The motions left."""

    def alone(self) -> Reduction:
        """The motions that these conditions by themselves leave, for reactions."""
        return self.reduction()


class Discretisation(ABC):
    """Unknowns of a surface and what is done with them.

    Attributes
    ----------
    name : str
    order : int
        Polynomial degree.
    surface : object
        Its rest geometry.
    unknowns : int
    loads : module
        Functions that turn values into forces on the unknowns.
    """

    name: str
    loads: ModuleType
    order: int
    surface: Any
    unknowns: int

    @abstractmethod
    def energy(self, section: Section, inelastic: Inelastic | None = None) -> StrainEnergy:
        """The energy with a cross-section, and with what it remembers of its past."""

    def warnings(self) -> list[str]:
        """What the user should know about it."""
        return []

    def unbalanced(self) -> str:
        """Why loads and reactions may differ, and how to mend it, in words."""
        return (
            "the solution has few correct digits; look for very small or very thin triangles (`kshell check`), or a "
            "shell that is hardly held"
        )

    @abstractmethod
    def conditions(self) -> Conditions:
        """Empty conditions on the motion."""

    @abstractmethod
    def initial_strain(self, energy: Any, state: StressFree, triangles: Ints) -> Floats:
        """(triangle, r) strains of the energy in a state free of stress, zero outside `triangles`."""

    @abstractmethod
    def interior_points(self, triangles: Ints) -> tuple[Floats, Floats]:
        """Quadrature points (n, q, 3) of triangles in space and weights (n, q) with the area element."""

    @abstractmethod
    def recovery(
        self,
        energy: Any,
        x: Floats,
        finite: bool = False,
        memory: Any = None,
        initial: Floats | None = None,
    ) -> Any:
        """Values of a solution inside triangles: `resultants`, `displacement` and `energies`."""

    @abstractmethod
    def patches(self) -> tuple[Ints, Floats]:
        """(triangle,) smooth piece of each triangle, and (triangle, 3) weights of the corners."""

    @abstractmethod
    def largest_curvature(self) -> Floats:
        """(triangle,) largest principal curvature in size."""

    @abstractmethod
    def rigid_motions(self, centre: Floats, size: float, moved: Floats | None = None) -> Floats:
        """(unknowns, 6): unit translations along x, y, z, and turns by 1 / size about axes through the centre.

        Turns are those of the shell at rest, or of the shell moved by (unknowns,) `moved`.
        """

    @abstractmethod
    def extent(self) -> tuple[Floats, float]:
        """Centre (3,) and size of the shell."""

    @abstractmethod
    def unknown_sizes(self) -> Floats:
        """(unknowns,) by which they are divided to be compared: 1 of displacements, inverse lengths of others."""

    @abstractmethod
    def vertex_of_unknown(self) -> Ints:
        """(unknowns,) some vertex of the triangles that each unknown belongs to."""

    @abstractmethod
    def translation_row(self, triangle: int, xi: Floats, axis: int) -> Floats:
        """(unknowns,) whose product with x is a component of the displacement at a reference point (2,)."""

    @abstractmethod
    def spring(self, chosen: Selection, along: str | Floats, stiffness: OfPlace, what: str) -> sp.csr_matrix:
        """Stiffness of springs along a unit vector (3,), the normal ("n"), or against the rotation about an edge ("r").

        Raises
        ------
        InputError
            For rotation springs elsewhere than on curves.
        """

    @abstractmethod
    def moved_rigidly(self, chosen: Selection, what: str) -> Ints:
        """Numbers of the unknowns that a rigid link of edges or triangles moves.

        Raises
        ------
        InputError
            Where there are none such.
        """

    def distribution(self) -> Distribution | None:
        """What distributes forces along edges, as `kshell.shell.koiter.along.along_edges`; None where none is known."""
        return None

    @abstractmethod
    def mass(self, density: Floats) -> sp.csr_matrix:
        """Consistent mass matrix (unknowns, unknowns) of a mass per area at `interior_points` of all triangles."""
