"""How the curvature of the surface and the angle at its edges change, and their derivatives.

Both changes are computed from displacements, never as a difference of two nearly equal numbers, so that
a shell of thickness 1e-5 of its radius keeps its digits. Vectors have their components in the first axis.

Symbols
-------
X,a  x,a     tangents of the surface before and after, x = X + u; a = 1, 2
M    m       X,1 x X,2 and x,1 x x,2: normals of length |M|, |m|
N    n       unit normals
B_v  b_v     second fundamental form N . X,v and n . x,v with v = 11, 22, 12
P            I - n n, the projection onto the tangent plane
A_a          dm = sum_a A_a dx,a, so A_1 = -[x,2]x, A_2 = [x,1]x, and A_1^T v = x,2 x v, A_2^T v = v x x,1
t            tangent of an edge as the triangle walks it, T^a x,a
d            director of the edge, the same for all triangles at it; it does not depend on x
theta        angle from n to the projection of d across the edge, positive towards t x n (outwards)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.shell.vectors import cross, dot, norm, outer, skew

Floats = NDArray[np.float64]

# pairs (a, b) of derivatives along the two reference coordinates; (2, 1) is the transpose of (1, 2)
PAIRS = ((0, 0), (0, 1), (1, 1))
IDENTITY = np.eye(3)


def from_normal(x: Floats, v: Floats) -> tuple[Floats, Floats]:
    """A_1^T v and A_2^T v: a derivative with respect to m, carried over to x,1 and x,2."""
    return cross(x[1], v), cross(v, x[0])


def normal_change(big_x: Floats, u: Floats) -> tuple[Floats, Floats, Floats]:
    """m - M, n - N and |m| from the tangents X,a (2, 3, ...) and the derivatives u,a (2, 3, ...).

    From |m| - |M| = (m - M) . (m + M) / (|m| + |M|).
    """
    big_m = cross(big_x[0], big_x[1])
    change = cross(u[0], big_x[1]) + cross(big_x[0] + u[0], u[1])
    big_length, length = norm(big_m), norm(big_m + change)
    longer = dot(change, 2 * big_m + change) / (length + big_length)
    return change, (change - big_m * (longer / big_length)) / length, length


class Curvature(NamedTuple):
    """Change of the second fundamental form at points, with what its derivatives need."""

    change: Floats  # (3, ...) b_v - B_v
    x: Floats  # (2, 3, ...) x,a
    second: Floats  # (3, 3, ...) x,v, v first
    normal: Floats  # (3, ...) n
    length: Floats  # (...) |m|


def curvature_change(big_x: Floats, big_second: Floats, u: Floats, u_second: Floats) -> Curvature:
    """b - B = n . u,v + (n - N) . X,v.

    Parameters
    ----------
    big_x, u : (2, 3, ...) first derivatives of position and displacement
    big_second, u_second : (3, 3, ...) second derivatives, v = 11, 22, 12 first
    """
    _, n_change, length = normal_change(big_x, u)
    x = big_x + u
    n = cross(x[0], x[1]) / length
    change = np.stack([dot(n, u_second[v]) + dot(n_change, big_second[v]) for v in range(3)])
    return Curvature(change, x, big_second + u_second, n, length)


def curvature_gradient(state: Curvature) -> Floats:
    """d b_v / d x,a, (v, a, 3, ...). The derivative with respect to x,v is n.

    dn = P dm / |m|, so n . x,v changes by A_a^T (P x,v) / |m|.
    """
    n = state.normal
    result = np.empty((3, 2, *n.shape))
    for v, y in enumerate(state.second):
        result[v, 0], result[v, 1] = from_normal(state.x, (y - n * dot(n, y)) / state.length)
    return result


def curvature_hessian(state: Curvature, weights: Floats) -> tuple[list[Floats], list[Floats]]:
    """Second derivatives of sum_v weights_v b_v = n . Y with Y = sum_v weights_v x,v.

    By m twice: -(n (PY)^T + (PY) n^T + (n . Y) P) / |m|^2; and m has the constant second derivative
    dx,1 x dx,2, which meets PY / |m|.

    Parameters
    ----------
    weights : (3, ...)

    Returns
    -------
    list of (3, 3, ...)
        By x,a and x,b for each pair of PAIRS.
    list of (3, 3, ...)
        dn / d x,a for a = 1, 2: times weights_v it is the derivative by x,v and x,a.
    """
    n, length, (x1, x2) = state.normal, state.length, state.x
    y = sum(weights[v] * state.second[v] for v in range(3))
    along = dot(n, y)
    py = (y - n * along) / length
    n_a = from_normal(state.x, n / length)
    py_a = from_normal(state.x, py)
    # A_a^T A_b, from [a]x [b]x = b a^T - (a . b) I
    eye = IDENTITY.reshape(3, 3, *(1,) * along.ndim)
    squares = [
        eye * dot(x2, x2) - outer(x2, x2),
        outer(x1, x2) - eye * dot(x1, x2),
        eye * dot(x1, x1) - outer(x1, x1),
    ]
    along = along / length**2
    by_x = []
    for (a, b), square in zip(PAIRS, squares, strict=True):
        block = along * (length**2 * outer(n_a[a], n_a[b]) - square)
        block -= outer(n_a[a], py_a[b]) + outer(py_a[a], n_a[b])
        by_x.append(block)
    by_x[1] -= skew(py)
    normal_by_x = [-skew(x2) / length - outer(n, n_a[0]), skew(x1) / length - outer(n, n_a[1])]
    return by_x, normal_by_x


class Angle(NamedTuple):
    """Change of the angle theta at edge points, with what its derivatives need.

    theta = atan2(F, G), F = d . (t x m), G = |t| d . m.
    """

    change: Floats  # (...) theta minus its value in the base state, between -pi and pi
    x: Floats  # (2, 3, ...) x,a
    along: Floats  # (2, points) T^a
    t: Floats  # (3, ...)
    m: Floats  # (3, ...)
    director: Floats  # (3, ...)
    sine: Floats  # (...) F
    cosine: Floats  # (...) G


def angle_change(big_x: Floats, u: Floats, along: Floats, director: Floats) -> Angle:
    """theta(x) - theta(X), from tan of the difference of two angles with F - F_0 and G - G_0 from u.

    Parameters
    ----------
    big_x, u : (2, 3, ...) first derivatives of the base position and of the displacement from it
    along : (2, points) the edge tangent in reference coordinates
    director : (3, ...)
    """
    big_t = along[0] * big_x[0] + along[1] * big_x[1]
    t_change = along[0] * u[0] + along[1] * u[1]
    t = big_t + t_change
    big_m = cross(big_x[0], big_x[1])
    m_change = cross(u[0], big_x[1]) + cross(big_x[0] + u[0], u[1])
    big_length, length = norm(big_t), norm(t)
    longer = dot(t_change, big_t + t) / (length + big_length)
    height = dot(director, big_m)

    sine = dot(director, cross(big_t, big_m))
    sine_change = dot(director, cross(t_change, big_m) + cross(t, m_change))
    cosine = big_length * height
    cosine_change = length * dot(director, m_change) + longer * height
    change = np.arctan2(
        sine_change * cosine - cosine_change * sine,
        sine**2 + cosine**2 + sine_change * sine + cosine_change * cosine,
    )
    return Angle(
        change, big_x + u, along, t, big_m + m_change, director, sine + sine_change, cosine + cosine_change
    )


def _sine_cosine_gradients(state: Angle) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Derivatives of F and of G by t and by m."""
    t, m, d = state.t, state.m, state.director
    length = norm(t)
    return (cross(m, d), cross(d, t)), (t * (dot(d, m) / length), d * length)


