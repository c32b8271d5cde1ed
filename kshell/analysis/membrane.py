"""Membrane forces of a plate under loads in its plane: plane stress on the same mesh, with the same groups.

The plate's own elements bend only. Its state in the plane is that of a flat shell of cubic elements without its
bending: displacements u_x, u_y alone, with all loads and supports that the scene has there. Simple supports hold a
plate across its plane only; what is not held in the plane by others stays where it is, as long as the loads are in
equilibrium.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.linear import solve_linear
from kshell.equilibrium.reduction import Reduction
from kshell.equilibrium.rigid_modes import RigidModes, RigidPart, rigid_modes
from kshell.errors import InputError
from kshell.mesh.select import Selection
from kshell.plate.domain import Domain
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.scene.supports import Clamped, Fixed, SimplySupported
from kshell.shell.koiter.model import KoiterModel
from kshell.shell.problem import ShellProblem
from kshell.shell.reference import lagrange, lattice

Floats = NDArray[np.float64]

ORDER = 3
DEGREE = 2  # of N in a triangle: strains of cubic displacements
# work of the loads on a free motion, relative, that is rounding
BALANCED = 1e-8
# part of a load, or of the size of the mesh, that is rounding
ROUNDED = 1e-10
ALIKE = 1e-9  # relative variation of a membrane force that is rounding
STEPS = 4  # of Newton's method for places in triangles with curved edges


class UniformState(NamedTuple):
    """Membrane forces that are alike everywhere.

    Attributes
    ----------
    force : (2, 2) array
        N in x, y.
    """

    force: Floats

    @property
    def degree(self) -> int:
        """Of N as a polynomial in each triangle."""
        return 0

    def at(self, triangles: np.ndarray, xi: Floats) -> Floats:
        """N (n, point, 2, 2) at reference points (n, point, 2) of triangles (n,)."""
        return np.broadcast_to(self.force, (*xi.shape[:2], 2, 2))


class MembraneState(NamedTuple):
    """Membrane forces of a flat mesh.

    Attributes
    ----------
    nodes : (triangle, 6, 2, 2) array
        N in x, y at the nodes of quadratic polynomials.
    model : KoiterModel
    domain : Domain
        Of the plate.
    """

    nodes: Floats
    model: KoiterModel
    domain: Domain

    @property
    def degree(self) -> int:
        """Of N as a polynomial in each triangle."""
        return DEGREE

    @property
    def uniform(self) -> UniformState | None:
        """The same where it is alike everywhere, None elsewhere."""
        force = self.nodes.reshape(-1, 2, 2)
        mean = force.mean(axis=0)
        return UniformState(mean) if np.abs(force - mean).max() <= ALIKE * np.abs(mean).max() else None

    def at(self, triangles: np.ndarray, xi: Floats) -> Floats:
        """N (n, point, 2, 2) at reference points (n, point, 2) of the plate's triangles (n,)."""
        if self.domain.is_curved[triangles[0]]:
            xi = self._in_curved(triangles, xi)
        shape = lagrange(DEGREE, xi.reshape(-1, 2)).reshape(*xi.shape[:2], -1)
        n = len(triangles)
        values = shape @ self.nodes[triangles].reshape(n, shape.shape[-1], 4)
        return np.asarray(values.reshape(*xi.shape[:2], 2, 2))

    def _in_curved(self, triangles: np.ndarray, xi: Floats) -> Floats:
        """Reference points of the curved triangles at the places of points of the straight ones."""
        surface = self.model.problem.discretisation.surface
        corners = surface.nodes[surface.triangle_nodes[triangles]][..., :2]  # (n, node, 2)
        straight = self.domain.affine(triangles)
        xy = straight.corners[:, None, 0] + xi @ np.swapaxes(straight.jacobian, 1, 2)
        out = xi.copy()
        for _ in range(STEPS):
            shape = lagrange(self.model.order, out.reshape(-1, 2)).reshape(*out.shape[:2], -1)
            miss = xy - shape @ corners
            out = out + (straight.inverse[:, None] @ miss[..., None])[..., 0]
        return out

    @property
    def size(self) -> float:
        """Largest entry."""
        return float(np.abs(self.nodes).max())


