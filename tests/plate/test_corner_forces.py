"""Concentrated forces at corners, together with the forces along the edges, make up the reaction."""

import numpy as np
import pytest

from verification.cases import Run, find
from verification.cases.quantities import EdgeForce


def force_along_x0(result, cells):
    """Integral of Kirchhoff's force of the support along x = 0, 0 <= y <= 1."""
    at, weight = np.polynomial.legendre.leggauss(6)
    y = ((np.arange(cells)[:, None] + (at + 1) / 2) / cells).ravel()
    force = [-EdgeForce((0.0, float(place)), "x", 1e-3).of(result) for place in y]
    return np.dot(force, np.tile(weight / 2 / cells, cells))


@pytest.mark.parametrize(
    ("id", "shares"),
    [("ssss.uniform.ba1", (0.5, 0.5)), ("levy.SFSF.ba1", (1, 1)), ("levy.SSSF.ba1", (0.5, 1))],
)
def test_edge_and_corner_forces_make_up_the_reaction(id, shares):
    """A corner between two supported sides counts half for each, one beside a free side in full."""
    result = find(id).solve(Run("argyris", 12))
    reaction = result.reactions["x0"]
    corners = {round(float(c["at"][1])): c["force"][2] for c in reaction["corners"]}
    assert sorted(corners) == [0, 1]
    concentrated = shares[0] * corners[0] + shares[1] * corners[1]
    assert force_along_x0(result, 12) + concentrated == pytest.approx(reaction["force"][2], rel=2e-3)


def test_a_clamped_corner_has_none():
    result = find("clamped.uniform.ba1").solve(Run("argyris", 4))
    forces = [c["force"][2] for group in result.reactions.values() for c in group["corners"]]
    assert np.abs(forces).max() < 1e-12
