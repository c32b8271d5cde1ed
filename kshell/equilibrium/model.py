"""What analyses need of a plate or shell: the one frame that they and the discretisations meet in.

A model is built from a resolved scene and then only read: a structure with its supports and loads, on one mesh with one
element. An analysis takes a model and gives a result; it knows neither plates nor shells, and asks `isinstance(model,
FiniteModel)`
(finite_model.py) where it needs finite deformation, `MovingModel` (moving_model.py) where it follows a motion in time.

Symbols
-------
q       free unknowns, what the supports leave; matrices and load vectors belong to them
x       all unknowns, x = T q + x0 with the prescribed motion x0
K       stiffness at rest with that of elastic supports
f_k     load k of the scene, numbered from 0 as there
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.rigid_modes import Participation, RigidModes
from kshell.errors import InputError
from kshell.result.result import Result
from kshell.scene.loads import Load
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure

Floats = NDArray[np.float64]

NO_DENSITY = "the material has no density: give it, in mass per volume"


@dataclass(frozen=True, eq=False)
class Solved:
    """A linear solution of a model.

    Attributes
    ----------
    x : (unknowns,)
        All unknowns.
    name, why : str
        What solved it, and why that was taken.
    iterations : int
    own : object
        What the model keeps of it for `recover`; of a `FiniteModel` the `LinearSolution`.
    """

    x: Floats
    name: str
    why: str
    iterations: int
    own: Any


class Model(ABC):
    """A plate or shell with its supports and loads.

    Attributes
    ----------
    kind : "plate" or "shell"
    element : str
    order : int
        Polynomial degree.
    reasons : list of str
        Why this model, in words.
    structure : Structure
        What it was built from.
    """

    kind: ClassVar[Literal["plate", "shell"]]
    element: str
    order: int
    reasons: list[str]
    structure: Structure

    # what it is

    @property
    @abstractmethod
    def unknowns(self) -> int:
        """Number of free unknowns q."""

    @abstractmethod
    def warnings(self) -> list[str]:
        """What the user should know about the model."""

    def singular(self) -> dict[int, str]:
        """Corners where stresses grow without bound as the mesh is refined, with their kind, by vertex."""
        return {}

    def warmth(self) -> list[Placed[Load]]:
        """The temperatures that act."""
        return []

    # matrices and vectors of the free unknowns

    @abstractmethod
    def stiffness(self) -> sp.csr_matrix:
        """K (q, q)."""

    @abstractmethod
    def product(self) -> Callable[[Floats], Floats]:
        """q -> K q through strains, which rounds less than the entries of K."""

    @abstractmethod
    def load_vectors(self) -> Floats:
        """(load, q) f_k of every load; initial strains by the forces that hold them back."""

    @abstractmethod
    def motion_vector(self) -> Floats:
        """(q,) what prescribed motion contributes to the right-hand side, - T^T K x0."""

    @abstractmethod
    def expand(self, q: Floats) -> Floats:
        """x = T q, without prescribed motion: for modes and other motions, (q,) or (q, n)."""

    def mass(self) -> sp.csr_matrix:
        """Consistent mass matrix (q, q).

        Raises
        ------
        InputError
            If a material has no density, or the element has no mass matrix.
        """
        raise InputError(f"a {self.kind} with the element {self.element} has no mass matrix: {_OTHER}")

    def geometric_stiffness(self, solved: Solved) -> sp.csr_matrix:
        """Second derivative (q, q) of the work of the membrane forces of a linear solution on the true strains.

        Less that of the work of its loads that turn with the surface.

        Raises
        ------
        InputError
            If the element has no membrane forces, or the stiffness of turning loads is not symmetric.
        """
        raise InputError(f"a {self.kind} with the element {self.element} has no membrane forces: {_OTHER}")

    # vibration

    def rigid_modes(self, mass: sp.csr_matrix) -> RigidModes:
        """Rigid motions that the supports leave, orthonormal in the mass (q, q), by name."""
        raise InputError(f"a {self.kind} with the element {self.element} has no mass matrix: {_OTHER}")

    def participation(self, vectors: Floats) -> Participation:
        """How modes (q, mode) take part in rigid motions of the whole."""
        raise InputError(f"a {self.kind} with the element {self.element} has no mass matrix: {_OTHER}")

    def elimination(self) -> NDArray[np.integer] | None:
        """(q,) the unknown in each place of an order of elimination with little fill; None where none is known."""
        return None

    def energies(self, vectors: Floats) -> Floats:
        """X^T K X (k, k) of motions X (q, k), through strains where the entries of K have lost digits."""
        return np.asarray(vectors.T @ (self.stiffness() @ vectors))

    # loads

    @abstractmethod
    def under(self, factors: Sequence[float], motion: float = 1.0) -> Self:
        """The same structure under its loads times factors, (load,), and its prescribed motion times one.

        Matrices, factorisations and tables that do not depend on loads are shared.
        """

    # linear solution and what comes out

    def prepare(self) -> None:
        """Assemble what `solve` needs; for the clock, `solve` does it too."""
        return

    @abstractmethod
    def solve(self, solver: str = "auto") -> Solved:
        """The linear solution under all loads.

        Raises
        ------
        InputError
            If the structure can move freely, or the solver is not one for it.
        SolveError
            If no answer was reached.
        """

    def solve_ahead(self, models: Sequence[Self], solver: str = "auto") -> None:
        """Solve for all loads together what `solve` of these models, each this one `under` factors, then returns.

        Where a model gains nothing by it, its `solve` does the work as always.

        Raises
        ------
        InputError, SolveError
            As `solve`; nothing is then known of any of the models.
        """
        return

    def respond(self, load: Floats) -> Floats:
        """(q,) or (q, n) unknowns under load vectors on them alone, on the factors of `solve`: for duals.

        Raises
        ------
        InputError
            If the model has no such factors.
        """
        raise InputError(
            f"a {self.kind} with the element {self.element} answers to no single load vector: {_OTHER}"
        )

    @abstractmethod
    def recover(self, solved: Solved) -> Result:
        """Fields, probes, reactions, energies and warnings of a linear solution; the rest is the analysis's to fill."""

    @abstractmethod
    def motion_fields(self, x: Floats) -> Mapping[str, Floats]:
        """Fields at vertices of a motion x by itself, without loads: displacement (vertex, 3), rotation, ..."""

    def motion_at(self, x: Floats, points: Floats) -> Floats:
        """(n, 3) displacement of a motion x by itself, at the points of the surface nearest to (n, 3) points."""
        raise InputError(f"a {self.kind} with the element {self.element} has no response: {_OTHER}")


_OTHER = 'take model = "shell" or another element'