def membrane_state(
    structure: Structure, factors: Sequence[float], motion: float = 1.0, order: int = ORDER
) -> MembraneState:
    """The state under the loads of a flat structure times factors (load,), and its prescribed motion times one.

    Parameters
    ----------
    order : int
        Of the displacements.

    Raises
    ------
    InputError
        If the loads push the plate away in its plane, or act along what is held on their own edge.
    """
    flat = replace(structure, supports=plane_only(structure), movable=True)
    model = KoiterModel(flat, order)
    problem = model.problem.under(factors, motion)
    basis = _plane_columns(problem)
    load = problem.load
    given = problem.reduction.given.copy()
    given[_across(problem)] = 0.0
    _require_felt(structure, problem, basis)
    basis = _without_free_motion(problem, basis, load)
    reduction = Reduction(basis, given, problem.reduction.rotations)
    springs = problem.springs
    solution = solve_linear(problem.energy, load, reduction, springs, problem.loads.initial)
    recovery = problem.discretisation.recovery(problem.energy, solution.x, initial=problem.loads.initial)
    every = np.arange(len(structure.space.triangles))
    nodes = _forces(recovery, every)
    return MembraneState(nodes, model, Domain(structure.space, curved=True))


def plane_only(structure: Structure) -> tuple[Placed[Any], ...]:
    """What the supports hold in the plane, and nothing else."""
    out = []
    for placed in in_plane(structure):
        support = placed.item
        if not isinstance(support, Clamped | Fixed):
            out.append(placed)
            continue
        letters = "".join(letter for letter in support.freedoms if letter in "xy")
        if letters:
            value = support.value
            if isinstance(value, tuple):
                value = (value[0], value[1], 0.0)
            elif value is not None and not callable(value):
                value = None  # a number prescribes w
            axes = getattr(support, "axes", None)
            out.append(replace(placed, item=Fixed(support.on, letters, value, axes)))
    return tuple(out)


def in_plane(structure: Structure) -> tuple[Placed[Any], ...]:
    """The supports as they act in the plane: simple ones hold w alone."""
    out = []
    for placed in structure.supports:
        support = placed.item
        if isinstance(support, SimplySupported):
            value = None if support.value is None else support.value
            out.append(replace(placed, item=Fixed(support.on, "z", _across_only(value))))
        else:
            out.append(placed)
    return tuple(out)


def _across_only(value: Any) -> Any:
    return (0.0, 0.0, value[2]) if isinstance(value, tuple) else value


def _across(problem: Any) -> np.ndarray:
    """Unknowns other than displacements along x and y."""
    surface = problem.discretisation.surface
    number = np.arange(surface.unknowns)
    return np.flatnonzero((number >= surface.rotation_start) | (number % 3 == 2))


def _plane_columns(problem: Any) -> sp.csc_matrix:
    """Free motions in the plane."""
    basis = problem.reduction.basis.tocsc(copy=True)
    mask = np.ones(basis.shape[0])
    mask[_across(problem)] = 0.0
    kept = sp.diags(mask) @ basis
    weight = np.asarray(abs(kept).sum(axis=0)).ravel()
    return kept.tocsc()[:, np.flatnonzero(weight > 0.5)]


