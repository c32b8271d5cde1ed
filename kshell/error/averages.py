"""Membrane forces and moments of a Koiter shell against their continuous averages: an estimate of its error.

With N* and M* the means of N and M at Lagrange nodes, taken as tensors in space over the triangles of one smooth piece
with one section, and where a triangle is alone in a corner those of `corner_fits.py`,

    eta_T^2 = int over T of (N - N*) : E + (M - M*) : kappa,   (E, kappa) the elastic strains of the differences,

more on foundations (`foundations.py`).

Of a quantity with the dual z, sum over T of eta_T eta*_T is near its error: 1.5 times in the median for order 2, 2.2
times for orders 3 and 4, on 12 shells with three meshes each, regular ones and such cut at random; twice the sum was
above the error in 94 of these 97 (below: a hemisphere of 8 and 20 triangles of order 2, and a roof whose quadratic
triangles were cut). Products without their absolute values are sharper but not safe.

Source: Zienkiewicz & Zhu, Int. J. Numer. Meth. Eng. 33 (1992) 1331-1364, 1365-1382.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import triangle_rule
from kshell.error.corner_fits import NARROW, SINGLE, CornerFits
from kshell.error.fold_ends import hidden_at_fold_ends
from kshell.error.foundations import HiddenLayers, hidden_by_foundations
from kshell.error.geometry_share import curvature_of_triangles
from kshell.shell.frames import (
    components,
    contravariant_to_frame,
    covariant_to_frame,
    in_frame,
    in_space,
    tangent_frame,
)
from kshell.shell.koiter.discretisation import KoiterDiscretisation
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.numbering import NumberedMesh
from kshell.shell.koiter.surface import Surface
from kshell.shell.problem import ShellProblem
from kshell.shell.reference import first_derivatives, lagrange, lattice
from kshell.shell.section import section_at
from kshell.shell.vectors import cross, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CENTROID = np.array([[1 / 3, 1 / 3]])
SAME = 1e-9  # relative difference of stiffnesses that is none


class Averages:
    """Where the averages of a shell are taken, and what its triangles weigh.

    Parameters
    ----------
    problem : ShellProblem
        Of the Koiter element.

    Attributes
    ----------
    area : (triangle,)
    hidden : (triangle,)
        By what energies of differences are multiplied because of foundations, and of folds that end at clamps.
    why_not : str
        Why they do not tell the error of every triangle, if so.
    """

    def __init__(self, problem: ShellProblem) -> None:
        discretisation = problem.discretisation
        assert isinstance(discretisation, KoiterDiscretisation)
        assert isinstance(problem.energy, Koiter)
        self.energy = problem.energy
        surface = discretisation.surface
        mesh = surface.mesh
        degree = max(surface.order - 1, 1)
        nodes = lattice(degree)
        node = NumberedMesh(mesh, degree).triangle_nodes.astype(np.int64)
        pieces = _pieces(problem, discretisation)
        key = pieces[:, None] * (int(node.max()) + 1) + node
        _, number = np.unique(key.ravel(), return_inverse=True)
        self.number: Ints = number.reshape(node.shape)
        self._psi = lagrange(surface.order - 1, nodes)
        self._strains = surface.reference.strains
        at = _Places(self.energy, surface, nodes)
        self._at = at
        position = np.einsum(
            "pn,tnx->tpx", lagrange(surface.order, nodes), surface.nodes[surface.triangle_nodes]
        )
        self._fits = CornerFits(mesh.triangles, mesh.triangle_edges, pieces, degree, position, at.axes)
        single, narrow = self._fits.untold(surface.order), self._fits.narrow(surface.order)
        self._untold = single | narrow
        self.why_not = SINGLE if single.any() else NARROW if narrow.any() else ""
        self.area: Floats = at.area.mean(axis=1) / 2.0
        self._weight = np.repeat(self.area, node.shape[1])
        self._total = np.bincount(self.number.ravel(), self._weight)
        middle = _Places(self.energy, surface, CENTROID)
        self._middle = middle.axes
        stiffness = np.concatenate(
            [np.concatenate([middle.a, middle.b], axis=-1), np.concatenate([middle.b, middle.d], axis=-1)],
            axis=-2,
        )
        self._compliance: Floats = np.linalg.inv(stiffness[:, 0])  # (1 or triangle, 6, 6)
        self.hidden = _hidden(problem, surface, middle)
        bends, stretches = (np.trace(m[:, 0], axis1=1, axis2=2) for m in (middle.d, middle.a))
        thickness = np.sqrt(12.0 * bends / stretches)
        self.hidden *= hidden_at_fold_ends(problem.structure, discretisation.patches()[0], thickness)
        curvature = curvature_of_triangles(problem.space)
        self._layers = None
        if surface.order > 1 and curvature.any():
            with np.errstate(divide="ignore"):
                layers = HiddenLayers(problem.space, surface.order, curvature, middle.a[:, 0], middle.d[:, 0])
            self._layers = layers if layers.any else None
        xi, weights = triangle_rule(2 * degree)
        values = lagrange(degree, xi)
        self._mass = 2.0 * np.einsum("q,qi,qj->ij", weights, values, values)

    @property
    def told(self) -> bool:
        """Whether the averages tell the error of every triangle."""
        return not self._untold.any()

    def local(self, strain: Floats) -> Floats:
        """(triangle,) eta_T^2 of strains (triangle, 2 r)."""
        r = self._strains
        stress = self.energy.stress(strain)
        covariant, contravariant = (
            self._psi @ part.reshape(len(part), -1, 3) for part in (strain[:, :r], stress[:, r:])
        )
        off = [self._off(tensor) for tensor in self._at.forces(covariant, contravariant)]
        both = np.concatenate(off, axis=2)  # (triangle, node, 6) in the material axes of the middle
        energy = (self._mass @ both @ self._compliance * both).sum(axis=(1, 2))
        own = np.asarray(np.maximum(self.area * self.hidden * energy, 0.0))
        if self._layers is not None:
            bent, soft = off[1], self._compliance[:, 3:, 3:]
            moments = self.area * (self._mass @ bent @ soft * bent).sum(axis=(1, 2))
            stretched = 0.5 * (strain[:, :r] * stress[:, :r]).sum(axis=1)
            own += self._layers.energy(np.maximum(stretched, 0.0), moments)
        own[self._untold] = own.max()  # these first
        return own

    def _off(self, tensor: Floats) -> Floats:
        """(triangle, node, 3) a tensor in the axes of its nodes less its average, in the axes of the middle."""
        spatial = in_space(tensor, self._at.axes)
        place = self.number.ravel()
        mean = np.stack(
            [np.bincount(place, self._weight * column) / self._total for column in spatial.reshape(-1, 6).T],
            axis=1,
        )
        average = mean[self.number]
        here = self._fits.triangles, self._fits.nodes
        average[here] = in_space(self._fits.values(tensor), self._at.axes[here])
        return in_frame(spatial - average, self._middle)


def hidden(problem: ShellProblem) -> Floats:
    """`Averages.hidden` alone."""
    surface = problem.discretisation.surface
    if problem.springs is None:
        return np.ones(len(surface.mesh.triangles))
    return _hidden(problem, surface, _Places(problem.energy, surface, CENTROID))


def _hidden(problem: ShellProblem, surface: Surface, middle: _Places) -> Floats:
    normal, bending, membrane = middle.axes[:, 0, 2], middle.d[:, 0], middle.a[:, 0]
    return hidden_by_foundations(problem.structure, surface.order, normal, bending, membrane)


class _Places:
    """Material axes and the section at reference points of all triangles.

    Attributes
    ----------
    axes : (triangle, point, 3, 3)
        Rows e_1, e_2, n.
    area : (triangle, point)
        Area element.
    a, b, d : (triangle or 1, point or 1, 3, 3)
    """

    def __init__(self, energy: Koiter, surface: Surface, points: Floats) -> None:
        section, chosen = energy.section, np.arange(len(surface.mesh.triangles))
        x = surface.tangents(first_derivatives(surface.order, points))

        def position() -> Floats:
            nodes = surface.nodes[surface.triangle_nodes]
            return np.asarray(np.einsum("pn,tnx->tpx", lagrange(surface.order, points), nodes))

        self.a, self.b, self.d, angle = section_at(section, chosen, position)
        e1, e2, n = tangent_frame(x, section.direction, angle)
        self.axes: Floats = np.moveaxis(np.stack([e1, e2, n]), (0, 1), (2, 3))
        self.area: Floats = norm(cross(x[0], x[1]))
        f = components(x, e1, e2)
        self._strain = np.moveaxis(covariant_to_frame(f), (0, 1), (2, 3))
        self._stress = np.moveaxis(contravariant_to_frame(f) / self.area**2, (0, 1), (2, 3))

    def forces(self, covariant: Floats, contravariant: Floats) -> tuple[Floats, Floats]:
        """N and M (triangle, point, 3) in the material axes from E_ab and M^ab."""
        e = self._strain @ covariant[..., None]
        moment = self._stress @ contravariant[..., None]
        bent = moment - self.b @ e
        force = self.a @ e + self.b @ np.linalg.solve(np.broadcast_to(self.d, (*bent.shape[:2], 3, 3)), bent)
        return force[..., 0], moment[..., 0]


def _pieces(problem: ShellProblem, discretisation: KoiterDiscretisation) -> Ints:
    """(triangle,) smooth pieces with one stiffness each."""
    smooth = discretisation.patches()[0].astype(np.int64)
    section = problem.energy.section
    if len(section.membrane) == 1 or not problem.section.constant_per_triangle:
        return smooth
    whole = np.concatenate(
        [m.reshape(len(m), -1) / np.abs(m).max() for m in (section.membrane, section.bending)], axis=1
    )
    _, kind = np.unique(np.round(whole / SAME), axis=0, return_inverse=True)
    kind = kind.ravel()
    if len(kind) != len(smooth):
        return smooth
    return np.asarray(smooth * (int(kind.max()) + 1) + kind, dtype=np.int64)
