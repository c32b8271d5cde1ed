"""A Koiter shell of order 1 whose section yields as a whole.

Ilyushin's surface in membrane forces and moments, the quadratic one without the product of both (A. A. Ilyushin,
Plasticite, 1956; M. Robinson, Int. J. Mech. Sci. 13, 1971): exact where a shell is stretched only or bent only, and at
most a quarter too strong in between. With isotropic and kinematic hardening, by implicit Euler steps from the last
settled state:

    f(S - a) <= c,   f^2 = S . Y S,   e_p' = mu Y (S - a),   a' = mu W (S - a),   c' = mu f w.

Symbols
-------
S           (N, M) in the frame of the triangle; e = (E, kappa), S = C (e - e_p)
n, m        N / (sigma_y t), M / (sigma_y t^2 / 4): 1 in uniaxial tension and in bending that yields through and through
Y           f^2 = n . P n + m . P m, with P of von Mises
W           diag(H t, H t^3 / 12) of P^-1 Y, H kinematic: a strip under tension or in bending hardens with H
w           xi . Y W xi / f^2 with H isotropic, of the trial state: the same for isotropic hardening
R           e = R s of the strains s of the triangle, whose stress is area R^T S
xi          S - a, on the surface: (1 + mu B) xi = xi_trial, B = C Y + W, and f(xi) (1 - mu w) = c gives mu
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.evaluated import Response
from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError, SolveError
from kshell.material.inelastic import Yielding
from kshell.shell.frames import components, contravariant_to_frame, covariant_to_frame, tangent_frame
from kshell.shell.koiter.edges import Directors
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.remembered import Remembered, remembering
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section

Floats = NDArray[np.float64]

P = np.array([[1.0, -0.5, 0.0], [-0.5, 1.0, 0.0], [0.0, 0.0, 3.0]])
MOST_ITERATIONS = 60
ON_SURFACE = 1e-13
# size of the surface that perfect plasticity leaves to grow, so that the tangent is not singular
LEAST_HARDENING = 1e-6
ORDER_1 = (
    "a shell that yields (hardening) takes order 1: leave order out, or set it to 1, and refine the mesh"
)


class YieldingKoiter(Koiter):
    """The energy of a surface of order 1 with a section that yields; its value is that of a step, with what is lost.

    Parameters
    ----------
    surface : Surface
    section : Section
    yielding : Yielding

    Raises
    ------
    InputError
        If the order is not 1, or the section couples bending and stretching.
    """

    def __init__(self, surface: Surface, section: Section, yielding: Yielding) -> None:
        super().__init__(surface, section)
        if surface.order != 1:
            raise InputError(ORDER_1)
        if np.any(section.coupling):
            raise InputError(
                "a section that yields must be symmetric about the mesh: leave offset or hardening out"
            )
        self.rest = remembering(self.rest, len(self.triangle_unknowns), self.strains, 1)
        self.area = 0.5 * surface.area_elements[:, 0]
        x = surface.tangents(surface.reference.first)[..., :1]
        f = components(x, *tangent_frame(x, section.direction, section.angle[:, None])[:2])
        strain, moment = (
            np.moveaxis(found[..., 0], 2, 0) for found in (covariant_to_frame(f), contravariant_to_frame(f))
        )
        moment = moment / surface.area_elements[:, :1, None] ** 2
        a, d = section.membrane, section.bending
        count = len(self.triangle_unknowns)
        self.elastic = np.zeros((count, 6, 6))  # C
        self.elastic[:, :3, :3], self.elastic[:, 3:, 3:] = a, d
        self.frame = np.zeros((count, 6, 6))  # R
        self.frame[:, :3, :3] = strain
        self.frame[:, 3:, 3:] = np.linalg.inv(d) @ moment @ self.constitutive.bending
        self.unframe = np.linalg.inv(self.frame)
        self._surfaces(yielding)

    def _surfaces(self, yielding: Yielding) -> None:
        t, limit = yielding.thickness, yielding.stress
        n, m = 1.0 / (limit * t), 4.0 / (limit * t**2)
        self.shape = np.zeros((len(t), 6, 6))  # Y
        self.shape[:, :3, :3], self.shape[:, 3:, 3:] = (size[:, None, None] ** 2 * P for size in (n, m))
        inverse = np.linalg.inv(P)
        own = np.zeros((len(t), 6, 6))
        own[:, :3, :3] = t[:, None, None] * inverse
        own[:, 3:, 3:] = (t**3 / 12.0)[:, None, None] * inverse
        least = LEAST_HARDENING * np.trace(self.elastic[:, :3, :3], axis1=1, axis2=2) / t
        self.kinematic = yielding.kinematic[:, None, None] * own
        self.isotropic = np.maximum(yielding.isotropic, least)[:, None, None] * own

    def _respond(self, strain: Floats, memory: Remembered, triangles: slice) -> Response:
        """`strain` is elastic if nothing yields further."""
        flow = self._flow(strain, memory, triangles)
        frame, area = self.frame[triangles], self.area[triangles]
        stress = area[:, None] * np.einsum("tki,tk->ti", frame, flow.stress)
        tangent = area[:, None, None] * (np.swapaxes(frame, 1, 2) @ flow.tangent @ frame)
        elastic = np.einsum("tij,tj->ti", self.unframe[triangles], flow.plastic)
        left = strain - elastic
        value = 0.5 * float(np.sum(left * stress)) + float(np.sum(area * flow.lost))
        return Response(value, stress, tangent)

    def settle(
        self, x: Floats, memory: Directors, reduction: Reduction, initial: Floats | None = None
    ) -> tuple[Floats, Directors]:
        """Directors take up rotations, and triangles what has yielded."""
        assert isinstance(memory, Remembered)
        strain = self.strain(x, memory) - memory.inelastic
        if initial is not None:
            strain = strain - initial
        every = slice(0, len(strain))
        flow = self._flow(strain, memory, every)
        more = np.einsum("tij,tj->ti", self.unframe, flow.plastic)
        left, turned = super().settle(x, memory, reduction)
        assert isinstance(turned, Remembered)
        settled = replace(
            turned,
            inelastic=memory.inelastic + more,
            inner=flow.back[None],
            size=flow.size,
            lost=memory.lost + self.area * flow.lost,
        )
        return left, settled

    def _flow(self, strain: Floats, memory: Remembered, triangles: slice) -> Flow:
        elastic, frame = self.elastic[triangles], self.frame[triangles]
        back, size = memory.inner[0, triangles], memory.size[triangles]
        trial = np.einsum("tij,tjk,tk->ti", elastic, frame, strain)
        return flow_of(
            trial,
            back,
            size,
            elastic,
            self.shape[triangles],
            self.kinematic[triangles],
            self.isotropic[triangles],
        )


class Flow:
    """What one step yields: stress, plastic strain, back stress and size of the surface after it, and its tangent."""

    def __init__(
        self, stress: Floats, plastic: Floats, back: Floats, size: Floats, lost: Floats, tangent: Floats
    ) -> None:
        self.stress, self.plastic, self.back = stress, plastic, back  # (triangle, 6)
        self.size, self.lost = size, lost  # (triangle,); energy per area
        self.tangent = tangent  # (triangle, 6, 6)


def flow_of(
    trial: Floats,
    back: Floats,
    size: Floats,
    elastic: Floats,
    shape: Floats,
    kinematic: Floats,
    isotropic: Floats,
) -> Flow:
    """The return from trial stresses to the surface.

    Parameters
    ----------
    trial, back : (triangle, 6)
    size : (triangle,)
    elastic : (triangle, 6, 6)
    shape : (triangle, 6, 6)
        Y.
    kinematic, isotropic : (triangle, 6, 6)
        H t P^-1 and H t^3 / 12 P^-1.
    """
    xi = trial - back
    f = np.sqrt(np.einsum("ti,tij,tj->t", xi, shape, xi))
    out = Flow(trial, np.zeros_like(trial), back.copy(), size.copy(), np.zeros(len(trial)), elastic.copy())
    over = np.flatnonzero(f > size * (1.0 + ON_SURFACE))
    if not len(over):
        return out
    xi, y, c0, elastic = xi[over], shape[over], size[over], elastic[over]
    direction = np.einsum("tij,tj->ti", y, xi)
    growth = np.einsum("ti,tij,tj->t", direction, isotropic[over], direction) / f[over] ** 2  # w
    hard = kinematic[over] @ y  # W
    b = elastic @ y + hard
    mu, on, turned = _multiplier(xi, y, c0, growth, b)
    f_on = np.sqrt(np.einsum("ti,tij,tj->t", on, y, on))
    normal = np.einsum("tij,tj->ti", y, on)
    plastic = mu[:, None] * normal
    shift = mu[:, None] * np.einsum("tij,tj->ti", hard, on)
    out.stress = trial.copy()
    out.stress[over] = on + back[over] + shift
    out.plastic[over], out.back[over] = plastic, back[over] + shift
    out.size[over] = c0 + mu * f_on * growth
    out.lost[over] = np.einsum("ti,ti->t", 0.5 * (on + back[over] + shift + on + back[over]), plastic)
    # tangent: dS = (1 + mu W) d xi + W xi d mu,  d xi = A^-1 (d trial - B xi d mu)
    slack = 1.0 - mu * growth
    nu = normal / f_on[:, None]
    into = np.einsum("ti,tij->tj", nu, turned)
    bxi = np.einsum("tij,tj->ti", b, on)
    per = slack[:, None] * into / (f_on * growth + slack * np.einsum("ti,ti->t", into, bxi))[:, None]
    one = np.eye(6)
    by_xi = turned - np.einsum("tij,tj->ti", turned, bxi)[:, :, None] * per[:, None, :]
    by_trial = (one + mu[:, None, None] * hard) @ by_xi
    by_trial += np.einsum("tij,tj->ti", hard, on)[:, :, None] * per[:, None, :]
    tangent = by_trial @ elastic
    out.tangent[over] = 0.5 * (tangent + np.swapaxes(tangent, 1, 2))
    return out


def _multiplier(
    xi: Floats, y: Floats, size: Floats, growth: Floats, b: Floats
) -> tuple[Floats, Floats, Floats]:
    """mu, xi on the surface, and (1 + mu B)^-1, by Newton's method, which comes from below.

    Raises
    ------
    SolveError
        If it does not come to the surface.
    """
    mu: Floats = np.zeros(len(xi))
    one = np.eye(6)
    for _ in range(MOST_ITERATIONS):
        turned = np.linalg.inv(one + mu[:, None, None] * b)
        on = np.einsum("tij,tj->ti", turned, xi)
        f = np.sqrt(np.einsum("ti,tij,tj->t", on, y, on))
        gap = f * (1.0 - mu * growth) - size
        if np.all(np.abs(gap) <= ON_SURFACE * (size + f)):
            return mu, on, np.asarray(turned)
        slope = np.einsum("ti,tij,tjk,tkl,tl->t", on, y, turned, b, on) / f
        mu = np.maximum(mu + gap / (slope * (1.0 - mu * growth) + f * growth), 0.0)
    raise SolveError("the section does not come back to the surface of yielding: the step is too long")
