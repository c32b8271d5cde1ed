"""Rules by which jumps inside triangles and edges are found: parts, layers beside the rim, and a look just inside it.

A rule of few points sees no strip that is narrower than its distance from the rim, 6 % of the height of a triangle; nor
do rules on its parts, 3 and 1.6 %. So values just inside the rim are compared with the cubics that those at the points
of the rule are continued by, and where they are not alike a rule whose layers grow thinner toward the rim tells how
much lies in the strip.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.values.entire import on_balls

Floats = NDArray[np.float64]
Rule = tuple[Floats, Floats]  # barycentric coordinates (q, 3 or 2) and weights (q,) of sum 1

DEGREES = (
    6,
    8,
    11,
    14,
)  # of the rules of the elements; what one misses of a jump is luck, and no measure of another
NEAR = 1e-6  # distance from the rim of what is looked at, of the height: more than rounding of coordinates
CUBIC = 3
LAYERS, THINNER = 6, 4.0  # each so many times thinner than the one before
WIDER = 6.0  # balls of complex places than parts of triangles
IN_LAYER = 4  # points along and across, exact to degree 6
LOOKS = 6  # along each edge of a triangle

# corners of the four parts of a triangle and of an edge, in their barycentric coordinates
PARTS = {
    3: 0.5
    * np.array(
        [
            [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
            [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
            [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
            [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
        ]
    ),
    2: 0.25 * np.array([[[4, 0], [3, 1]], [[3, 1], [2, 2]], [[2, 2], [1, 3]], [[1, 3], [0, 4]]]),
}


@lru_cache(maxsize=2)
def rules_of_elements(k: int) -> list[Rule]:
    """The rules that are taken for triangles (k = 3) or edges (2), of rising degree."""
    out = []
    for degree in DEGREES:
        if k == 3:
            inner, shares = triangle_rule(degree)
            out.append((np.column_stack([1.0 - inner.sum(axis=1), inner]), 2.0 * shares))
        else:
            s, shares = interval_rule(degree // 2 + 1)
            out.append((np.column_stack([1.0 - s, s]), shares))
    return out


@lru_cache(maxsize=2)
def rules(k: int) -> list[Rule]:
    """The first of them, the same on parts, and on theirs."""
    out = [rules_of_elements(k)[0]]
    for _ in range(2):
        places, shares = out[-1]
        places = np.einsum("qk,pkb->pqb", places, PARTS[k]).reshape(-1, k)
        out.append((places, np.tile(shares, len(PARTS[k])) / len(PARTS[k])))
    return out


@lru_cache(maxsize=2)
def layered(k: int) -> Rule:
    """A rule of layers that grow thinner toward the edges of a triangle (k = 3), or the ends of an edge (2)."""
    ends = np.append(THINNER ** -np.arange(LAYERS), 0.0)  # distance from the rim over that of the centre
    t, w = interval_rule(IN_LAYER)
    away = (ends[1:, None] + (ends[:-1] - ends[1:])[:, None] * t).ravel()
    share = ((ends[:-1] - ends[1:])[:, None] * w).ravel()
    rim = np.eye(k)[:, None]  # (corner, 1, k)
    if k == 3:
        s, along = interval_rule(IN_LAYER)
        on_edges = np.stack([np.zeros_like(s), 1.0 - s, s], axis=1)
        rim = np.stack([np.roll(on_edges, turn, axis=1) for turn in range(3)])  # (edge, s, 3)
        share = (2.0 * (1.0 - away) * share)[:, None] * along
    else:
        share = share[:, None]
    centre = np.full(k, 1.0 / k)
    places = rim[:, None] + away[:, None, None] * (centre - rim[:, None])  # (edge or end, layer, s, k)
    return places.reshape(-1, k), np.tile(share.ravel(), k) / k


@lru_cache(maxsize=2)
def just_inside(k: int) -> tuple[Floats, Floats]:
    """Barycentric coordinates (n, k) of places just inside the rim, and the cubics through the points of the rule.

    The latter are (n, q): values there by least squares from those at the points of `rules`.
    """
    if k == 2:
        places = np.array([[1.0 - NEAR, NEAR], [NEAR, 1.0 - NEAR]])
    else:
        s = (np.arange(LOOKS) + 0.5) / LOOKS
        edge = np.stack([np.full_like(s, NEAR), (1.0 - NEAR) * (1.0 - s), (1.0 - NEAR) * s], axis=1)
        places = np.concatenate([np.roll(edge, turn, axis=1) for turn in range(3)])
    return places, _powers(places) @ np.linalg.pinv(_powers(rules(k)[0][0]))


@dataclass(frozen=True)
class Look:
    """Places where a load is asked for at once.

    Attributes
    ----------
    places : (q, k) array
        Barycentric coordinates.
    shares : (q,) array
        Weights; zero where they are not those of a rule.
    slices : list of slice
        Of each rule.
    by_rule : (rule, q) array
        Weights of each rule, zero at the places of others.
    """

    places: Floats
    shares: Floats
    slices: list[slice]
    by_rule: Floats


@lru_cache(maxsize=2)
def looks(k: int) -> tuple[Look, Look]:
    """The first rule of the elements, that of its parts, the rim; then two fine rules, and those of all elements."""
    whole, parts, quarters = rules(k)
    rim = just_inside(k)[0]
    return _look([whole, parts, (rim, np.zeros(len(rim)))]), _look(
        [quarters, layered(k), *rules_of_elements(k)]
    )


def _look(rules: list[Rule]) -> Look:
    ends = np.cumsum([0, *(len(shares) for _, shares in rules)]).tolist()
    places, shares = (np.concatenate(parts) for parts in zip(*rules, strict=True))
    slices = [slice(a, b) for a, b in pairwise(ends)]
    by_rule = np.zeros((len(rules), len(shares)))
    for row, own in zip(by_rule, slices, strict=True):
        row[own] = shares[own]
    return Look(places, shares, slices, by_rule)


def _powers(places: Floats) -> Floats:
    """(n, power) monomials of cubics."""
    if places.shape[1] == 2:
        return np.asarray(places[:, 1:] ** np.arange(CUBIC + 1))
    x, y = places[:, 1], places[:, 2]
    return np.stack([x**i * y**j for i in range(CUBIC + 1) for j in range(CUBIC + 1 - i)], axis=1)


@lru_cache(maxsize=2)
def parts_of(k: int) -> tuple[Floats, Floats]:
    """(part, corner, k) corners of the parts and (part, k) their centres, in barycentric coordinates."""
    return PARTS[k], PARTS[k].mean(axis=1)


def beyond_parts(value: Any, corners: Floats) -> Floats | None:
    """How much a rule of degree 6 on the parts of triangles or edges may miss of a formula, over their size.

    The Taylor series of degree 6 around the centre of a part is integrated exactly. What follows is at most
    r (d/R)^7 / (1 - d/R) at a distance d, r from `kshell.values.entire.on_balls` of radius R; d^7 is at most d^6 times
    the largest, which the rule integrates exactly, too, and both integral and rule have a part in what is missed.

    Parameters
    ----------
    value : number, str, callable, or a sequence of numbers and strings
    corners : (n, k, 3) array

    Returns
    -------
    (n,) array; None where the value may jump or have poles.
    """
    k = corners.shape[1]
    parts, middles = parts_of(k)
    places, shares = rules(k)[0]
    centre = middles @ corners  # (n, part, 3)
    away = parts[0] @ corners - centre[:, :1]  # all parts are alike
    squares = (away * away).sum(axis=2)
    rho = np.sqrt(squares.max(axis=1))
    points = places @ away
    d6 = ((points * points).sum(axis=2) ** 3) @ shares
    radius = WIDER * rho
    grown = on_balls(value, centre.reshape(-1, 3), np.repeat(radius, len(parts)))
    if grown is None:
        return None
    share = 2.0 * rho * d6 / (radius**7 * (1.0 - 1.0 / WIDER))
    return np.asarray(grown.reshape(-1, len(parts)).mean(axis=1) * share)
