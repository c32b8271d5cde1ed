"""Linear elasticity in space: strain, stress, traction, principal stresses, and the symmetry of stiffness.

Symbols
-------
F         deformation gradient I + grad u
E         Green strain (F^T F - I) / 2                  eps   its linear part (grad u + grad u^T) / 2
sigma     stress; traction on a plane of normal n: sigma n
C         stiffness, 6x6, in the order xx yy zz yz xz xy with engineering shears (gamma = 2 eps)

The isotropic law is sigma = 2 mu eps + lambda tr(eps) I: the identity stands with the trace.
Conversions between elastic constants are in `kshell.material.materials`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError

Floats = NDArray[np.float64]

# row and column of each of the six components
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
ENGINEERING = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


def _tensors(values: ArrayLike, what: str, symmetric: bool = True) -> Floats:
    t = np.asarray(values, dtype=np.float64)
    if t.shape[-2:] != (3, 3):
        raise InputError(f"{what} must be 3x3, not of shape {t.shape}")
    if not np.isfinite(t).all():
        raise InputError(f"{what} has entries that are not finite")
    if symmetric and np.abs(t - np.swapaxes(t, -1, -2)).max(initial=0.0) > 1e-9 * np.abs(t).max(initial=0.0):
        raise InputError(f"{what} must be symmetric")
    return t


def linear_strain(gradient: ArrayLike) -> Floats:
    """(..., 3, 3) eps from the displacement gradient [i, j] = du_i / dx_j."""
    g = _tensors(gradient, "the displacement gradient", symmetric=False)
    return 0.5 * (g + np.swapaxes(g, -1, -2))


def green_strain(gradient: ArrayLike) -> Floats:
    """(..., 3, 3) E = eps + grad u^T grad u / 2, zero for every rigid motion.

    Raises
    ------
    InputError
        If the gradient is not finite, or turns the material inside out (det F <= 0).
    """
    g = _tensors(gradient, "the displacement gradient", symmetric=False)
    if (np.linalg.det(np.eye(3) + g) <= 0.0).any():
        raise InputError("the displacement gradient turns the material inside out: det(I + grad u) <= 0")
    return linear_strain(g) + 0.5 * np.swapaxes(g, -1, -2) @ g


def isotropic_stress(strain: ArrayLike, lame_lambda: float, lame_mu: float) -> Floats:
    """(..., 3, 3) sigma = 2 mu eps + lambda tr(eps) I."""
    eps = _tensors(strain, "strain")
    return 2.0 * lame_mu * eps + lame_lambda * np.trace(eps, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)


def strain_vector(strain: ArrayLike) -> Floats:
    """(..., 6) strains in the order xx yy zz yz xz xy, the shears engineering ones (twice the tensor's)."""
    eps = _tensors(strain, "strain")
    return np.stack([eps[..., i, j] for i, j in PAIRS], axis=-1) * ENGINEERING


def stress_tensor(vector: ArrayLike) -> Floats:
    """(..., 3, 3) stress from its components in the order xx yy zz yz xz xy."""
    s = np.asarray(vector, dtype=np.float64)
    if s.shape[-1:] != (6,):
        raise InputError(f"a stress vector has 6 components xx yy zz yz xz xy, not the shape {s.shape}")
    out = np.empty((*s.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(PAIRS):
        out[..., i, j] = out[..., j, i] = s[..., k]
    return out


def stress(strain: ArrayLike, stiffness: ArrayLike) -> Floats:
    """(..., 3, 3) stress of a strain by the 6x6 stiffness C."""
    C = np.asarray(stiffness, dtype=np.float64)
    if C.shape != (6, 6):
        raise InputError(f"the stiffness must be 6x6, not of shape {C.shape}")
    return stress_tensor(strain_vector(strain) @ C.T)


def traction(stress: ArrayLike, normal: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Traction on the plane of a normal, and its normal and shear part.

    Parameters
    ----------
    stress : (..., 3, 3) array
    normal : (..., 3) array
        Of any length but zero.

    Returns
    -------
    (..., 3) traction sigma n, (...) its part along n (tension positive), (...) the size of the rest.
    """
    n = np.asarray(normal, dtype=np.float64)
    length = np.linalg.norm(n, axis=-1, keepdims=True)
    if n.shape[-1:] != (3,) or not np.isfinite(n).all() or not length.all():
        raise InputError(f"the normal of a plane must be three finite numbers, not all zero, not {normal!r}")
    n = n / length
    t = np.einsum("...ij,...j->...i", _tensors(stress, "stress"), n)
    along = np.sum(t * n, axis=-1)
    return t, along, np.linalg.norm(t - along[..., None] * n, axis=-1)


def principal_stresses(stress: ArrayLike) -> tuple[Floats, Floats]:
    """Principal stresses and the normals of their planes.

    Returns
    -------
    (..., 3) stresses, largest first, and (..., 3, 3) unit normals as rows, right-handed.
    """
    values, vectors = np.linalg.eigh(_tensors(stress, "stress"))
    normals = np.swapaxes(vectors, -1, -2)[..., ::-1, :].copy()
    normals[..., 2, :] *= np.sign(np.linalg.det(normals))[..., None]
    return values[..., ::-1], normals


def largest_shear(stress: ArrayLike) -> Floats:
    """(...) largest shear on any plane, half the difference of the outer principal stresses."""
    values = principal_stresses(stress)[0]
    return 0.5 * (values[..., 0] - values[..., 2])


def von_mises(stress: ArrayLike) -> Floats:
    """(...) sqrt(3/2) times the size of the deviator."""
    s = _tensors(stress, "stress")
    deviator = s - np.trace(s, axis1=-2, axis2=-1)[..., None, None] / 3.0 * np.eye(3)
    return np.sqrt(1.5) * np.linalg.norm(deviator, axis=(-2, -1))
