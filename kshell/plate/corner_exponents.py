"""Exponents of the deflection at corners of a plate, of any supports and stiffnesses around them.

Near a point the deflection is a smooth part and terms r^lambda f(theta) that fulfil the conditions of the edges and
lines which meet there. With lambda < 2 moments grow without bound; how fast a mesh is to be graded follows from the
least such lambda > 1. With the curvatures in polar axes

    kappa_lambda(f) = (lambda (lambda - 1) f, lambda f + f'', 2 (lambda - 1) f')

r^lambda f is in equilibrium if, for all g that fulfil what is held,

    int kappa_{2 - lambda}(g) : C(theta) kappa_lambda(f) dtheta = 0,

the condition of free edges and between stiffnesses included: a polynomial of degree 4 in s = lambda - 1, whose
eigenvalues are found with polynomials of theta in sectors of 90 degrees at most. For isotropic plates these are the
roots of Williams' equations, such as sin(s omega)^2 = s^2 sin(omega)^2 between clamped edges.

Symbols
-------
s          lambda - 1
C          bending stiffness in the axes of the polar angle
ray        an edge at the point; sectors lie between rays

Sources: M. L. Williams, Proc. 1st US Nat. Congr. Appl. Mech. (1952) 325-329; V. A. Kondratiev, Trans. Moscow Math. Soc.
16 (1967) 227-313.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule
from kshell.material.section import Section
from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from kshell.plate.forms import Bending
from kshell.plate.held import Supports

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BUBBLES = 7  # polynomials of a sector beside the cubics that tell value and slope at its ends
WIDEST = 0.5 * np.pi + 1e-6
RIGID = 1e-3  # of s: rotations are s = 0, found to the square root of rounding
BELOW = 1.0 - 1e-4  # of s: from here on moments are finite
STRAIGHT = 1e-6  # radians
DIGITS = 9  # of angles and stiffnesses that are told apart


@dataclass(frozen=True)
class Star:
    """What meets at a point.

    Attributes
    ----------
    angles : tuple of float
        Of the sectors, one after the other.
    held, turned : tuple of bool
        By ray, one more than sectors, or as many where the sectors close: whether the deflection, and whether its
        derivative across, is held.
    stiffness : tuple of tuples of 9 floats
        Of each sector, in the axes of the first ray, over the largest entry of all.
    closed : bool
        Whether the last ray is the first one.
    """

    angles: tuple[float, ...]
    held: tuple[bool, ...]
    turned: tuple[bool, ...]
    stiffness: tuple[tuple[float, ...], ...]
    closed: bool


class Plate(Protocol):
    """What is read of a `PlateProblem`."""

    domain: Domain
    supports: Supports
    section: Section
    bending: Bending

    @property
    def mesh(self) -> Mesh: ...


def corner_exponents(
    problem: Plate, domain: Domain | None = None, among: Sequence[int] | None = None
) -> dict[int, float]:
    """Exponents lambda < 2 of the deflection by vertex: their real parts where they are complex.

    Edges that are curved in the domain, that of the problem if absent, leave along their tangents. `among`: of these
    vertices alone, of all corners if absent.
    """
    mesh = problem.mesh
    lines = _Lines(problem, problem.domain if domain is None else domain)
    out: dict[int, float] = {}
    for vertex in lines.corners().tolist() if among is None else among:
        triangles = np.flatnonzero((mesh.triangles == vertex).any(axis=1))
        for star in _stars(problem, lines, vertex, triangles):
            exponent = least_exponent(star)
            if exponent < out.get(vertex, 2.0):
                out[vertex] = exponent
    return out


class _Lines:
    """Edges that carry a condition or part stiffnesses.

    Attributes
    ----------
    held, turned : (edge,) bool arrays
    kind : (triangle,) int array
        Stiffnesses, -1 where triangles are held whole.
    """

    def __init__(self, problem: Plate, domain: Domain) -> None:
        mesh = self.mesh = problem.mesh
        self._domain = domain
        self.held, self.turned = (np.zeros(len(mesh.edges), dtype=bool) for _ in range(2))
        self.kind = _kinds(problem)
        for group in problem.supports.held:
            self.held[group.line] = True
            self.turned[group.edges] = True
            self.kind[group.surface] = -1
            around = mesh.triangle_edges[group.surface].ravel()
            self.held[around] = self.turned[around] = True
        low, high = np.full(len(mesh.edges), np.iinfo(np.int64).max), np.full(len(mesh.edges), -2)
        for column in mesh.triangle_edges.T:
            np.minimum.at(low, column, self.kind)
            np.maximum.at(high, column, self.kind)
        low[mesh.edge_counts == 1] = -1  # nothing and what is held whole are alike
        self._special = (self.held | self.turned | (low != high)) & (high >= 0)
        self._alike = np.stack([self.held, self.turned, low, high], axis=1)

    def corners(self) -> Ints:
        """Vertices where such edges end, branch, turn or change."""
        mesh, edges = self.mesh, np.flatnonzero(self._special)
        ends = mesh.edges[edges].astype(np.int64)
        along = self._domain.tangents(edges) * np.array([1.0, -1.0])[:, None]
        _, code = np.unique(self._alike[edges], axis=0, return_inverse=True)
        count = np.zeros(len(mesh.points), dtype=np.int64)
        total = np.zeros((len(mesh.points), 2))
        low, high = np.full(len(mesh.points), len(edges)), np.full(len(mesh.points), -1)
        for end in range(2):
            np.add.at(count, ends[:, end], 1)
            np.add.at(total, ends[:, end], along[:, end])
            np.minimum.at(low, ends[:, end], code.ravel())
            np.maximum.at(high, ends[:, end], code.ravel())
        straight = (count == 2) & (np.linalg.norm(total, axis=1) < STRAIGHT) & (low == high)
        return np.flatnonzero((count > 0) & ~straight)

    def outgoing(self, vertex: int, edges: NDArray[np.integer]) -> Floats:
        """(n, 2) directions in which edges leave a vertex."""
        first = self.mesh.edges[edges, 0] == vertex
        tangents = self._domain.tangents(edges.astype(np.int64))
        return np.where(first[:, None], tangents[:, 0], -tangents[:, 1])


def _kinds(problem: Plate) -> Ints:
    """(T,) a number for each stiffness; one for all where it varies inside triangles."""
    count = len(problem.mesh.triangles)
    if problem.section.uniform or not problem.section.constant_per_triangle:
        return np.zeros(count, dtype=np.int64)
    stiffness = problem.section.bending_per_triangle().reshape(count, 9)
    rounded = np.round(stiffness / np.abs(stiffness).max(), DIGITS)
    return np.unique(rounded, axis=0, return_inverse=True)[1].ravel().astype(np.int64)


def _stars(problem: Plate, lines: _Lines, vertex: int, triangles: Ints) -> list[Star]:
    """The fans of triangles at a vertex, those between neighbouring lines joined to one sector."""
    mesh = problem.mesh
    after: dict[int, tuple[int, int]] = {}  # from the first to the next vertex around, and the triangle
    for t in triangles[lines.kind[triangles] >= 0].tolist():
        corners = mesh.triangles[t].tolist()
        k = corners.index(vertex)
        after[corners[(k + 1) % 3]] = corners[(k + 2) % 3], t
    inner = {b for b, _ in after.values()}
    starts = [a for a in after if a not in inner]
    out = []
    while after:
        a = starts.pop() if starts else next(iter(after))
        first, walk = a, []
        while a in after:
            b, t = after.pop(a)
            walk.append((a, b, t))
            a = b
        out.append(_star(problem, lines, vertex, walk, closed=a == first))
    return out


def _star(problem: Plate, lines: _Lines, vertex: int, walk: list[tuple[int, int, int]], closed: bool) -> Star:
    mesh = problem.mesh
    rays = [a for a, _, _ in walk] + [walk[-1][1]]
    edges = mesh.edge_index(np.array([[min(vertex, r), max(vertex, r)] for r in rays]))
    sector = np.array([t for _, _, t in walk])
    apart = np.ones(len(rays), dtype=bool)
    apart[1:-1] = lines.kind[sector[1:]] != lines.kind[sector[:-1]]
    if closed:
        apart[[0, -1]] = lines.kind[sector[0]] != lines.kind[sector[-1]]
    apart |= lines.held[edges] | lines.turned[edges]
    if closed:  # begin at a line
        shift = int(np.argmax(apart[:-1]))
        rays, sector = rays[shift:-1] + rays[: shift + 1], np.roll(sector, -shift)
        edges, apart = (np.append(np.roll(x[:-1], -shift), x[shift]) for x in (edges, apart))
        apart[[0, -1]] = True
    along = lines.outgoing(vertex, edges)
    polar = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
    cut = np.flatnonzero(apart)
    place = np.broadcast_to(mesh.points[vertex, :2], (len(sector), 1, 2))
    stiffness = problem.bending.at(sector, place)[cut[:-1], 0]
    turned = _in_polar_axes(stiffness, np.full(len(stiffness), polar[0]))
    turned = np.round(turned / np.abs(turned).max(), DIGITS) + 0.0
    return Star(
        tuple(np.round(np.diff(polar[cut]), DIGITS).tolist()),
        tuple(lines.held[edges[cut]].tolist()),
        tuple(lines.turned[edges[cut]].tolist()),
        tuple(tuple(c) for c in turned.reshape(-1, 9).tolist()),
        closed,
    )


@lru_cache(maxsize=256)
def least_exponent(star: Star) -> float:
    """The least real part of lambda in (1, 2); 2 where there is none."""
    parts: list[tuple[float, float, int]] = []  # begin, end, sector
    conditions: list[tuple[bool, bool]] = []
    begin = 0.0
    for k, angle in enumerate(star.angles):
        pieces = int(np.ceil(angle / WIDEST))
        ends = begin + angle * np.arange(pieces + 1) / pieces
        parts += [(a, b, k) for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)]
        conditions += [(star.held[k], star.turned[k])] + [(False, False)] * (pieces - 1)
        begin += angle
    if not star.closed:
        conditions.append((star.held[-1], star.turned[-1]))
    rays, own = len(conditions), BUBBLES
    count = 2 * rays + own * len(parts)
    terms = np.zeros((5, count, count))
    for number, (a, b, k) in enumerate(parts):
        c = np.array(star.stiffness[k]).reshape(3, 3)
        last = (number + 1) % rays
        ends_of = np.array([2 * number, 2 * number + 1, 2 * last, 2 * last + 1])
        at = np.append(ends_of, 2 * rays + own * number + np.arange(own))
        terms[np.ix_(np.arange(5), at, at)] += _sector_terms(a, b, c)
    free = np.ones(count, dtype=bool)
    free[: 2 * rays] = ~np.array(conditions).ravel()
    terms = terms[:, free][:, :, free]
    n = int(free.sum())
    companion = np.zeros((4 * n, 4 * n))
    companion[: 3 * n, n:] = np.eye(3 * n)
    solved = np.linalg.solve(terms[4], terms[:4].transpose(1, 0, 2).reshape(n, 4 * n))
    companion[3 * n :] = -solved
    s = np.linalg.eigvals(companion).real
    return 1.0 + float(np.min(s, where=(s > RIGID) & (s < BELOW), initial=1.0))


def _sector_terms(begin: float, end: float, stiffness: Floats) -> Floats:
    """(5, n, n) coefficients of s^0 ... s^4 of the form on a sector, rows test functions."""
    x, w, f = _unit_functions()
    size = end - begin
    f = f / size ** np.arange(3)[:, None, None]  # (derivative, point, function)
    f[:, :, [1, 3]] *= size  # whose unknowns are slopes
    c = (
        _in_polar_axes(np.broadcast_to(stiffness, (len(x), 3, 3)), begin + size * x)
        * (w * size)[:, None, None]
    )
    zero = np.zeros_like(f[0])
    trial = np.stack(  # powers of s: (power, component, point, function)
        [[zero, f[0] + f[2], zero], [f[0], f[0], 2.0 * f[1]], [f[0], zero, zero]]
    )
    test = trial * np.array([1.0, -1.0, 1.0])[:, None, None, None]
    out = np.zeros((5, f.shape[2], f.shape[2]))
    for i in range(3):
        for j in range(3):
            out[i + j] += np.einsum("apm,pab,bpn->mn", test[i], c, trial[j])
    return out


@lru_cache(maxsize=1)
def _unit_functions() -> tuple[Floats, Floats, Floats]:
    """Points and weights on [0, 1], and (3, point, 4 + BUBBLES) cubics and bubbles there with two derivatives."""
    from numpy.polynomial import Polynomial

    x, w = interval_rule(BUBBLES + 8)
    t = Polynomial([0.0, 1.0])
    cubics = [(1 - t) ** 2 * (1 + 2 * t), (1 - t) ** 2 * t, t**2 * (3 - 2 * t), t**2 * (t - 1)]
    bubbles = [16 * (t * (1 - t)) ** 2 * (2 * t - 1) ** k for k in range(BUBBLES)]
    table = [[f.deriv(m)(x) if m else f(x) for f in cubics + bubbles] for m in range(3)]
    return x, w, np.array(table).transpose(0, 2, 1)


def _in_polar_axes(stiffness: Floats, angle: Floats) -> Floats:
    """(n, 3, 3) C in axes turned by an angle (n,)."""
    c, s = np.cos(angle), np.sin(angle)
    back = np.stack(  # curvatures in x, y from those in the turned axes
        [[c * c, s * s, -c * s], [s * s, c * c, c * s], [2 * c * s, -2 * c * s, c * c - s * s]]
    )
    back = np.moveaxis(back, 2, 0)
    return np.asarray(back.swapaxes(1, 2) @ stiffness @ back)
