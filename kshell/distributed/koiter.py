"""The Koiter energy of a team: every process has the stiffness and the strain derivatives of its own triangles.

Strains and stresses by triangle, and forces by unknown, are put together after each evaluation, so that all processes
have those of the whole; they take a hundredth of the room of what stays divided.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.distributed.matrix import Scattered
from kshell.distributed.partition import partition
from kshell.distributed.refuse import ALONE, INSTEAD
from kshell.distributed.team import Team
from kshell.equilibrium.energy import Energy, Linear, in_blocks
from kshell.equilibrium.sparsity import Sparsity
from kshell.errors import InputError
from kshell.material.inelastic import Inelastic
from kshell.mesh.mesh import Mesh
from kshell.shell.koiter.discretisation import KoiterDiscretisation, KoiterRecovery
from kshell.shell.koiter.edges import Directors, rest_directors
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.strain_tables import strain_tables
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# what a surface has by triangle, and what it keeps of that
BY_TRIANGLE = ("edge_sign", "triangle_nodes", "rotation_edge", "triangle_rotations", "triangle_unknowns")
KEPT = ("vertex_normals", "corner_angles", "area_elements", "edge_stretch", "edge_tangents")


class PartedKoiter(Koiter):
    """The energy of a surface, its triangles divided among the processes of a team.

    Parameters
    ----------
    team : Team
    members : list of int arrays
        The triangles of each process.
    surface : Surface
        All of it.
    section : Section
        Of all triangles.

    Attributes
    ----------
    part : Koiter
        Of the triangles of this process, on the unknowns of the whole.
    owner : (unknowns,) int array
        The first process that has a triangle with the unknown.
    """

    def __init__(self, team: Team, members: Sequence[Ints], surface: Surface, section: Section) -> None:
        self.team, self.members, self.own = team, members, members[team.rank]
        self.surface, self.section = surface, section
        self.tables = strain_tables(surface.order)
        self.blocks = in_blocks(len(surface.mesh.triangles), 2048)
        self.unknowns, self.triangle_unknowns = surface.unknowns, surface.triangle_unknowns
        self.strains = 2 * surface.reference.strains
        self.rest = rest_directors(surface)
        mine = self.own
        self.part = team.together(
            lambda: Koiter(part_of(surface, mine), section_of(section, mine), rest=self._mine(self.rest))
        )
        self.owner = np.zeros(self.unknowns, dtype=np.int32)
        for rank in range(team.size - 1, 0, -1):
            self.owner[surface.triangle_unknowns[members[rank]]] = rank
        self.owner[surface.triangle_unknowns[members[0]]] = 0

    def _mine(self, memory: Directors) -> Directors:
        return replace(memory, angle=memory.angle[self.own])

    def _joined(self, work: Callable[[], Floats]) -> Floats:
        return self.team.join(self.members, (self.strains,), work)

    @cached_property
    def sparsity(self) -> Sparsity:
        """That of the part."""
        return self.part.sparsity

    def strain(self, x: Floats, memory: Any = None) -> Floats:
        mine = None if memory is None else self._mine(memory)
        return self._joined(lambda: self.part.strain(x, mine))

    def stress(self, strain: Floats) -> Floats:
        return self._joined(lambda: self.part.stress(strain[self.own]))

    def linear_strain(self, x: Floats) -> Floats:
        return self._joined(lambda: self.part.linear_strain(x))

    def linear_forces(self, stress: Floats) -> Floats:
        return self.team.sum((self.unknowns,), lambda: self.part.linear_forces(stress[self.own]))

    def linear_stiffness(self) -> Any:
        """The stiffness at rest, `Scattered`."""
        return self._scattered(self.part.linear_stiffness)

    def geometric_stiffness(self, stress: Floats) -> Any:
        """As that of the whole, `Scattered`."""
        return self._scattered(lambda: self.part.geometric_stiffness(stress[self.own]))

    def _scattered(self, work: Callable[[], Any]) -> Scattered:
        return Scattered(self.team, self.team.together(work), self.owner)

    def energy(
        self,
        x: Floats,
        derivatives: int = 0,
        memory: Any = None,
        stress: Floats | None = None,
        initial: Floats | None = None,
        projected: bool = False,
    ) -> Energy:
        """As that of the whole; the Hessian is `Scattered`, the linear strains are those of the part."""
        own = self.own
        mine = None if memory is None else self._mine(memory)
        found: Energy | None = None

        def values() -> Floats:
            nonlocal found
            found = self.part.energy(
                x,
                derivatives,
                mine,
                None if stress is None else stress[own],
                None if initial is None else initial[own],
                projected,
            )
            return np.append([] if found.gradient is None else found.gradient, found.value)

        total = self.team.sum((1 + self.unknowns * (derivatives > 0),), values)
        assert found is not None
        value = float(total[-1])
        if derivatives == 0:
            return Energy(value)
        hessian = None if found.hessian is None else Scattered(self.team, found.hessian, self.owner)
        return Energy(value, total[:-1], hessian, found.linear)

    def extrapolated_stress(self, linear: Linear, step: Floats) -> Floats:
        return self._joined(lambda: self.part.extrapolated_stress(linear, step))

    def forces(self, linear: Linear, stress: Floats) -> Floats:
        return self.team.sum((self.unknowns,), lambda: self.part.forces(linear, stress[self.own]))


def part_of(surface: Surface, triangles: Ints) -> Surface:
    """Some triangles of a surface with the nodes and numbers of the whole."""
    out = copy.copy(surface)
    for name in KEPT:
        out.__dict__.pop(name, None)
    for name in BY_TRIANGLE:
        setattr(out, name, getattr(surface, name)[triangles])
    out.mesh = Mesh(surface.mesh.points, surface.mesh.triangles[triangles], source=surface.mesh.source)
    return out


def section_of(section: Section, triangles: Ints) -> Section:
    """The section of some triangles."""

    def some(values: Floats) -> Floats:
        return values[triangles] if len(values) > 1 else values

    varying = section.varying
    if varying is not None:
        whole = varying

        def varying(numbers: Ints, points: Floats) -> tuple[Floats, Floats, Floats]:
            return whole(triangles[numbers], points)

    return replace(
        section,
        membrane=some(section.membrane),
        coupling=some(section.coupling),
        bending=some(section.bending),
        angle=some(section.angle),
        direction=section.direction_of(triangles),
        varying=varying,
    )


class PartedDiscretisation(KoiterDiscretisation):
    """Koiter elements of a team.

    Parameters
    ----------
    team : Team
    *given :
        As of `KoiterDiscretisation`.
    """

    def __init__(self, team: Team, *given: Any) -> None:
        super().__init__(*given)
        self.team = team
        mesh = self.surface.mesh
        part = team.once(lambda: partition(mesh, team.size))
        self.members = [np.flatnonzero(part == rank) for rank in range(team.size)]

    def energy(self, section: Section, inelastic: Inelastic | None = None) -> PartedKoiter:
        if inelastic:
            raise InputError(f"{ALONE} materials that yield (hardening) or relax (relaxation); {INSTEAD}")
        return PartedKoiter(self.team, self.members, self.surface, section)

    def recovery(
        self,
        energy: Koiter,
        x: Floats,
        finite: bool = False,
        memory: Any = None,
        initial: Floats | None = None,
    ) -> KoiterRecovery:
        found = KoiterRecovery(energy, x, finite, memory, initial)
        found.know_stress()  # while all processes are here: values may be looked at by one of them
        return found
