"""What is dealt out of a plate: some triangles, their numbers, and the weights of its forms there.

Straight triangles with nothing at their vertices are as in the whole. At those that supports, lines of jumps or curved
edges touch, the unknowns are combinations of degrees of freedom; the first process gives the maps. What follows curved
edges or varies is dealt out at the points of quadrature. Nothing else is needed of the whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.elements import PlateElement
from kshell.mesh.mesh import Mesh
from kshell.plate.domain import BLOCK, Domain
from kshell.plate.forms import AreaForm, Bending, Weights
from kshell.plate.layout import Layout
from kshell.plate.pattern import ranges
from kshell.plate.problem import PlateProblem
from kshell.plate.reduction import Reduction

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class PlatePlaces:
    """The numbers in the whole of what some triangles have, each ascending.

    Attributes
    ----------
    triangles, vertices, edges, unknowns : int arrays
    sizes : (node,) int array
        Unknowns of each vertex, then of each edge.
    turned : (triangle,) bool array
        Which triangles have unknowns that are no multiples of their degrees of freedom.
    """

    triangles: Ints
    vertices: Ints
    edges: Ints
    unknowns: Ints
    sizes: Ints
    turned: NDArray[np.bool_]

    @classmethod
    def of(cls, problem: PlateProblem, members: NDArray[np.integer]) -> PlatePlaces:
        """Those of some triangles of a plate, which ascend."""
        mesh, reduction, triangles = problem.mesh, problem.reduction, members.astype(np.int64)
        corners = mesh.triangles[triangles]
        vertices = np.unique(corners).astype(np.int64)
        edges = np.unique(mesh.triangle_edges[triangles]).astype(np.int64)
        starts = np.concatenate([[0], np.cumsum(reduction.sizes)])
        nodes = np.concatenate([vertices, len(mesh.points) + edges])
        turned = np.isin(triangles, reduction.slaves.triangles)
        if problem.layout.per_vertex > 1:
            turned |= (reduction.vertex_place[corners] >= 0).any(axis=1)
        sizes = reduction.sizes[nodes]
        return cls(triangles, vertices, edges, ranges(starts[nodes], sizes), sizes, turned)


@dataclass(frozen=True)
class PlateData:
    """What makes a `PlatePart`: arrays alone, in numbers of the part.

    Attributes
    ----------
    points, triangles : arrays
    scale : (dof,) array
        As of a `Layout` with one fan at each vertex.
    unknown : (dof,) int array
        As of a `Reduction` where nothing is turned.
    sizes : (node,) int array
    turned : (m,) int array
        Triangles that have maps.
    maps : (m, local, column) array
        Physical degrees of freedom of a triangle from its unknowns.
    columns : (m, column) int array
        These unknowns, -1 where there is none.
    """

    points: Floats
    triangles: NDArray[np.int32]
    scale: Floats
    unknown: NDArray[np.int32]
    sizes: Ints
    turned: Ints
    maps: Floats
    columns: NDArray[np.int32]

    @classmethod
    def of(cls, problem: PlateProblem, places: PlatePlaces) -> PlateData:
        """That of some triangles of a plate."""
        mesh, layout, reduction = problem.mesh, problem.layout, problem.reduction
        corners = np.searchsorted(places.vertices, mesh.triangles[places.triangles]).astype(np.int32)
        dofs = np.concatenate([layout.vertex_dofs(places.vertices).ravel(), layout.edge_dofs(places.edges)])
        turned, local = places.triangles[places.turned], layout.element.count
        maps, columns = np.zeros((0, local, local)), np.zeros((0, local), dtype=np.int32)
        if len(turned):
            every = np.broadcast_to(np.eye(local), (len(turned), local, local))
            maps, columns = reduction.local_transform(turned, layout.triangle_dofs(turned), every)

        def named(unknown: NDArray[np.int32]) -> NDArray[np.int32]:
            return np.where(unknown < 0, -1, np.searchsorted(places.unknowns, unknown)).astype(np.int32)

        return cls(
            mesh.points[places.vertices],
            corners,
            layout.scale[dofs],
            named(reduction.unknown[dofs]),
            places.sizes,
            np.flatnonzero(places.turned),
            maps,
            named(columns),
        )


class PartReduction(Reduction):
    """The unknowns of a part.

    Parameters
    ----------
    layout : Layout
        Of the part.
    data : PlateData
    """

    def __init__(self, layout: Layout, data: PlateData) -> None:
        self.layout, self.sizes, self.unknown = layout, data.sizes, data.unknown
        self.count = int(data.sizes.sum())
        self.particular = np.zeros(layout.count)  # what is prescribed is of the first process
        self._maps, self._columns = data.maps, data.columns
        self._map = np.full(len(layout.mesh.triangles), -1, dtype=np.int64)
        self._map[data.turned] = np.arange(len(data.turned))

    def local_transform(
        self, triangles: Ints, dofs: Ints, transform: Floats
    ) -> tuple[Floats, NDArray[np.int32]]:
        at = self._map[triangles]
        if at[0] < 0:
            return transform * self.layout.scale[dofs][:, None, :], self.unknown[dofs]
        return transform @ self._maps[at], self._columns[at]


class PlatePart:
    """Some triangles of a plate by themselves.

    Parameters
    ----------
    element : PlateElement
    data : PlateData
    """

    def __init__(self, element: PlateElement, data: PlateData) -> None:
        mesh = Mesh(data.points, data.triangles)
        self.element = element
        self.domain = Domain(mesh, False)
        self.layout = Layout(mesh, element)
        self.layout.__dict__["scale"] = data.scale  # that of a vertex knows all edges there
        self.reduction = PartReduction(self.layout, data)


# triangles of a part, and the weights of a form there
Batch = tuple[Ints, Weights]


def batches_of(form: AreaForm, places: PlatePlaces) -> list[Batch]:
    """The weights of a form in some triangles: those that have maps, and those with curved edges, apart."""
    found: dict[tuple[bool, bool], list[Batch]] = {}
    for block, _ in form.blocks():
        at = np.minimum(np.searchsorted(places.triangles, block), len(places.triangles) - 1)
        here = places.triangles[at] == block
        for turned in (False, True):
            mine = here & (places.turned[at] == turned)
            if mine.any():
                curved = bool(form.domain.is_curved[block[0]])
                found.setdefault((turned, curved), []).append((at[mine], form.weights(block[mine])))
    return [_joined(parts) for parts in found.values()]


def _joined(parts: list[Batch]) -> Batch:
    first = parts[0][1]
    xi = first.xi
    if xi is not None and xi.ndim == 3:
        xi = np.concatenate([weights.xi for _, weights in parts if weights.xi is not None])
    weight = np.concatenate([weights.weight for _, weights in parts])
    return np.concatenate([triangles for triangles, _ in parts]), replace(first, weight=weight, xi=xi)


class PartForm(AreaForm):
    """A form on a part.

    Parameters
    ----------
    part : PlatePart
    bends : bool
        Whether it is the energy of curvatures, in which planes have no share.
    batches : list of Batch
    """

    everywhere = False

    def __init__(self, part: PlatePart, bends: bool, batches: list[Batch]) -> None:
        self.domain, self.element, self.bends, self._batches = part.domain, part.element, bends, batches
        self._blocks = [block for triangles, _ in batches for block in in_blocks(triangles)]
        count = len(part.domain.mesh.triangles)
        self._batch, self._place = np.zeros(count, dtype=np.int8), np.zeros(count, dtype=np.int32)
        for number, (triangles, _) in enumerate(batches):
            self._batch[triangles], self._place[triangles] = number, np.arange(len(triangles))

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        for block in self._blocks:
            yield block, block

    def weights(self, triangles: Ints) -> Weights:
        return self._batches[self._batch[triangles[0]]][1].some(self._place[triangles])


def in_blocks(triangles: Ints) -> list[Ints]:
    """Triangles in blocks, the same ones each time: what was found of the last is kept by what they are."""
    return [triangles[start : start + BLOCK] for start in range(0, len(triangles), BLOCK)]


def dealt_forms(forms: list[AreaForm], places: PlatePlaces) -> list[tuple[bool, list[Batch]]]:
    """What makes a `PartForm` of each form."""
    return [(isinstance(form, Bending), batches_of(form, places)) for form in forms]
