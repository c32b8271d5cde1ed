"""What a plate gains in deflection by its transverse shear, which the theory leaves out, predicted from its solution.

The shear forces Q of the solution without shear store energy, and along free edges and soft supports the twisting
moment, which the theory balances by the edge force, is released over a layer of width lambda. To first order

    change of U = 1/2 int Q . S^-1 Q + int m_nt^2 lambda / (2 D66) ds,
    change of J = int Q . S^-1 Q* + int m_nt m*_nt lambda / D66 ds,      lambda = sqrt(D66 / S_t),

with Q*, m*_nt of the dual solution of the quantity J. Both integrals diverge at singular corners and under point
forces; what is nearer than CUT thicknesses is left out, where a plate with shear has no singularity.

Sources: Wang, J. Eng. Mech. 121 (1995) 1230 (plates with straight hard supports); Arnold and Falk, SIAM J. Math. Anal.
27 (1996) 486, Haggblad and Bathe, Int. J. Numer. Meth. Eng. 29 (1990) 1055 (the layer at edges).

Symbols
-------
Q, m_nt     shear forces, and twisting moment in the axes n, t of an edge
S, S_t      transverse shear stiffness, and along the tangent of an edge
D66         stiffness against twist in the axes of an edge
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.model import Model, Solved
from kshell.error.plates import AT_VERTEX, deflection_rows
from kshell.error.tractions import Tractions, tractions_among, tractions_of
from kshell.mesh.words import place
from kshell.plate.loading import PointLoad
from kshell.plate.loads import Loads
from kshell.plate.model import PlateModel
from kshell.plate.places import points_3d
from kshell.plate.problem import PlateProblem
from kshell.result.result import Result
from kshell.scene.supports import Clamped, Elastic, Fixed, SimplySupported, SoftSupported, Symmetry

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CUT = 0.35  # thicknesses from singular places
THICKEST = (
    0.25  # thickness over the root of the area that counts for that: what is cut out must leave something
)
DEGREE = 4  # of the quadrature of products of shear forces, which are quadratic in a triangle
EDGE_POINTS = 4
# thickness over size from which a homogeneous plate is thick: its shear energy there, square and supported
THICK = 1.0 / 20.0
SQUARE = 5.9  # share of the shear in U of that square, over (t / L)^2
RELIED = 0.1  # of the sum, that triangles at singular places may have
ZERO = 1e-9  # of the largest deflection, that is none
RIGID = 1e-16  # of the stiffness times (largest deflection / size)^2: an energy of less is rounding
UNRESOLVED = (
    "shear forces grow without bound at a corner, a point support or a force, and the triangles there are too large "
    "for them: refine the mesh toward it, or give a tolerance"
)
STRAIGHT, RIGHT, HARMLESS = np.radians(181.0), np.radians(91.0), np.radians(100.0)


@dataclass(frozen=True)
class ShearShare:
    """By how much shear would change an answer.

    Attributes
    ----------
    share : float or None
        Of the first quantity, relative and unsigned; None where it is not known.
    energy : float or None
        Of the strain energy.
    why_not : str
        Why it is not known.
    """

    share: float | None = None
    energy: float | None = None
    why_not: str = ""

    @property
    def size_over_thickness(self) -> float:
        """Of the supported square whose energy shear changes by as much."""
        return float(np.sqrt(SQUARE / self.energy)) if self.energy else np.inf

    @property
    def thick(self) -> bool:
        """Whether the plate is thicker than THICK."""
        return self.size_over_thickness < 1.0 / THICK

    def words(self, quantity: str) -> str:
        """A warning."""
        share = self.energy if self.share is None else self.share
        what = "too thick for this theory" if self.thick else "shear exceeds the tolerance"
        return (
            f"{what}: transverse shear, which is left out, would add about {share:.1%} to {quantity}, as in a "
            f"supported square of {self.size_over_thickness:.2g} thicknesses"
        )


def shear_share(
    model: Model, solved: Solved, result: Result, probe: str | None, dual: Floats | None = None
) -> ShearShare:
    """How much transverse shear would change the deflection of a probe, or the strain energy, of a linear answer.

    ``dual`` (dof,) of the probe where it is at hand.
    """
    if not isinstance(model, PlateModel) or model.element != "argyris":
        return ShearShare(
            why_not=f"shear forces of a {model.kind} with the element {model.element} are not taken"
        )
    problem = model.problem
    if problem.section.without_shear:
        return ShearShare(why_not=problem.section.without_shear)
    d = np.asarray(solved.x)
    deflections = d[problem.layout.vertex_dofs(np.arange(problem.layout.vertex_count))[:, 0]]
    if _rigid(problem, deflections, result.strain_energy):
        return ShearShare(0.0, 0.0)
    centres, strong = singular_places(problem)
    stored = 2.0 * result.strain_energy
    if probe is None:
        return resolved(products(problem, [d], centres, strong), stored)
    at = np.array(problem.structure.probes[probe])
    w = float(result.motion_at_probe(probe)[2])
    if not abs(w) > ZERO * np.abs(deflections).max():
        found = resolved(products(problem, [d], centres, strong), stored)
        return replace(found, share=None, why_not=f"the deflection at {place(at)} is zero")
    if dual is None:
        rows, _, _ = deflection_rows(problem, at[None, :2])
        reduction = problem.reduction.matrix()
        dual = np.asarray(reduction @ model.respond(np.asarray(reduction.T @ rows)))[:, 0]
    return resolved(products(problem, [d, dual], centres, strong, at[None, :2]), stored, abs(w))


def _rigid(problem: PlateProblem, deflections: Floats, energy: float) -> bool:
    """Whether an energy is no more than the rounding of a plate that moves as a rigid body."""
    first = np.zeros(1, dtype=np.int64)
    middle = problem.mesh.points[problem.mesh.triangles[:1]].mean(axis=1)[:, None]
    stiffness = float(np.abs(problem.section.bending(first, middle)).max())
    moved = float(np.abs(deflections).max())
    return not energy > RIGID * stiffness * (moved / problem.mesh.size) ** 2


def resolved(products: Floats, stored: float, w: float | None = None) -> ShearShare:
    """Of the energy, and of a deflection where there are two products; None where corners have most of it."""
    whole, beside = products.T
    energy = float(whole[0] / stored)
    if (np.abs(beside) > RELIED * np.abs(whole)).any():
        return ShearShare(None, float((whole[0] - beside[0]) / stored), UNRESOLVED)
    return ShearShare(energy if w is None else float(abs(whole[1] / w)), energy)


def products(
    problem: PlateProblem,
    deflections: list[Floats],
    centres: Floats,
    strong: NDArray[np.bool_],
    near: Floats | None = None,
) -> Floats:
    """int Q . S^-1 Q' + int m_nt m'_nt lambda / D66 ds of the first deflection with each, away from singular places.

    Farther than CUT thicknesses from the centres (n, 2), and in products with others from near (m, 2), too: (k, 2), the
    second numbers the part of triangles beside strong centres, whose forces are not to be relied on.
    """
    totals = np.zeros((len(deflections), 2))
    weights = _weights(problem, centres, strong, near)
    own = _sampled(problem, weights, deflections[0])
    for number, d in enumerate(deflections):
        other = own if number == 0 else _sampled_dual(problem, weights, d)
        for part, first, second in zip(weights.parts, own, other, strict=True):
            found = (part.between(first, second) * part.weights[min(number, 1)]).sum(axis=1)
            totals[number] += found.sum(), found[part.beside].sum()
    return totals


def _sampled(problem: PlateProblem, weights: _Weights, d: Floats) -> list[Floats]:
    """Values of a deflection under the loads, with those of the others that were solved for together."""
    tractions, number = tractions_among(problem, d)
    known = problem.shared.get("shear of loads")
    if known is None or known[0] is not tractions:
        known = problem.shared["shear of loads"] = tractions, weights, weights.sampled(tractions)
    if known[1] is not weights:  # of other loads at points
        return [values[:, 0] for values in weights.sampled(tractions.of(number))]
    return [values[:, number] for values in known[2]]


def _sampled_dual(problem: PlateProblem, weights: _Weights, d: Floats) -> list[Floats]:
    """Values of a dual, of which the last is kept: it is that of all loads."""
    known = problem.shared.get("shear of dual")
    if known is None or known[0] is not weights or known[1] is not d:
        found = [values[:, 0] for values in weights.sampled(tractions_of(problem, [d], [Loads()]))]
        known = problem.shared["shear of dual"] = weights, d, found
    values: list[Floats] = known[2]
    return values


@dataclass(frozen=True)
class _Part:
    """Some points at which products are summed.

    Attributes
    ----------
    triangles : (n,) int array
    xi : (point, 2) or (n, point, 2)
    weights : (n, point) of the first deflection with itself, and with others
    beside : (n,) bool array
        Whether forces there are not to be relied on.
    compliance : (n, point, 2, 2), optional
        S^-1, inside.
    twist : (n, point, 3), optional
        On edges, what takes m_nt from moments.
    """

    triangles: Ints
    xi: Floats
    weights: tuple[Floats, Floats]
    beside: NDArray[np.bool_]
    compliance: Floats | None = None
    twist: Floats | None = None

    def sampled(self, tractions: Tractions) -> Floats:
        """Q (n, k, point, 2), or m_nt (n, k, point), of each deflection."""
        if self.twist is None:
            return tractions.shear_at(self.triangles, self.xi)
        moment = tractions.at(self.triangles, self.xi)[0]
        return np.asarray((moment * self.twist[:, None]).sum(axis=-1))

    def between(self, first: Floats, second: Floats) -> Floats:
        """(n, point) the density of the product of two of them."""
        if self.compliance is None:
            return first * second
        c = self.compliance
        strain = c[..., 0] * second[..., :1] + c[..., 1] * second[..., 1:]
        return np.asarray(first[..., 0] * strain[..., 0] + first[..., 1] * strain[..., 1])


@dataclass(frozen=True)
class _Weights:
    """Of one plate and its singular places."""

    key: tuple[bytes, ...]
    parts: list[_Part]

    def sampled(self, tractions: Tractions) -> list[Floats]:
        return [part.sampled(tractions) for part in self.parts]


def _weights(
    problem: PlateProblem, centres: Floats, strong: NDArray[np.bool_], near: Floats | None
) -> _Weights:
    """What does not depend on deflections; the last ones of a plate are kept, for further loads."""
    key = tuple(part.tobytes() for part in (centres, strong, np.zeros(0) if near is None else near))
    known: _Weights | None = problem.shared.get("shear")
    if known is not None and known.key == key:
        return known
    beside = _beside(problem, centres[strong])
    most = THICKEST * float(np.sqrt(problem.mesh.areas.sum()))

    def both(xy: Floats, thickness: Floats, weights: Floats) -> tuple[Floats, Floats]:
        first = weights * _far(xy, centres, thickness)
        return first, first if near is None else first * _far(xy, near, thickness)

    parts = []
    for patch in problem.domain.patches(DEGREE):
        at = points_3d(problem.domain, patch.xy)
        thickness = np.minimum(problem.section.thickness(patch.triangles, at), most)
        compliance = np.asarray(np.linalg.inv(problem.section.shear(patch.triangles, at)), dtype=np.float64)
        weights = both(patch.xy, thickness, patch.weights)
        parts.append(_Part(patch.triangles, patch.xi, weights, beside[patch.triangles], compliance))
    edges = _soft_edges(problem)
    if len(edges):
        line = problem.domain.edge_patch(edges, EDGE_POINTS)
        at = points_3d(problem.domain, line.xy)
        thickness = np.minimum(problem.section.thickness(line.triangles, at), most)
        n = line.normal
        t = np.stack([-n[..., 1], n[..., 0]], axis=-1)
        nx, ny, tx, ty = n[..., 0], n[..., 1], t[..., 0], t[..., 1]
        twist = np.stack([nx * tx, ny * ty, nx * ty + ny * tx], axis=-1)
        d66 = (twist[..., None, :] @ problem.section.bending(line.triangles, at) @ twist[..., None])[
            ..., 0, 0
        ]
        along = (t[..., None, :] @ problem.section.shear(line.triangles, at) @ t[..., None])[..., 0, 0]
        weights = both(line.xy, thickness, line.weights * np.sqrt(d66 / along) / d66)
        parts.append(_Part(line.triangles, line.xi, weights, beside[line.triangles], twist=twist))
    found = problem.shared["shear"] = _Weights(key, parts)
    return found


def _beside(problem: PlateProblem, centres: Floats) -> NDArray[np.bool_]:
    """(triangle,) the triangles at centres (n, 2) that reach farther than CUT thicknesses, and those around them."""
    points, mesh = problem.domain.points, problem.mesh
    at = np.zeros(len(points), dtype=bool)
    for centre in centres:
        at |= np.hypot(*(points - centre).T) <= AT_VERTEX * mesh.size
    chosen = np.flatnonzero(at[mesh.triangles].any(axis=1))
    middle = points_3d(problem.domain, points[mesh.triangles[chosen]].mean(axis=1)[:, None])
    reach = mesh.edge_lengths[mesh.triangle_edges[chosen]].max(axis=1)
    chosen = chosen[reach > CUT * problem.section.thickness(chosen, middle)[:, 0]]
    near = np.zeros(len(points), dtype=bool)
    near[mesh.triangles[chosen]] = True
    return np.asarray(near[mesh.triangles].any(axis=1))


def _far(xy: Floats, centres: Floats, thickness: Floats) -> NDArray[np.bool_]:
    """Whether points (n, q, 2) are farther than CUT thicknesses from all centres (k, 2)."""
    far = np.ones(xy.shape[:-1], dtype=bool)
    for centre in centres:
        far &= np.hypot(*np.moveaxis(xy - centre, -1, 0)) > CUT * thickness
    return far


def _soft_edges(problem: PlateProblem) -> Ints:
    """Boundary edges along which the twist is not held: free, on springs, and soft supports."""
    mesh = problem.mesh
    hard = np.zeros(len(mesh.edges), dtype=bool)
    for support in problem.structure.supports:
        item, selection = support.item, support.place
        if selection is None or selection.dimension == 0 or isinstance(item, SoftSupported | Elastic):
            continue
        if isinstance(item, SimplySupported | Clamped | Symmetry | Fixed) and set(item.freedoms) & set("zr"):
            members = selection.members
            hard[members if selection.dimension == 1 else mesh.triangle_edges[members].ravel()] = True
    boundary = mesh.boundary_edges
    return boundary[~hard[boundary]].astype(np.int64)


def singular_places(problem: PlateProblem) -> tuple[Floats, NDArray[np.bool_]]:
    """(k, 2) places where shear forces grow without bound, and (k,) whether their energy does so fast.

    Corners, where supports change, and points that are held or loaded; corners of about 90 degrees between edges that
    are held differently are harmless: on meshes that do not resolve them predictions were right within 15 %.
    """
    if "singular places" not in problem.shared:
        problem.shared["singular places"] = _singular_vertices(problem)
    vertices, its = problem.shared["singular places"]
    loaded = [np.reshape(form.xy, (1, 2)) for form in problem.loads.forms if isinstance(form, PointLoad)]
    places = np.concatenate([problem.domain.points[vertices], *loaded])
    return places, np.append(its, np.ones(len(loaded), dtype=bool))


def _singular_vertices(problem: PlateProblem) -> tuple[Ints, NDArray[np.bool_]]:
    """The same of vertices, whatever the loads."""
    mesh, supports = problem.mesh, problem.supports
    held, turned = (np.zeros(len(mesh.edges), dtype=bool) for _ in range(2))
    found = {int(v): True for group in supports.held for v in group.points}
    found |= {int(v): True for v in problem.layout.fans.ends}
    for group in supports.held:
        held[group.line] = True
        turned[group.edges] = True
    boundary = mesh.boundary_edges
    kinds = np.stack([held[boundary], turned[boundary]], axis=1).astype(float)
    both = np.zeros((2, len(mesh.points), 2))  # the sum, and the number, over the edges at each vertex
    for ends in mesh.edges[boundary].T:
        np.add.at(both[0], ends, kinds)
        np.add.at(both[1], ends, 1.0)
    mean = both[0] / np.maximum(both[1], 1.0)
    mixed = ((mean > 0.0) & (mean < 1.0)).any(axis=1)
    simple = (mean == [1.0, 0.0]).all(axis=1)
    angles = problem.corner_angles
    for v in np.flatnonzero(mixed).tolist():
        found[v] = found.get(v, False) or angles.get(v, np.pi) > HARMLESS
    for v, angle in angles.items():
        if angle > (RIGHT if simple[v] else STRAIGHT):
            found[v] = True
    vertices = np.array(sorted(found), dtype=np.int64)
    return vertices, np.array([found[v] for v in vertices.tolist()], dtype=bool)
