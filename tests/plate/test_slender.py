"""Slender plates: rounding of the matrix is kept out of the balance."""

import numpy as np

import kshell as ks
from kshell.mesh.mesh import Mesh
from tests.plate.plates import rectangle, solve


def ring_sector(across, along, width, angle):
    """A sector of a ring of inner radius 1, order 2; groups as of a rectangle."""
    flat = rectangle(along, across)

    def bent(points):
        radius, turn = 1.0 + width * points[:, 1], angle * (1 - points[:, 0])
        return np.stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(len(turn))], axis=1)

    return Mesh(
        bent(flat.points), flat.triangles, bent(flat.points[flat.edges].mean(axis=1)), dict(flat.groups)
    )


def test_a_slender_ring_sector_is_in_balance():
    """A cantilever of length to width 80, with four triangles across: 9e-6 by the matrix alone."""
    result = solve(ring_sector(4, 64, 0.02, np.pi / 2), [ks.Clamped("left")], [ks.Pressure(1.0)])
    assert result.balance < 5e-8
    few = solve(ring_sector(1, 24, 0.02, np.pi / 2), [ks.Clamped("left")], [ks.Pressure(1.0)])
    assert few.balance < 5e-8
