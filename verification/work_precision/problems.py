"""What a comparison is about: a plate or a shell, with references, meshes, and the methods that run on it.

All methods get the same grids, as triangles or as quadrilaterals; NGSolve meshes the disk itself. A mesh comes as
arrays that depend on what a driver takes, its feed:

scene                       for kshell: points, triangles, boundary edges by group, and middles where edges are curved
plane                       points, triangles, boundary edges
nodes 3, nodes 4, nodes 8   cells of so many nodes with everything that holds and loads them, see `nodes`
count                       cells per side: the driver makes its mesh from surfaces.py
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kshell as ks
from kshell.verify.cases.plate import plate
from verification.peers.surfaces import SURFACES
from verification.work_precision import nodes

Arrays = dict[str, NDArray[Any]]
QUANTITIES = ("compliance", "w", "M")
LETTERS = {"clamped": "C", "supported": "S"}
GROUP = "group "


@dataclass(frozen=True)
class Reference:
    """A value, and its relative uncertainty: errors below that mean nothing."""

    value: float
    uncertainty: float = 1e-13


@dataclass(frozen=True)
class Comparison:
    """What all of them have.

    Attributes
    ----------
    id, title : str
    references : dict of "compliance" (load times displacement), "w", "M" to Reference
    plan : dict of method to cells per side, coarse to fine
    """

    id: str
    title: str
    references: dict[str, Reference]
    plan: dict[str, tuple[int, ...]]


@dataclass(frozen=True)
class PlateComparison(Comparison):
    """A plate of bending stiffness 1, nu = 0.3, under a pressure, all edges alike.

    Attributes
    ----------
    kind : "clamped" or "supported"
    build : function of the cells per side
    place : point where w and M_xx are read
    load : the pressure, an expression of x and y that NGSolve and kshell understand
    """

    kind: str
    build: Callable[[int], ks.Mesh]
    place: tuple[float, float]
    load: str = "1"

    def facts(self, program: str) -> dict[str, Any]:
        """What the driver of a program is told."""
        material = [12 * (1 - 0.3**2) / THIN**3, 0.3, THIN]
        return {
            "problem": self.id,
            "kind": self.kind,
            "place": list(self.place),
            "load": self.load,
            "round": self.build(1).midpoints is not None,
            "material": material,
            "steps": 0,
        }

    def arrays(self, feed: str, count: int) -> Arrays:
        """A mesh for a driver."""
        mesh = self.build(count)
        edges = mesh.edges[mesh.boundary_edges]
        if feed == "scene":
            return scene_arrays(mesh)
        if feed == "plane":
            return {"points": mesh.points[:, :2], "triangles": mesh.triangles, "edges": edges}
        return nodes.of_plate(mesh.points[:, :2], mesh.triangles, edges, self.kind, self.place)

    def scene(self, mesh: ks.Mesh) -> ks.Scene:
        """For kshell."""
        return plate(
            mesh, {"edge": LETTERS[self.kind]}, [ks.Pressure(1.0 if self.load == "1" else self.load)]
        )

    def options(self) -> dict[str, Any]:
        """Of `kshell.solve`."""
        return {"large_deflection": False}

    def read(self, result: ks.Result) -> dict[str, float]:
        """What is compared."""
        found = result.at((*self.place, 0.0))
        w, moment = float(found["u"][0, 2]), float(found["M"][0, 0])
        return {"compliance": 2 * result.strain_energy, "w": w, "M": moment}


# of plates with bending stiffness 1 in programs that ask for a thickness
THIN = 1e-3


@dataclass(frozen=True)
class ShellComparison(Comparison):
    """A shell of surfaces.py that has the same id. The moment is its trace at a point."""

    def facts(self, program: str) -> dict[str, Any]:
        """What the driver of a program is told."""
        surface = SURFACES[self.id]
        steps = surface.steps.get(program, 0)
        return {"problem": self.id, "material": list(surface.material), "steps": steps}

    def arrays(self, feed: str, count: int) -> Arrays:
        """A mesh for a driver."""
        surface = SURFACES[self.id]
        if feed == "count":
            return {"count": np.array(count)}
        if feed != "scene":
            return nodes.of_surface(surface, count, int(feed.removeprefix("nodes ")))
        st, triangles = nodes.lattice(*surface.grid(count), 3)
        s, t = st.T
        points = np.column_stack(surface.parameters(s, t, np))
        bare = ks.Mesh.from_arrays(points, triangles)
        sides = {"left": s == 0, "right": s == 1, "bottom": t == 0, "top": t == 1}
        edges = bare.edges[bare.boundary_edges]
        out = {"points": points, "triangles": triangles}
        return out | {GROUP + name: edges[on[edges].all(axis=1)] for name, on in sides.items()}

    def scene(self, mesh: ks.Mesh) -> ks.Scene:
        """For kshell: the grid of the parameters on its chart."""
        surface = SURFACES[self.id]
        young, nu, thickness = surface.material
        words: dict[str, Callable[[str], Any]] = {
            "clamped": ks.Clamped,
            "diaphragm xy": lambda on: ks.Fixed(on, "xy"),
        }
        supports = [words.get(how, ks.Symmetry)(side) for side, how in surface.held.items()]
        supports += [
            ks.Fixed(surface.place(*corner), "xyz"[freedom - 1]) for corner, freedom in surface.pinned
        ]
        loads: list[Any] = [ks.PointForce(surface.place(*corner), force) for corner, force in surface.points]
        loads += [ks.LineForce(side, force) for side, force in surface.lines]
        loads += [ks.Traction(surface.dead)] if any(surface.dead) else []
        return ks.Scene(
            mesh=mesh,
            chart=_chart(*surface.chart),
            thickness=thickness,
            material=ks.Isotropic(E=young, nu=nu),
            supports=supports,
            loads=loads,
        )

    def options(self) -> dict[str, Any]:
        """Of `kshell.solve`."""
        return {"model": "shell", "large_deflection": bool(SURFACES[self.id].steps)}

    def read(self, result: ks.Result) -> dict[str, float]:
        """What is compared."""
        surface = SURFACES[self.id]
        corner, axis, sign = surface.read
        u = result.fields["displacement"][_vertex(result.mesh, surface.place(*corner))]
        found = {"compliance": 2 * result.strain_energy, "w": sign * float(u[axis])}
        if "M" in self.references:
            moment = result.fields["moment"][_vertex(result.mesh, surface.place(*surface.moment))]
            found["M"] = abs(float(moment[0] + moment[1]))
        return found


def _vertex(mesh: ks.Mesh, place: tuple[float, float, float]) -> int:
    return int(np.argmin(np.linalg.norm(mesh.points - place, axis=1)))


def _chart(name: str, constants: dict[str, float]) -> Any:
    if name == "polar":
        return ks.geometry.Chart.from_expressions("v*cos(u)", "-v*sin(u)", "0*u")
    charts = {"plane": "Plane", "cylinder": "Cylinder", "sphere": "Sphere", "hypar": "Hypar"}
    return getattr(ks.geometry, charts[name])(**constants)


def scene_arrays(mesh: ks.Mesh) -> Arrays:
    """All that a mesh consists of, for `mesh_of`."""
    out = {"points": mesh.points, "triangles": mesh.triangles}
    if mesh.midpoints is not None:
        out["middles"] = mesh.midpoints
    return out | {GROUP + name: mesh.edges[group.members] for name, group in mesh.groups.items()}


def mesh_of(arrays: Arrays) -> ks.Mesh:
    """The mesh of the arrays of the feed "scene"."""
    groups = {name.removeprefix(GROUP): part for name, part in arrays.items() if name.startswith(GROUP)}
    return ks.Mesh.from_arrays(arrays["points"], arrays["triangles"], groups, arrays.get("middles"))
