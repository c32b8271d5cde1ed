"""All eigenvalues of K x = lambda M x from dense matrices, for small problems; M may be singular."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError
from kshell.solvers.pencil import Pencil, Spectrum, deflated

Floats = NDArray[np.float64]

# theta against the largest that is nothing but rounding: an unknown without mass
MASSLESS = 1e-11


def whole(pencil: Pencil) -> Spectrum:
    """All of them, from dense matrices, by theta of M x = theta (K + s M) x."""
    from scipy.linalg import eigh

    k, m = pencil.stiffness.toarray(), pencil.mass.toarray()
    diagonal = m.diagonal() > 0
    shift = 0.0
    if pencil.rigid.shape[1]:
        shift = 1e-3 * float(np.min(k.diagonal()[diagonal] / m.diagonal()[diagonal]))
    try:
        theta, x = eigh(m, k + shift * m)
    except np.linalg.LinAlgError as error:
        # a stiffness that is not definite: prestress beyond buckling; M definite on what it moves
        return _indefinite(k, m, error)
    real = theta > MASSLESS * theta[-1]
    values = 1.0 / theta[real] - shift
    vectors = x[:, real] / np.sqrt(theta[real])
    order = np.argsort(values, kind="stable")
    values, vectors = values[order], vectors[:, order]
    rigid = pencil.rigid.shape[1]
    if rigid:
        values, vectors = values[rigid:], deflated(pencil, vectors[:, rigid:])
    return Spectrum(values, vectors, True, "LAPACK")


def _indefinite(k: Floats, m: Floats, error: Exception) -> Spectrum:
    from scipy.linalg import eigh

    massive = m.diagonal() > 0
    loose = ~massive
    try:
        # unknowns without mass follow: K_ll x_l = -K_lm x_m
        follow = -np.linalg.solve(k[np.ix_(loose, loose)], k[np.ix_(loose, massive)])
        stiff = k[np.ix_(massive, massive)] + k[np.ix_(massive, loose)] @ follow
        values, part = eigh(0.5 * (stiff + stiff.T), m[np.ix_(massive, massive)])
    except np.linalg.LinAlgError:
        raise SolveError(f"the stiffness is singular ({error}): the structure can move freely") from error
    vectors = np.zeros((len(k), len(values)))
    vectors[massive], vectors[loose] = part, follow @ part
    return Spectrum(values, vectors, True, "LAPACK")
