"""The Koiter energy of a team: every process has the triangles of its own, with their stiffness and strains.

The first process has the whole surface too, and stands for the whole energy: it gives the others their rows of the
unknowns, and puts strains, stresses and forces together. It takes a fraction of the room of what is divided.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.distributed.calls import ELSEWHERE, Shared, on_all
from kshell.distributed.matrix import Scattered, Terms
from kshell.distributed.piece import Piece, members_of
from kshell.distributed.refuse import ALONE, INSTEAD
from kshell.distributed.surface_piece import (
    PartSurface,
    SurfaceData,
    SurfacePlaces,
    directors_of,
    section_of,
)
from kshell.distributed.team import Team
from kshell.equilibrium.energy import in_blocks
from kshell.equilibrium.evaluated import Asked, Energy, Linear
from kshell.equilibrium.sparsity import Sparsity
from kshell.errors import InputError
from kshell.material.inelastic import Inelastic
from kshell.shell.koiter.discretisation import KoiterDiscretisation
from kshell.shell.koiter.edges import Directors, rest_directors
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.loads import surface_points
from kshell.shell.koiter.matrices import mass
from kshell.shell.koiter.recovery import KoiterRecovery
from kshell.shell.koiter.strain_tables import strain_tables
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Kept(Shared):
    """Strains of a state and their derivative, of the triangles of each process."""

    def __init__(self, team: Team, linear: Linear) -> None:
        super().__init__(team)
        self.linear = linear


class KoiterPiece(Piece):
    """The energy of the triangles of each process.

    Parameters
    ----------
    team : Team
    members : list of int arrays
        The triangles of each process, ascending.
    surface : Surface
    section : Section
    rest : Directors
        All of the whole, which the first process alone looks at.

    Attributes
    ----------
    energy : Koiter
        Of the triangles of this process, on their unknowns.
    triangles, nodes, rotations : Share
    """

    def __init__(
        self, team: Team, members: Sequence[Ints], surface: Surface, section: Section, rest: Directors
    ) -> None:
        first = team.rank == 0
        places = [SurfacePlaces.of(surface, some) for some in members] if first else []
        super().__init__(team, places, surface.unknowns if first else 0)

        def data(mine: SurfacePlaces) -> tuple[SurfaceData, Section, Directors]:
            points = None if section.varying is None else surface_points(surface, mine.triangles)
            return (
                SurfaceData.of(surface, mine),
                section_of(section, mine.triangles, points),
                directors_of(rest, mine),
            )

        part, own, directors = self.dealt(data)
        self.energy = team.together(lambda: Koiter(PartSurface(part), own, rest=directors))
        self.energy.kept = 0
        counts = (
            (len(surface.mesh.triangles), surface.node_count, rest.vectors.shape[1]) if first else (0, 0, 0)
        )
        self.triangles = self.share(lambda some: some.triangles, counts[0])
        self.nodes = self.share(lambda some: some.nodes, counts[1])
        self.rotations = self.share(lambda some: some.rotations, counts[2])

    def _memory(self, memory: Directors | None) -> Directors | None:
        """That of the triangles of this process; None for that of the rest state."""
        if memory is None:
            return None
        whole: Any = memory
        if memory is ELSEWHERE:
            nothing = np.zeros((3, 0))  # others are dealt their rows
            whole = Directors(nothing, nothing, nothing)
        turned = np.ascontiguousarray(self.rotations.spread(whole.vectors.T).T)
        return Directors(turned, self.nodes.spread(whole.base), self.triangles.spread(whole.angle))

    def _rows(self, of_triangles: Floats | None) -> Floats | None:
        return None if of_triangles is None else self.triangles.spread(of_triangles)

    @on_all
    def strain(self, x: Floats, memory: Directors | None) -> Floats:
        """(triangle, r)."""
        own, mine = self.unknowns.spread(x), self._memory(memory)
        return self.triangles.collect(lambda: self.energy.strain(own, mine))

    @on_all
    def stress(self, strain: Floats) -> Floats:
        """(triangle, r)."""
        own = self.triangles.spread(strain)
        return self.triangles.collect(lambda: self.energy.stress(own))

    @on_all
    def linear_strain(self, x: Floats) -> Floats:
        """(triangle, r)."""
        own = self.unknowns.spread(x)
        return self.triangles.collect(lambda: self.energy.linear_strain(own))

    @on_all
    def linear_forces(self, stress: Floats) -> Floats:
        """(unknowns,)."""
        own = self.triangles.spread(stress)
        return self.unknowns.collect(lambda: self.energy.linear_forces(own))

    @on_all
    def linear_stiffness(self) -> Terms:
        """At rest."""
        return self.terms(self.energy.linear_stiffness)

    @on_all
    def forget(self) -> None:
        """Leave room for factors: no further matrix is expected."""
        self.energy.forget()
        self.energy.__dict__.pop("sparsity", None)

    @on_all
    def geometric_stiffness(self, stress: Floats) -> Terms:
        """Of a stress, at rest."""
        own = self.triangles.spread(stress)
        return self.terms(lambda: self.energy.geometric_stiffness(own))

    @on_all
    def mass(self, density: Floats) -> Terms:
        """Of mass per area at the interior points of all triangles, (triangle, point)."""
        own = self.triangles.spread(density)
        return self.terms(lambda: mass(self.energy.surface, own))

    @on_all
    def evaluate(
        self, x: Floats, derivatives: int, memory: Any, stress: Any, initial: Any, projected: bool
    ) -> Energy:
        """As `Koiter.energy`; the Hessian as `Terms`, and the linear strains as `Kept`."""
        own = (self.unknowns.spread(x), derivatives, self._memory(memory), self._rows(stress))
        strain = self._rows(initial)
        found = self.team.together(lambda: self.energy.energy(*own, strain, projected))
        value = self.team.number(lambda: found.value)
        if derivatives == 0:
            return Energy(value)
        gradient = self.unknowns.collect(lambda: found.gradient)
        hessian = None if found.hessian is None else Terms(self.team, self.unknowns, found.hessian)
        return Energy(value, gradient, hessian, Kept(self.team, found.linear))

    @on_all
    def extrapolated_stress(self, kept: Kept, step: Floats) -> Floats:
        """(triangle, r)."""
        own = self.unknowns.spread(step)
        return self.triangles.collect(lambda: self.energy.extrapolated_stress(kept.linear, own))

    @on_all
    def forces(self, kept: Kept, stress: Floats) -> Floats:
        """(unknowns,)."""
        own = self.triangles.spread(stress)
        return self.unknowns.collect(lambda: self.energy.forces(kept.linear, own))


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
    piece : KoiterPiece
    """

    def __init__(self, team: Team, members: Sequence[Ints], surface: Surface, section: Section) -> None:
        self.team, self.surface, self.section = team, surface, section
        self.tables = strain_tables(surface.order)
        self.blocks = in_blocks(len(surface.mesh.triangles), 2048)
        self.unknowns, self.triangle_unknowns = surface.unknowns, surface.triangle_unknowns
        self.strains = 2 * surface.reference.strains
        self.rest = rest_directors(surface)
        self.piece: KoiterPiece = team.calls.run(KoiterPiece, team, members, surface, section, self.rest)

    def _memory(self, memory: Any) -> Any:
        return None if memory is self.rest else memory

    @cached_property
    def sparsity(self) -> Sparsity:
        """That of the triangles of this process, on their unknowns."""
        return self.piece.energy.sparsity

    def strain(self, x: Floats, memory: Any = None) -> Floats:
        return self.piece.strain(x, self._memory(memory))

    def stress(self, strain: Floats) -> Floats:
        return self.piece.stress(strain)

    def linear_strain(self, x: Floats) -> Floats:
        return self.piece.linear_strain(x)

    def linear_forces(self, stress: Floats) -> Floats:
        return self.piece.linear_forces(stress)

    def linear_stiffness(self) -> Any:
        """The stiffness at rest, `Scattered`."""
        return Scattered(self.piece.linear_stiffness())

    def geometric_stiffness(self, stress: Floats) -> Any:
        """As that of the whole, `Scattered`."""
        return Scattered(self.piece.geometric_stiffness(stress))

    def mass(self, density: Floats) -> Scattered:
        """Of mass per area at the interior points of all triangles."""
        return Scattered(self.piece.mass(density))

    def _energy(self, asked: Asked) -> Energy:
        """As that of the whole; the Hessian is `Scattered`, and the linear strains are `Kept`."""
        found = self.piece.evaluate(*asked._replace(memory=self._memory(asked.memory)))
        return found._replace(hessian=None if found.hessian is None else Scattered(found.hessian))

    def extrapolated_stress(self, linear: Any, step: Floats) -> Floats:
        return self.piece.extrapolated_stress(linear, step)

    def forces(self, linear: Any, stress: Floats) -> Floats:
        return self.piece.forces(linear, stress)


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
        self.members = members_of(team, self.surface.mesh)

    def energy(self, section: Section, inelastic: Inelastic | None = None) -> PartedKoiter:
        if inelastic:
            raise InputError(f"{ALONE} materials that yield (hardening) or relax (relaxation); {INSTEAD}")
        return PartedKoiter(self.team, self.members, self.surface, section)

    def recovery(self, *given: Any, **more: Any) -> KoiterRecovery:
        found = super().recovery(*given, **more)
        found.know_stress()  # while all processes are here: values may be looked at by one of them
        return found
