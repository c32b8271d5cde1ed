"""What a plate gains in deflection by its transverse shear, which the theory leaves out, predicted from its solution.

The shear forces Q of the solution without shear store energy, and along free edges and soft supports the twisting
moment, which the theory balances by the edge force, is released over a layer of width lambda. To first order

    change of U = 1/2 int Q . S^-1 Q + int m_nt^2 lambda / (2 D66) ds,
    change of J = int Q . S^-1 Q* + int m_nt m*_nt lambda / D66 ds,      lambda = sqrt(D66 / S_t),

with Q*, m*_nt of the dual solution of the quantity J. Both integrals diverge at singular corners and under point
forces; what is nearer than CUT thicknesses (shear_places.py) is left out, where a plate with shear has no singularity.

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
from kshell.error.plates import deflection_rows
from kshell.error.shear_places import Weights, singular_places, weights_of
from kshell.error.tractions import tractions_among, tractions_of
from kshell.mesh.words import place
from kshell.plate.loads import Loads
from kshell.plate.model import PlateModel
from kshell.plate.problem import PlateProblem
from kshell.result.result import Result

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

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
        reduction = problem.reduction
        dual = reduction.spread(model.respond(reduction.gathered(rows)))[:, 0]
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
    weights = weights_of(problem, centres, strong, near)
    own = _sampled(problem, weights, deflections[0])
    for number, d in enumerate(deflections):
        other = own if number == 0 else _sampled_dual(problem, weights, d)
        for part, first, second in zip(weights.parts, own, other, strict=True):
            found = (part.between(first, second) * part.weights[min(number, 1)]).sum(axis=1)
            totals[number] += found.sum(), found[part.beside].sum()
    return totals


def _sampled(problem: PlateProblem, weights: Weights, d: Floats) -> list[Floats]:
    """Values of a deflection under the loads, with those of the others that were solved for together."""
    tractions, number = tractions_among(problem, d)
    known = problem.shared.get("shear of loads")
    if known is None or known[0] is not tractions:
        known = problem.shared["shear of loads"] = tractions, weights, weights.sampled(tractions)
    if known[1] is not weights:  # of other loads at points
        return [values[:, 0] for values in weights.sampled(tractions.of(number))]
    return [values[:, number] for values in known[2]]


def _sampled_dual(problem: PlateProblem, weights: Weights, d: Floats) -> list[Floats]:
    """Values of a dual, of which the last is kept: it is that of all loads."""
    known = problem.shared.get("shear of dual")
    if known is None or known[0] is not weights or known[1] is not d:
        tractions, its, values = problem.shared["shear of loads"]
        place = next((k for k, other in enumerate(tractions.deflections) if other is d), None)
        if its is weights and place is not None:  # estimated together with those under the loads
            return [value[:, place] for value in values]
        found = [values[:, 0] for values in weights.sampled(tractions_of(problem, [d], [Loads()]))]
        known = problem.shared["shear of dual"] = weights, d, found
    kept: list[Floats] = known[2]
    return kept
