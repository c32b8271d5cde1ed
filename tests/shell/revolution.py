"""Axisymmetric Koiter shells by Legendre polynomials along the meridian: exact values of edge loads.

The meridian (r, z)(s) of arc length s has the tangent (r', z') and the normal n = (z', -r'). A displacement
u = (u_r, u_z) has, linearly,

    E_ss = u' . (r', z'),    E_tt = u_r / r,    (b - B)_ss = n . u'',    (b - B)_tt = (n . u') r' / r - n_r u_r / r^2

(t along the parallels, physical components), and the energy is that of kshell.shell.koiter; nothing of it is used.
"""

import numpy as np
from numpy.polynomial import legendre


def edge_flexibility(meridian, length, thickness, nu=0.3, terms=60):
    """Outward displacement and turn of the edge s = 0 under unit force and unit moment per length: (2, 2); E = 1.

    Parameters
    ----------
    meridian : function of s to r, r', z'
        z is held at the far end.
    """
    x, weight = legendre.leggauss(2 * terms)
    s, scale = 0.5 * (x + 1) * length, 2 / length
    value, first, second = (
        np.stack([legendre.legval(x, legendre.legder(c, k)) for c in np.eye(terms)], axis=1) * scale**k
        for k in range(3)
    )
    r, r_s, z_s = (np.broadcast_to(part, s.shape)[:, None] for part in meridian(s))
    strains = [np.hstack([r_s * first, z_s * first]), np.hstack([value / r, 0 * value])]
    bends = [
        np.hstack([z_s * second, -r_s * second]),
        np.hstack([z_s * r_s / r * first - z_s / r**2 * value, -r_s * r_s / r * first]),
    ]
    moduli = np.array([[1, nu], [nu, 1]]) / (1 - nu**2)
    ring = 0.5 * length * weight[:, None] * r
    stiffness = sum(
        factor * moduli[i, j] * tensors[i].T @ (ring * tensors[j])
        for tensors, factor in ((strains, thickness), (bends, thickness**3 / 12))
        for i in range(2)
        for j in range(2)
    )
    r0, r0_s, z0_s = (float(np.asarray(part)) for part in meridian(0.0))
    at, slope = (
        np.array([legendre.legval(-1, legendre.legder(c, k)) for c in np.eye(terms)]) * scale**k
        for k in (0, 1)
    )
    loads = np.stack([np.concatenate([at, 0 * at]), np.concatenate([z0_s * slope, -r0_s * slope])], axis=1)
    held = np.concatenate([0 * at, np.ones(terms)])[:, None] * stiffness.max()
    system = np.block([[stiffness, held], [held.T, np.zeros((1, 1))]])
    answer = np.linalg.solve(system, np.vstack([r0 * loads, np.zeros((1, 2))]))[:-1]
    return loads.T @ answer


def sphere(s):
    """Latitude s of the unit sphere."""
    return np.cos(s), -np.sin(s), np.cos(s)


def tube(s):
    """Height s of the unit cylinder."""
    return 1.0, 0.0, 1.0