def _require_felt(structure: Structure, problem: ShellProblem, basis: sp.csc_matrix) -> None:
    """Refuse a load in the plane all of which acts along what is held where it acts."""
    across = _across(problem)
    for number, force in zip(problem.loads.numbers, problem.loads.forces, strict=True):
        here = force.copy()
        here[across] = 0.0
        if np.abs(here).max(initial=0.0) <= ROUNDED * np.abs(force).max(initial=0.0):
            continue
        if np.abs(basis.T @ here).max(initial=0.0) > ROUNDED * np.abs(here).max():
            continue
        load, mesh = structure.loads[number], structure.space
        vertices = load.vertices(mesh)
        holding = [
            str(placed.item)
            for placed in structure.supports
            if all(
                np.abs(placed.vertices(mesh) - x).max(axis=1).min() <= ROUNDED * mesh.size for x in vertices
            )
        ]
        raise InputError(
            f"{load.item} acts along what {' and '.join(holding) or 'a support'} holds at the same place, so it "
            'presses nothing: hold less there, for example fix = "zr" instead of clamped on a loaded edge'
        )


def _free_motions(problem: ShellProblem, basis: sp.csc_matrix) -> RigidModes:
    """Rigid motions in the plane that nothing holds."""
    discretisation = problem.discretisation
    centre, size = discretisation.extent()
    motions = discretisation.rigid_motions(centre, 1.0)[:, [0, 1, 5]]
    part = RigidPart(motions, np.eye(6)[:, [0, 1, 5]], centre, size)
    unit = sp.identity(basis.shape[1], format="csr")
    springs = None if problem.springs is None else (basis.T @ problem.springs @ basis).tocsr()
    return rigid_modes([part], basis, unit, springs)


def _without_free_motion(problem: ShellProblem, basis: sp.csc_matrix, load: Floats) -> sp.csc_matrix:
    """The motions less as many unknowns as the plate moves rigidly in its plane, where it is loaded in equilibrium."""
    free = _free_motions(problem, basis)
    if not free.names:
        return basis
    force = basis.T @ load
    work = np.abs(free.vectors.T @ force)
    if problem.loads.initial is None and work.max() > BALANCED * np.linalg.norm(force):
        raise InputError(
            "the loads in the plane of the plate are not in equilibrium, and nothing holds it there against a "
            f'{free.names[int(work.argmax())]}: hold it with fix = "x" or "y" somewhere, or load both sides'
        )
    from scipy.linalg import qr

    _, _, chosen = qr(free.vectors.T, mode="economic", pivoting=True)
    keep = np.setdiff1d(np.arange(basis.shape[1]), chosen[: len(free.names)])
    return basis[:, keep]


def held_in_plane(structure: Structure) -> Structure:
    """A flat structure as a shell: simple supports hold w alone, rigid motions in the plane are held at vertices.

    Raises
    ------
    InputError
        If the loads push it away in its plane.
    """
    flat = replace(structure, supports=in_plane(structure), movable=True)
    problem = KoiterModel(flat, 1).problem
    basis = _plane_columns(problem)
    _without_free_motion(problem, basis, problem.load)  # for its message
    free = _free_motions(problem, basis)
    supports = list(flat.supports)
    if free.names:
        from scipy.linalg import qr

        vertices = len(structure.space.points)
        rows = (basis @ free.vectors)[: 3 * vertices]
        rows[2::3] = 0.0
        _, _, chosen = qr(rows.T, mode="economic", pivoting=True)
        for row in chosen[: len(free.names)].tolist():
            x, y, z = structure.space.points[row // 3].tolist()
            pin = Fixed((x, y, z), "xy"[row % 3])
            place = Selection(0, np.array([row // 3], dtype=np.int32), f"({x:g}, {y:g})")
            supports.append(Placed(pin, place))
    return replace(structure, supports=tuple(supports))


def _forces(recovery: Any, triangles: np.ndarray) -> Floats:
    """(triangle, 6, 2, 2) N in x, y."""
    found = recovery.resultants(lattice(DEGREE), triangles)
    axes = found.axes[..., :2, :2]  # rows e_1, e_2
    xx, yy, xy = np.moveaxis(found.membrane_force, -1, 0)
    local = np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2)
    return np.asarray(np.swapaxes(axes, -1, -2) @ local @ axes)
