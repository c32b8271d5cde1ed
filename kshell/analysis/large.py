"""Whether large deflections matter: what they would change about a linear solution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.linear import LinearSolution
from kshell.errors import SolveError
from kshell.scene.options import TOLERANCE


@dataclass(frozen=True)
class Indicator:
    """What large deflections would change about a linear solution.

    Attributes
    ----------
    change : float
        First correction of Newton's method from the linear solution, root mean square over the nodes, relative;
        infinite where the tangent there is singular.
    energy : float
        Energy of the true strains of the linear solution, relative to that of its linear strains.
    negative : int
        Negative eigenvalues of the tangent there: where there are any, the linear solution is not stable.
    tolerance : float
        Change from which large deflections matter.
    """

    change: float
    energy: float
    negative: int = 0
    tolerance: float = TOLERANCE

    @property
    def matters(self) -> bool:
        """Whether the linear solution will not do."""
        return self.negative > 0 or not self.change <= self.tolerance

    def words(self) -> str:
        """For the reasons of the model."""
        limit = f"{100 * self.tolerance:g} %"
        energy = f"the true strains of the linear solution store {self.energy:.3g} times the energy of its linear ones"
        if not np.isfinite(self.change):
            return "large deflections: the tangent stiffness at the linear solution is singular"
        change = f"the displacements by {100 * self.change:.2g} %"
        if self.negative:
            return (
                f"large deflections: the linear solution is unstable ({self.negative} negative eigenvalues of the "
                f"tangent stiffness), the first correction changes {change}; {energy}"
            )
        if self.matters:
            return f"large deflections: they change {change}, more than the tolerance of {limit}; {energy}"
        return f"linear: large deflections change {change}, within the tolerance of {limit}; {energy}"


def indicate(model: FiniteModel, solution: LinearSolution, tolerance: float = TOLERANCE) -> Indicator:
    """Evaluate the true residual of a linear solution, and correct it once.

    The correction keeps the linear stress in its tangent, as newton.py does: the true stress of the linear
    displacements, which stretches where the shell only turns, would call every cantilever stiff.
    """
    equilibrium = model.alike(model.near_rest())
    elastic, basis = equilibrium.energy, equilibrium.reduction.basis
    weights = np.sqrt(elastic.translation_weights())
    size = float(np.linalg.norm(weights * solution.x))
    if size == 0.0:
        return Indicator(0.0, 1.0, 0, tolerance)
    try:
        energy, residual, tangent = equilibrium.near_rest(solution.x, solution.stress)
        step = basis @ tangent.solve(basis.T @ residual)
    except SolveError:
        return Indicator(np.inf, np.inf, 0, tolerance)
    strain = elastic.linear_strain(solution.x)
    if equilibrium.initial is not None:
        strain = strain - equilibrium.initial
    linear = 0.5 * float(np.sum(strain * solution.stress))
    true = energy.value / linear if linear > 0.0 else 1.0
    return Indicator(float(np.linalg.norm(weights * step)) / size, true, tangent.negative, tolerance)
