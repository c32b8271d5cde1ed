"""Bounds whose equilibrium is that of rounded matrices: two intervals of one number, each guaranteed, and disjoint."""

from __future__ import annotations

import dataclasses
import warnings
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import kshell as ks
from kshell.analysis.models import build_model
from kshell.error.bounds import PlatePair
from kshell.error.goals import Goal
from kshell.error.plates import vertex_at
from kshell.mesh.mesh import Mesh
from kshell.plate.hhj.numbering import Held
from kshell.plate.hhj.state import HHJSolution, Load
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from kshell.verify.cases import meshes
from kshell.verify.cases.plate import plate
from verification.failures.failure import Failure, Numbers, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

TOLERANCES = 1e-5, 1e-6, 1e-7, 1e-8
STEPS = 4
NAMES = "f - K x", "through strains"


class ByMatrix(HHJSystem):
    """The equilibrated side, refined with residuals f - K x of its rounded matrices, as any solver does."""

    def solve(self, load: Load, held: Held | None = None) -> HHJSolution:
        """Of a load without initial curvatures, on supports at rest."""
        o, numbering = self.tables.outer, self.numbering
        right, matrix = self.condensed(load), self.matrix()
        free = np.zeros_like(right)
        for _ in range(STEPS):
            free = free + self.solver(right - matrix @ free)
        d = numbering.scatter(free)
        u = np.zeros((len(self.triangles), self.tables.count))
        u[:, :o] = d[numbering.outer]
        u[:, o:] = (self.inner_inverse @ load.local[:, o:, None])[..., 0] - (self.back @ u[:, :o, None])[
            ..., 0
        ]
        strains = self.strains(u)
        return HHJSolution(d, u, strains, self.moments(strains), load, 0.0)


def _scene() -> ks.Scene:
    scene = plate(meshes.l_shape(2, 0), {"edge": "C"}, [ks.Pressure(1.0)])
    return dataclasses.replace(scene, probes={"p": (0.25, 0.25, 0.0)})


def _problem(scene: ks.Scene, mesh: Mesh) -> PlateProblem:
    model = build_model(
        resolve(scene, mesh), scene.solve.updated(element="argyris", model="plate", large_deflection=False)
    )
    problem: PlateProblem = model.problem  # type: ignore[attr-defined]
    return problem


def _careless(pair: PlatePair, place: Floats) -> tuple[float, float]:
    """Ends of the interval of a deflection, rounding left out."""
    s = pair.system
    pair.system = ByMatrix(s.triangles, s.order, s.stiffness, s.held, s.springs)
    goal = Goal.at_vertex(vertex_at(pair.problem.mesh, place))
    mine, its = pair.primal, pair.dual(goal)
    value = float(pair.row(goal) @ pair.conforming.full(mine.q))
    value += mine.difference.with_deflection(its.difference)
    value += 0.5 * float(mine.difference.per_triangle(its.difference).sum())
    half = 0.5 * mine.norm * its.norm
    return value - half, value + half


def measure(quick: bool) -> Numbers:
    """Intervals of a deflection of the clamped L on the last meshes to tolerances, less a value known better."""
    scene = _scene()
    rows: list[tuple[float, ...]] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ks.KshellWarning)
        for tolerance in TOLERANCES[quick:]:
            result = ks.solve(scene, tolerance=tolerance)
            assert result.last_mesh is not None
            value, half = result.probe("p")["u"][2], result.error["probes"]["p"]["u"]["half_width"][2]
            pair = PlatePair(_problem(scene, result.last_mesh))
            ends = *_careless(pair, np.array(scene.probes["p"])), value - half, value + half
            rows.append((result.last_mesh.edge_lengths.min(), *ends))
    found = np.array(rows).T
    truth = found[3:].mean(axis=0)[-1]
    names = [f"{name}: {end}" for name in NAMES for end in ("from", "to")]
    return {
        "tolerance": np.array(TOLERANCES[quick:]),
        "smallest edge": found[0],
        **dict(zip(names, found[1:] / truth - 1.0, strict=True)),
    }


def draw(numbers: Numbers) -> Figure:
    """The intervals over the tolerances."""
    figure, (axes,) = panels(height=4.0)
    at = np.arange(len(numbers["tolerance"]))
    for k, name in enumerate(NAMES):
        low, high = numbers[f"{name}: from"], numbers[f"{name}: to"]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        style = {"fmt": "os"[k], "color": f"C{1 - k}", "capsize": 6, "linewidth": 3, "markersize": 5}
        axes.errorbar(at + 0.15 * (2 * k - 1), middle, half, label=f"residuals {name}", **style)
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.set_yscale("symlog", linthresh=1e-8)
    axes.set_ylim(-3e-4, 3e-5)
    axes.set_xticks(at, [f"{tolerance:.0e}" for tolerance in numbers["tolerance"]])
    axes.set(
        xlabel="tolerance",
        ylabel="interval of w(.25, .25), less its value, relative",
        title="Clamped L: intervals that claim to be guaranteed",
    )
    axes.grid(alpha=0.25, axis="y")
    axes.legend(fontsize=8, loc="lower right")
    return figure


FAILURE = Failure(
    "rounding",
    "Unbalanced rounding",
    "Bounds after Prager and Synge need moments in exact equilibrium with the load. Refined with residuals f - K x, as "
    "any solver does it, they balance the load of the rounded matrix K: large deflections of tiny triangles cancel, "
    "and on meshes graded to 1e-8 of the plate equilibrium is broken by more than the width of the interval. Two "
    "intervals of one deflection, each guaranteed by the theorem, have no number in common; both solutions look as "
    "good as the others.",
    "Residuals are formed from strains, of deflections less the plane through the vertices of each triangle: the "
    "intervals lie in each other down to 1e-8 and beyond. What is left of the equilibrium is measured, its energy "
    "added to the interval, and so is the rounding of the coordinates.",
    measure,
    draw,
)
