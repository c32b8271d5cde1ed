"""Membrane locking: too stiff by more and more as the thickness goes to zero."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.linear import solve_linear
from kshell.geometry import Hypar
from kshell.mesh.mesh import Mesh
from kshell.shell.chart import loads as chart_loads
from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.chart.supports import ChartSupports
from kshell.shell.chart.surface import ChartSurface
from kshell.shell.frames import components, covariant_to_frame, tangent_frame
from kshell.shell.koiter import loads
from kshell.shell.koiter.edges import Directors
from kshell.shell.koiter.energy import Koiter, State
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section, section_at
from kshell.shell.vectors import dot
from verification.failures.bent import rectangle
from verification.failures.failure import Failure, Numbers, columns, lines, panels
from verification.failures.shells import ShellModel, cylinder, edges_at, vertex_at

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

RATIOS = (1e-2, 1e-3, 1e-4, 1e-5)  # t / R and t / L
CELLS = 16, 8
SKEW = 0.27
# deflection of the hypar at the free end, p = 3 on 48 x 24 graded cells; four digits
HYPAR = {1e-2: -9.31452e-5, 1e-3: -6.39718e-3, 1e-4: -0.53078, 1e-5: -48.489}


class Pointwise(Koiter):
    """The Koiter energy with the membrane strain of the displacement as it is: nothing interpolated.

    For small deflections. The strains of a triangle are E_11, E_22, E_12 at each interior point, then l.
    """

    def __init__(self, surface: Surface, section: Section) -> None:
        super().__init__(surface, section)
        x = surface.tangents(surface.reference.first)  # (2, 3, triangle, q)
        e1, e2, _ = tangent_frame(x)
        to_frame = np.moveaxis(covariant_to_frame(components(x, e1, e2)), (0, 1), (2, 3))
        nodes = surface.nodes[surface.triangle_nodes]
        a, _, _, _ = section_at(
            section, np.arange(len(nodes)), lambda: np.einsum("qn,tnx->tqx", surface.reference.values, nodes)
        )
        weight = surface.area_elements * surface.reference.weights
        at_points = np.swapaxes(to_frame, -1, -2) @ a @ to_frame * weight[..., None, None]
        count, q = weight.shape
        membrane = np.zeros((count, 3 * q, 3 * q))
        for k in range(q):
            membrane[:, 3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = at_points[:, k]
        self.constitutive = self.constitutive._replace(membrane=membrane)
        self.strains = 3 * q + surface.reference.strains

    def _state(self, x: Floats, memory: Directors, triangles: slice) -> State:
        state = super()._state(x, memory, triangles)
        first = self.surface.reference.first
        u, _ = self.surface.split(x)
        big, small = self.surface.tangents(first, triangles), self.surface.jets(u, first, triangles)
        e = [dot(big[a], small[b]) + dot(big[b], small[a]) for a, b in ((0, 0), (1, 1), (0, 1))]
        membrane = 0.5 * np.stack(e, axis=-1).reshape(len(state.strain), -1)
        return state._replace(
            strain=np.concatenate([membrane, state.strain[:, self.surface.reference.strains :]], axis=1)
        )

    def _gradient(self, state: State, triangles: slice) -> Floats:
        ref = self.surface.reference
        bending = super()._gradient(state, triangles)[:, ref.strains :]
        x = np.moveaxis(self.surface.tangents(ref.first, triangles), (2, 3), (0, 1))  # (triangle, q, 2, 3)
        d1, d2 = ref.first[:, None, :, None, :]  # (1, q, 1, n)
        x1, x2 = x[:, :, 0, :, None], x[:, :, 1, :, None]  # (triangle, q, 3, 1)
        rows = np.stack([x1 * d1, x2 * d2, 0.5 * (x1 * d2 + x2 * d1)], axis=2)
        count, q = rows.shape[:2]
        membrane = np.zeros((count, 3 * q, bending.shape[2]))
        membrane[:, :, : rows.shape[3] * rows.shape[4]] = rows.reshape(count, 3 * q, -1)
        return np.concatenate([membrane, bending], axis=1)


def quarter_cylinder(order: int, ratio: float, skew: float, energy: type[Koiter] = Koiter) -> float:
    """Motion of the tip over the exact one: a quarter circle of radius 1, clamped, a force EI along the tangent
    there, which bends it without stretching but for (t / R)^2 / 12."""
    family = "irregular" if skew else "alternating"
    mesh = rectangle(*CELLS, (np.pi / 2, 1.0), family, skew)
    model = ShellModel(mesh, order, Section.isotropic(1.0, 0.0, ratio), cylinder(1.0), energy)
    model.supports.clamp(model.edges(0, 0.0))
    load = loads.line_force(model.surface, [ratio**3 / 12, 0, 0], model.edges(0, np.pi / 2))
    answer = solve_linear(model.koiter, load, model.supports.reduction())
    exact = np.pi / 4 * (1 + ratio**2 / 12)
    return float(answer.x[3 * model.vertex(np.pi / 2, 0.0)] / exact)


def hypar_mesh() -> Mesh:
    """Half of the unit square."""
    mesh = rectangle(*CELLS, (1.0, 0.5), "alternating")
    return Mesh(mesh.points - [0.5, 0.0, 0.0], mesh.triangles)


def hypar(order: int, ratio: float, energy: type[Koiter] = Koiter) -> float:
    """Deflection over the converged one: z = x^2 - y^2, clamped at one side, under its weight."""
    model = ShellModel(
        hypar_mesh(), order, Section.isotropic(2e11, 0.3, ratio),
        lambda q: np.column_stack([q[:, 0], q[:, 1], q[:, 0] ** 2 - q[:, 1] ** 2]), energy,
    )  # fmt: skip
    model.supports.clamp(model.edges(0, -0.5))
    model.supports.symmetry(model.edges(1, 0.0), [0, 1, 0])
    load = loads.traction(model.surface, [0, 0, -8000 * ratio])
    answer = solve_linear(model.koiter, load, model.supports.reduction())
    return float(answer.x[3 * model.vertex(0.5, 0.0) + 2] / HYPAR[ratio])


def hypar_argyris(ratio: float) -> float:
    """The same with Argyris functions on the chart."""
    mesh = hypar_mesh()
    surface = ChartSurface(mesh, Hypar())
    energy = ChartKoiter(surface, Section.isotropic(2e11, 0.3, ratio))
    supports = ChartSupports(surface)
    supports.clamp(edges_at(mesh, 0, -0.5))
    supports.symmetry(edges_at(mesh, 1, 0.0), [0, 1, 0])
    load = chart_loads.traction(surface, [0, 0, -8000 * ratio])
    answer = solve_linear(energy, load, supports.reduction())
    return float(answer.x[18 * vertex_at(mesh, 0.5, 0.0) + 2] / HYPAR[ratio])


def measure(quick: bool) -> Numbers:
    """Deflections over the exact ones."""
    rows = []
    for ratio in RATIOS[1::2] if quick else RATIOS:
        rows.append(
            {
                "t / R": ratio,
                "cylinder: p = 1, regular mesh": quarter_cylinder(1, ratio, 0.0),
                "cylinder: p = 1": quarter_cylinder(1, ratio, SKEW),
                "cylinder: p = 2, strain not interpolated": quarter_cylinder(2, ratio, SKEW, Pointwise),
                "cylinder: kshell, p = 2": quarter_cylinder(2, ratio, SKEW),
                "hypar: p = 2, strain not interpolated": hypar(2, ratio, Pointwise),
                "hypar: Argyris on the chart": hypar_argyris(ratio),
                "hypar: p = 3, strain not interpolated": hypar(3, ratio, Pointwise),
                "hypar: kshell, p = 2": hypar(2, ratio),
                "hypar: kshell, p = 3": hypar(3, ratio),
            }
        )
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """One panel per problem."""
    figure, axes = panels(2, height=4.2)
    titles = {"cylinder": "Quarter cylinder, bent, on a skewed mesh", "hypar": "Hypar clamped at one side"}
    for place, (start, title) in zip(axes, titles.items(), strict=True):
        own = {name.removeprefix(f"{start}: "): v for name, v in numbers.items() if name.startswith(start)}
        lines(place, {"t / R": numbers["t / R"], **own}, "t / R", list(own))
        place.axhline(1.0, color="0.6", linewidth=0.8)
        place.set_yscale("linear")
        place.invert_xaxis()
        place.set(xlabel="t / R" if start == "cylinder" else "t / L", title=title, ylim=(0, 1.15))
        place.legend(fontsize=8, loc="lower left")
    axes[0].set_ylabel("deflection / exact")
    return figure


FAILURE = Failure(
    "locking",
    "Membrane locking as the thickness goes to zero",
    "A thin shell bends without stretching where it can; polynomials that cannot do that stretch, with an energy "
    "(R / t)^2 too large. With the strain of the displacement taken as it is, quadratic triangles keep 3 percent "
    "of the deflection of a quarter cylinder at t / R = 1e-5 and a quarter of that of the hypar, cubic ones 91 to"
    " 95 percent; triangles of order 1 lose nothing on a regular mesh and 19 percent on a skewed one. Argyris "
    "functions, quintic on the exact chart, lose 1 percent of the hypar at t / L = 1e-3 and 15 at 1e-5.",
    "The membrane strain is interpolated into the Regge space of degree p - 1, which leaves the bending without "
    "stretching free: the same 16 x 8 cells are within 0.01 percent on the cylinder and 2 percent on the hypar at"
    " every thickness. Charts thinner than 2e-3 of their size get that element, not Argyris; where order 1 or "
    "Argyris are asked for on a thin curved shell, a warning says so.",
    measure,
    draw,
)
