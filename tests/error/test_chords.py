"""What curved borders of flat parts of shells lose where they are chords."""

import numpy as np
import pytest

from kshell.error.chords import CHORDS, share_of_flat_parts
from kshell.mesh.mesh import Mesh


def disks(edges, frames):
    """Fans of triangles about a centre, each in a plane of its own; the pieces."""
    angle = 2 * np.pi * np.arange(edges) / edges
    flat = np.concatenate([np.zeros((1, 2)), np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    rim = 1 + np.arange(edges)
    fan = np.stack([np.zeros(edges, dtype=int), rim, np.roll(rim, -1)], axis=1)
    points = [radius * flat @ frame[:2] + place for radius, frame, place in frames]
    triangles = [fan + k * len(flat) for k in range(len(frames))]
    mesh = Mesh(np.concatenate(points), np.concatenate(triangles).astype(np.int32), None, {})
    return mesh, np.repeat(np.arange(len(frames)), edges)


def frame(seed):
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]


def test_parts_in_any_planes_count_by_their_borders():
    edges = 24
    expected = CHORDS * (2 * np.pi / edges) ** 2
    for frames in (
        [(1.0, frame(0), np.zeros(3))],
        [
            (1.0, frame(1), np.zeros(3)),
            (3.0, frame(2), np.array([9.0, 1.0, 2.0])),
            (0.2, frame(3), np.full(3, -7.0)),
        ],
    ):
        assert share_of_flat_parts(*disks(edges, frames)) == pytest.approx(expected, rel=1e-6)


def test_parts_that_bend_do_not_count():
    mesh, pieces = disks(24, [(1.0, frame(4), np.zeros(3)), (1.0, frame(5), np.full(3, 5.0))])
    assert share_of_flat_parts(mesh, pieces) > 1e-3
    assert share_of_flat_parts(mesh, np.zeros_like(pieces)) == 0.0
