"""Loads of a shell: from places and values to forces on the unknowns and initial strains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.problem import Follower
from kshell.errors import InputError
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.mesh.orient import WALKED_FORWARD
from kshell.mesh.words import place
from kshell.scene.handlers import Handlers, of_acting
from kshell.scene.loads import (
    EdgeMoment,
    Gravity,
    InitialCurvature,
    InitialStrain,
    LineForce,
    Load,
    PlacedPressure,
    PointForce,
    PointMoment,
    Pressure,
    Snow,
    Temperature,
    Traction,
)
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.scene.thermal import free_strain
from kshell.scene.weights import weights
from kshell.shell.discretisation import Discretisation
from kshell.shell.evaluate import OfNormal, Value
from kshell.shell.initial import StressFree
from kshell.shell.limits import USE_KOITER
from kshell.shell.links import Link

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


HANDLERS = Handlers("is nothing that shells have: leave it out")


@dataclass
class ShellLoads:
    """All loads of a shell.

    Attributes
    ----------
    forces : list of (unknowns,) arrays
        One or more per load; of a load that follows the surface that at rest.
    numbers : list of int
        Of the load in the scene that each of them belongs to.
    followers : dict of int to callable
        By the place in `forces`: the force on a moved surface, and its derivative.
    strains : list of (int, (triangle, r) array)
        Strains without stress, each with the number of its load.
    warnings : list of str
    warmth : list of (int, Placed)
        Temperatures, each with the number of its load.
    warned : list of int
        Of the load that each of the warnings is of.
    """

    forces: list[Floats] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    followers: dict[int, Follower] = field(default_factory=dict)
    strains: list[tuple[int, Floats]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    warmth: list[tuple[int, Placed[Load]]] = field(default_factory=list)
    warned: list[int] = field(default_factory=list)

    @cached_property
    def initial(self) -> Floats | None:
        """(triangle, r) sum of the strains without stress, None where there are none."""
        parts = [strain for _, strain in self.strains]
        return sum(parts[1:], parts[0]) if parts else None

    def times(self, factors: Sequence[float]) -> ShellLoads:
        """The same loads times factors, (load,)."""
        warnings, warned = of_acting(self.warnings, self.warned, factors)
        return ShellLoads(
            [factors[number] * force for force, number in zip(self.forces, self.numbers, strict=True)],
            self.numbers,
            {k: partial(_times, follow, factors[self.numbers[k]]) for k, follow in self.followers.items()},
            [(number, factors[number] * strain) for number, strain in self.strains],
            warnings,
            [(k, replace(p, item=p.item.times(float(factors[k])))) for k, p in self.warmth],
            warned,
        )


def _times(follow: Follower, factor: float, x: Floats) -> tuple[Floats, sp.csr_matrix]:
    force, stiffness = follow(x)
    return factor * force, factor * stiffness


def apply_loads(
    structure: Structure, discretisation: Discretisation, energy: Any, links: Sequence[Link] = ()
) -> ShellLoads:
    """Translate the loads of a structure.

    Parameters
    ----------
    energy : StrainEnergy
        Of the discretisation, for initial strains.
    links : sequence of Link
        Whose points loads may act on.

    Raises
    ------
    InputError
        For loads that do not fit, and those the discretisation does not have.
    """
    builder = _Builder(structure, discretisation, energy, links)
    for number, placed in enumerate(structure.loads):
        builder.number, before = number, len(builder.out.forces)
        HANDLERS.handle(builder, placed, builder.out.warnings)
        builder.out.numbers += [number] * (len(builder.out.forces) - before)
        builder.out.warned += [number] * (len(builder.out.warnings) - len(builder.out.warned))
    return builder.out


def _value(load: Load) -> Value:
    """Values of a load on a surface, for kernels."""
    return OfNormal(load.at) if load.needs_normal else load.at


class _Builder:
    def __init__(
        self, structure: Structure, discretisation: Discretisation, energy: Any, links: Sequence[Link]
    ) -> None:
        self.links, self.masses = links, structure.masses
        self.mesh, self.section = structure.space, structure.section
        self.offset = np.broadcast_to(structure.offset, (len(self.mesh.triangles),))
        self.discretisation, self.energy = discretisation, energy
        self.surface, self.kernel = discretisation.surface, discretisation.loads
        self.number = 0
        self.out = ShellLoads()

    @HANDLERS.of(Pressure, PlacedPressure)
    def _pressure(self, load: Any, placed: Placed[Any]) -> None:
        triangles, value = placed.members(self.mesh), _value(load)
        if load.follower:
            self._require_koiter(load)
            number, surface = len(self.out.forces), self.surface
            self.out.followers[number] = lambda x: self.kernel.follower_pressure(surface, x, value, triangles)
        self._warn_of_opposed_normals(load, triangles)
        self.out.forces.append(self.kernel.pressure(self.surface, value, triangles))

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

    @HANDLERS.of(Traction, Snow)
    def _traction(self, load: Any, placed: Placed[Any]) -> None:
        self.out.forces.append(self.kernel.traction(self.surface, _value(load), placed.members(self.mesh)))

    @HANDLERS.of(Gravity)
    def _gravity(self, load: Any, placed: Placed[Any]) -> None:
        triangles = placed.members(self.mesh)
        points, _ = self.discretisation.interior_points(triangles)
        mass = self.section.mass(triangles, points)
        if not (mass.min(initial=np.inf) > 0.0 or self.masses):
            raise InputError(f"{load}: the material has no density: give it, in mass per volume")
        weight = (mass[..., None] * load.at(points)).reshape(-1, 3)
        # the kernel asks for values at the same points, in the same order
        self.out.forces.append(self.kernel.traction(self.surface, lambda _: weight, triangles))
        for added in weights(self.masses, placed, self.mesh):
            HANDLERS.handle(self, added, self.out.warnings)

    @HANDLERS.of(LineForce)
    def _line_force(self, load: Any, placed: Placed[Any]) -> None:
        edges = placed.members(self.mesh)
        self.out.forces.append(self.kernel.line_force(self.surface, load.at, edges))

    @HANDLERS.of(EdgeMoment)
    def _edge_moment(self, load: Any, placed: Placed[Any]) -> None:
        edges = placed.members(self.mesh)
        inside = edges[self.mesh.edge_counts[edges] > 1]
        if len(inside):
            where = self.mesh.points[self.mesh.edges[inside[0]]].mean(axis=0)
            raise InputError(
                f"{load}: the edge at {place(where)} lies inside the shell, where a bending moment has no outward "
                "side; put it on a boundary edge, or use initial_curvature"
            )
        self.out.forces.append(self.kernel.edge_moment(self.surface, load.at, edges))

    @HANDLERS.of(PointForce, PointMoment)
    def _point(self, load: Any, placed: Placed[Any]) -> None:
        if placed.link is not None:
            link = next(link for link in self.links if link.item is placed.link)
            value = load.at(placed.vertices(self.mesh))[0]
            pair = (value, 0.0 * value) if isinstance(load, PointForce) else (0.0 * value, value)
            self.out.forces.append(link.force(self.discretisation.unknowns, *pair))
            return
        apply = getattr(self.kernel, load.kind)
        for vertex in placed.members(self.mesh):
            value = load.at(self.mesh.points[[vertex]])[0]
            self.out.forces.append(apply(self.surface, int(vertex), value))

    @HANDLERS.of(Temperature)
    def _temperature(self, load: Any, placed: Placed[Any]) -> None:
        def free(triangles: Ints, points: Floats) -> Floats:
            return free_strain(load, self.section, triangles, points, self.offset[triangles])

        self._initial(placed, StressFree(of_section=free))
        self.out.warmth.append((self.number, placed))

    @HANDLERS.of(InitialCurvature)
    def _initial_curvature(self, load: Any, placed: Placed[Any]) -> None:
        # the scene gives w'', the change of curvature of the shell is minus that
        self._initial(placed, StressFree(curvature=lambda points: -load.curvature_at(points)))

    @HANDLERS.of(InitialStrain)
    def _initial_strain(self, load: Any, placed: Placed[Any]) -> None:
        self._initial(placed, StressFree(strain=load.at))

    def _initial(self, placed: Placed[Any], state: StressFree) -> None:
        strain = self.discretisation.initial_strain(self.energy, state, placed.members(self.mesh))
        self.out.strains.append((self.number, strain))

    def _require_koiter(self, load: Any) -> None:
        if self.discretisation.name != "koiter":
            raise InputError(
                f"{load}: a pressure that follows the surface is for Koiter elements: {USE_KOITER}"
            )
