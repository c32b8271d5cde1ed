"""Loads of a scene on a shell: from names and values to forces on the unknowns and initial strains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.problem import Follower
from kshell.errors import InputError
from kshell.material.section import Section
from kshell.mesh.mesh import EDGE_VERTICES, Mesh
from kshell.mesh.orient import WALKED_FORWARD
from kshell.mesh.select import Selection, select
from kshell.mesh.words import place
from kshell.shell.initial import StressFree, initial_strain, temperature
from kshell.shell.koiter.discretisation import USE_KOITER

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass
class SceneLoads:
    """All loads of a scene.

    Attributes
    ----------
    forces : list of (unknowns,) arrays
        One per load; of a load that follows the surface that at rest.
    followers : dict of int to callable
        By the number in `forces`: the force on a moved surface, and its derivative.
    initial : (triangle, r) array or None
        Strains without stress.
    warnings : list of str
    """

    forces: list[Floats] = field(default_factory=list)
    followers: dict[int, Follower] = field(default_factory=dict)
    initial: Floats | None = None
    warnings: list[str] = field(default_factory=list)


def apply_loads(
    loads: list[Any], mesh: Mesh, discretisation: Any, energy: Any, section: Section
) -> SceneLoads:
    """Translate the loads of a scene.

    Parameters
    ----------
    mesh : Mesh
        In space.
    energy : StrainEnergy
        Of the discretisation, for initial strains.
    section : kshell.material.section.Section
        For the weight.

    Raises
    ------
    InputError
        For groups that do not exist or do not fit, and for loads the discretisation does not have.
    """
    builder = _Builder(mesh, discretisation, energy, section)
    for load in loads:
        builder.add(load)
    return builder.out


class _Builder:
    def __init__(self, mesh: Mesh, discretisation: Any, energy: Any, section: Section) -> None:
        self.mesh, self.discretisation, self.energy, self.section = mesh, discretisation, energy, section
        self.surface, self.kernel = discretisation.surface, discretisation.loads
        self.out = SceneLoads()
        self.table: dict[str, Callable[[Any], None]] = {
            "pressure": self._pressure,
            "traction": self._traction,
            "gravity": self._gravity,
            "line_force": self._line_force,
            "edge_moment": self._edge_moment,
            "point_force": self._point,
            "point_moment": self._point,
            "temperature": self._temperature,
            "initial_curvature": self._initial_curvature,
            "initial_strain": self._initial_strain,
        }

    def add(self, load: Any) -> None:
        self.table[load.kind](load)

    def _select(self, load: Any, dimension: int) -> Selection:
        chosen = select(self.mesh, load.on, dimensions=(dimension,), what=f"load {load.kind}")
        if chosen.warning:
            self.out.warnings.append(chosen.warning)
        return chosen

    def _triangles(self, load: Any) -> Ints:
        return np.arange(len(self.mesh.triangles)) if load.on is None else self._select(load, 2).members

    def _pressure(self, load: Any) -> None:
        triangles = self._triangles(load)
        if load.follower:
            self._require_koiter(load)
            number, surface = len(self.out.forces), self.surface
            self.out.followers[number] = lambda x: self.kernel.follower_pressure(
                surface, x, load.at, triangles
            )
        self._warn_of_opposed_normals(load, triangles)
        self.out.forces.append(self.kernel.pressure(self.surface, load.at, triangles))

    def _warn_of_opposed_normals(self, load: Any, triangles: Ints) -> None:
        """Sheets that meet at a branch are oriented one by one: their normals may point to opposite sides."""
        mesh = self.mesh
        flat = mesh.triangle_edges[triangles]
        # +1 where the triangle walks its edge from the lower to the higher vertex
        walked = mesh.triangles[triangles][:, EDGE_VERTICES]
        sign = np.where((walked[..., 1] > walked[..., 0]) == WALKED_FORWARD, 1, -1)
        count = np.bincount(flat.ravel(), minlength=len(mesh.edges))
        total = np.bincount(flat.ravel(), sign.ravel(), minlength=len(mesh.edges))
        opposed = np.flatnonzero((count == 2) & (np.abs(total) == 2))
        if len(opposed):
            where = place(mesh.points[mesh.edges[opposed[0]]].mean(axis=0))
            self.out.warnings.append(
                f"{load}: the normals of two sheets that meet at {where} point to opposite sides, so the pressure "
                "changes its direction there; use traction, a vector in space, or one pressure for each sheet"
            )

    def _traction(self, load: Any) -> None:
        self.out.forces.append(self.kernel.traction(self.surface, load.at, self._triangles(load)))

    def _gravity(self, load: Any) -> None:
        triangles = self._triangles(load)
        points, _ = self.discretisation.interior_points(triangles)
        mass = self.section.mass(triangles, points)
        if not mass.min(initial=np.inf) > 0.0:
            raise InputError(f"{load}: the material has no density: give it, in mass per volume")
        weight = (mass[..., None] * load.at(points)).reshape(-1, 3)
        # the kernel asks for values at the same points, in the same order
        self.out.forces.append(self.kernel.traction(self.surface, lambda _: weight, triangles))

    def _line_force(self, load: Any) -> None:
        edges = self._select(load, 1).members
        self.out.forces.append(self.kernel.line_force(self.surface, load.at, edges))

    def _edge_moment(self, load: Any) -> None:
        edges = self._select(load, 1).members
        inside = edges[self.mesh.edge_counts[edges] > 1]
        if len(inside):
            where = self.mesh.points[self.mesh.edges[inside[0]]].mean(axis=0)
            raise InputError(
                f"{load}: the edge at {place(where)} lies inside the shell, where a bending moment has no outward "
                "side; put it on a boundary edge, or use initial_curvature"
            )
        self.out.forces.append(self.kernel.edge_moment(self.surface, load.at, edges))

    def _point(self, load: Any) -> None:
        apply = getattr(self.kernel, load.kind)
        for vertex in self._select(load, 0).members:
            value = load.at(self.mesh.points[[vertex]])[0]
            self.out.forces.append(apply(self.surface, int(vertex), value))

    def _temperature(self, load: Any) -> None:
        def gradient(points: Floats) -> Floats:
            return -load.curvature_at(points)[..., 0]  # expansion times gradient

        self._initial(load, temperature(load.strain_at, gradient))

    def _initial_curvature(self, load: Any) -> None:
        # the scene gives w'', the change of curvature of the shell is minus that
        self._initial(load, StressFree(curvature=lambda points: -load.curvature_at(points)))

    def _initial_strain(self, load: Any) -> None:
        self._initial(load, StressFree(strain=load.at))

    def _initial(self, load: Any, state: StressFree) -> None:
        strain = initial_strain(self.energy, state, self._triangles(load))
        self.out.initial = strain if self.out.initial is None else self.out.initial + strain

    def _require_koiter(self, load: Any) -> None:
        if self.discretisation.name != "koiter":
            raise InputError(
                f"{load}: a pressure that follows the surface is for Koiter elements: {USE_KOITER}"
            )