def angle_gradient(state: Angle) -> Floats:
    """d theta / d x,a: (2, 3, ...)."""
    (f_t, f_m), (g_t, g_m) = _sine_cosine_gradients(state)
    square = state.sine**2 + state.cosine**2
    cosine, sine = state.cosine / square, state.sine / square
    by_t = cosine * f_t - sine * g_t
    by_x = from_normal(state.x, cosine * f_m - sine * g_m)
    return np.stack([state.along[a] * by_t + by_x[a] for a in range(2)])


def angle_hessian(state: Angle, gradient: Floats) -> list[Floats]:
    """Second derivatives of theta by x,a and x,b for each pair of PAIRS: list of (3, 3, ...).

    With R^2 = F^2 + G^2 and rho = log R the second derivatives are
    (G F'' - F G'') / R^2 - (theta' rho'^T + rho' theta'^T).
    """
    t, m, d, (x1, x2) = state.t, state.m, state.director, state.x
    (f_t, f_m), (g_t, g_m) = _sine_cosine_gradients(state)
    square = state.sine**2 + state.cosine**2
    cosine, sine = state.cosine / square, state.sine / square
    rho_t = sine * f_t + cosine * g_t
    rho_m = from_normal(state.x, sine * f_m + cosine * g_m)
    rho = [state.along[a] * rho_t + rho_m[a] for a in range(2)]
    theta_m = cosine * f_m - sine * g_m

    length = norm(t)
    unit = t / length
    eye = IDENTITY.reshape(3, 3, *(1,) * length.ndim)
    g_tt = (eye - outer(unit, unit)) * (dot(d, m) / length)
    d_a = from_normal(state.x, d)
    # F by t and m is -[d]x, and -[d]x A_b follows from [a]x [b]x = b a^T - (a . b) I
    f_ta = (outer(x2, d) - eye * dot(d, x2), eye * dot(d, x1) - outer(x1, d))
    along = state.along
    result = []
    for a, b in PAIRS:
        block = cosine * (along[a] * f_ta[b] + np.swapaxes(f_ta[a], 0, 1) * along[b])
        block -= sine * (
            along[a] * along[b] * g_tt + along[a] * outer(unit, d_a[b]) + outer(d_a[a], unit) * along[b]
        )
        block -= outer(gradient[a], rho[b]) + outer(rho[a], gradient[b])
        result.append(block)
    result[1] -= skew(theta_m)
    return result
