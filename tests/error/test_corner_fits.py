"""Averages in corners: polynomials come back as they are, on curved surfaces, too, and errors are seen."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import kshell as ks
from kshell.error.corner_fits import CornerFits, carried, turned
from kshell.mesh.refine import bisect, longest_first
from kshell.shell.frames import frames_of_normals
from kshell.shell.reference import lagrange, lattice
from tests.plate.plates import rectangle

CLAMPED_CENTRE = 0.0056120240204  # of a square of side 1 under a force of 1 in its middle


def irregular(n: int, seed: int = 0) -> ks.Mesh:
    """Of the unit square, cut here and there, but at its corners."""
    mesh, chance = longest_first(rectangle(n)), np.random.default_rng(seed)
    for _ in range(2):
        away = np.abs(mesh.points[mesh.triangles].mean(axis=1)[:, :2] - 0.5).max(axis=1) < 0.25
        mesh = bisect(mesh, away & (chance.random(len(mesh.triangles)) < 0.3)).mesh
    return mesh


def places(mesh: ks.Mesh, degree: int) -> np.ndarray:
    return np.asarray(np.einsum("pn,tnx->tpx", lagrange(1, lattice(degree)), mesh.points[mesh.triangles]))


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_polynomials_come_back(degree: int) -> None:
    """Of two pieces with a jump between them, in frames that are turned from triangle to triangle."""
    mesh = irregular(6)
    position = places(mesh, degree)
    right = (mesh.points[mesh.triangles].mean(axis=1)[:, 0] > 0.5).astype(np.int64)
    angle = np.random.default_rng(1).random(len(mesh.triangles))
    axes = np.zeros((*position.shape[:2], 3, 3))
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    frame = np.stack([[c, s, zero], [-s, c, zero], [zero, zero, zero + 1.0]]).transpose(2, 0, 1)
    axes[:] = frame[:, None]
    x, y = position[..., 0], position[..., 1]
    tensor = np.stack([x**degree, 1.0 + x * y ** (degree - 1), 2.0 - y], axis=-1) + right[:, None, None]
    local = turned(tensor, axes[..., :2, :2])
    fits = CornerFits(mesh.triangles, mesh.triangle_edges, right, degree, position, axes)
    assert fits.values(local) == pytest.approx(local[fits.triangles, fits.nodes], abs=1e-9)
    assert len(np.unique(fits.triangles)) >= 2
    assert len(fits.triangles) == len(np.unique(fits.triangles)) * (3 + 2 * (degree - 1))


def test_tensors_are_carried_along_curved_surfaces() -> None:
    """A hoop force of a cylinder stays one; along a turned frame, and one that shows its back."""
    angle = np.array([0.0, 0.7, 1.4])
    normal = np.stack([np.cos(angle), np.sin(angle), np.zeros(3)], axis=-1)
    hoop = np.stack([-np.sin(angle), np.cos(angle), np.zeros(3)], axis=-1)
    frames = frames_of_normals(normal)
    first = np.einsum("kix,kx->ki", frames[:, :2], hoop)
    tensor = np.stack([first[:, 0] ** 2, first[:, 1] ** 2, first[:, 0] * first[:, 1]], axis=-1)
    back = frames * np.array([1.0, -1.0, -1.0])[:, None]
    for other, signs in ((frames, [1.0, 1.0, 1.0]), (back, [1.0, 1.0, -1.0])):
        moved = turned(tensor[[0, 0, 0]], carried(frames[[0, 0, 0]], other))
        assert moved == pytest.approx(tensor * np.array(signs), abs=1e-14)


def quarter(mesh: ks.Mesh) -> ks.Scene:
    """A clamped square under a force in its middle, as a shell: the quarter whose corner is the middle."""
    return ks.Scene(
        dataclasses.replace(mesh, points=mesh.points * 0.5),
        thickness=0.01,
        material=ks.Isotropic(E=12.0 * (1.0 - 0.09) * 1e6, nu=0.3),
        supports=[ks.Clamped(["right", "top"]), ks.Symmetry(["left", "bottom"])],
        loads=[ks.PointForce((0.0, 0.0, 0.0), (0.0, 0.0, 0.25))],
        probes={"middle": (0.0, 0.0, 0.0)},
        solve={"model": "shell", "element": "koiter", "order": 3, "large_deflection": False},
    )


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_force_on_a_corner(cut: bool, mirrored: bool) -> None:
    """Where two triangles meet at it, or one: of that plain averages see too little."""
    mesh = irregular(6) if cut else rectangle(4)
    if mirrored:
        points = mesh.points * np.array([-1.0, 1.0, 1.0]) + np.array([1.0, 0.0, 0.0])
        groups = {name: group for name, group in mesh.groups.items() if name not in ("left", "right")}
        groups |= {"left": mesh.groups["right"], "right": mesh.groups["left"]}
        mesh = dataclasses.replace(mesh, points=points, triangles=mesh.triangles[:, ::-1], groups=groups)
    result = ks.solve(quarter(mesh))
    off = abs(result.probes["middle"]["u"][2] - CLAMPED_CENTRE)
    width = result.error["probes"]["middle"]["u"]["half_width"][2]
    assert 1.3 * off < width < 20.0 * off
