"""Polygons with one element on a side: as the same polygons in finer meshes, or with an interval that holds these."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.error.curve_doubt import polygon_share
from kshell.mesh.halve import halved
from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from tests.plate.plates import disk, egg, ellipse, rectangle

STEEL = ks.Isotropic(E=210e9, nu=0.3, density=7850.0)


def polygon(corners: Any) -> Mesh:
    """A fan of one triangle on each side around the middle."""
    p = np.array(corners)
    k = np.arange(len(p))
    after = (k + 1) % len(p)
    triangles = np.stack([0 * k, 1 + k, 1 + after], axis=1)
    return Mesh.from_arrays(
        np.concatenate([[p.mean(axis=0)], p]), triangles, {"edge": np.stack([1 + k, 1 + after], axis=1)}
    )


def irregular(seed: int) -> Mesh:
    """A convex polygon of 4 to 8 sides."""
    rng = np.random.default_rng(seed)
    while True:
        n = int(rng.integers(4, 9))
        angle = 2 * np.pi * (np.arange(n) + rng.uniform(-0.35, 0.35, n)) / n
        radius = rng.uniform(0.8, 1.2, n)
        p = radius[:, None] * np.stack([1.5 * np.cos(angle), np.sin(angle)], axis=1)
        z = np.diff(np.concatenate([p, p[:2]]), axis=0) @ np.array([1.0, 1j])
        if (np.angle(z[1:] / z[:-1]) > 0.1).all():
            return polygon(p)


def scene(mesh: Mesh, support: type = ks.Clamped) -> ks.Scene:
    content: dict[str, Any] = {"supports": [support("edge")], "loads": [ks.Pressure(100.0)]}
    place = mesh.points[mesh.triangles].mean(axis=1).mean(axis=0)
    return ks.Scene(mesh, thickness=0.01, material=STEEL, probes={"p": tuple(place)}, **content)


def interval(result: ks.Result) -> tuple[float, float]:
    w, half = result.probe("p")["u"][2], result.error["probes"]["p"]["u"]["half_width"][2]
    return w - half, w + half


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("skew", [0.3, 0.5, 0.8])
@pytest.mark.parametrize("n", [(1, 1), (2, 1), (4, 1)])
def test_parallelograms_with_one_element_on_a_side(n: tuple[int, int], skew: float) -> None:
    """The turn of the sharp corners is no curvature, at which the others would be alike."""
    mesh = rectangle(*n, skew=skew)
    domain = Domain(mesh, curved=True)
    assert not domain.curves.curved.any()
    assert domain.curves.sharpest < 1e-9


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize(
    "seed", [*range(5), *[pytest.param(k, marks=pytest.mark.full) for k in range(5, 25)]]
)
def test_irregular_polygons_are_held_by_intervals(seed: int) -> None:
    mesh = irregular(seed)
    support = (ks.Clamped, ks.SimplySupported)[seed % 2]
    fine = halved(halved(mesh))
    low, high = interval(ks.solve(scene(fine, support), element="hhj", order=4, large_deflection=False))
    for options in ({"order": 5}, {"tolerance": 0.02, "quantity": "p"}):
        try:
            result = ks.solve(scene(mesh, support), element="hhj", large_deflection=False, **options)  # type: ignore[arg-type]
        except ks.InputError as refused:
            assert "folds over" in str(refused)  # noqa: PT017
            continue
        mine = interval(result)
        assert mine[0] <= high
        assert low <= mine[1]


@pytest.mark.parametrize("whole", [(2,), (1, 2), (2, 3)], ids=str)
def test_a_side_cut_off_is_one_on_every_mesh(whole: tuple[int, ...]) -> None:
    """Two corners with one edge between them are no arc when the sides next to it have more edges than it."""
    turn = np.radians([90.0, 107.0, 124.0])  # the other corners are sharp
    steps = np.array([1.0, 0.25, 1.0])[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    p = np.concatenate([[[0.0, 0.0], [2.0, 0.0]], [2.0, 0.0] + np.cumsum(steps, axis=0), [[0.0, 1.0]]])
    after = np.roll(p, -1, axis=0)
    sides = [[p[k]] if k in whole else [p[k], 0.5 * (p[k] + after[k])] for k in range(6)]
    curves = Domain(polygon(np.concatenate(sides)), curved=True).curves
    assert curves.sharpest == 0.0
    assert not curves.curved.any()


def test_smooth_lines_are_in_no_doubt() -> None:
    """Circles and ellipses of few nodes, and smooth lines of some more, are no polygons."""
    for mesh in (disk(1), disk(2), ellipse(2), egg(3)):
        assert polygon_share(Domain(mesh, curved=True)) == 0.0
    assert polygon_share(Domain(egg(1), curved=True)) > 0.3


@pytest.mark.parametrize("n", [36, 60])
def test_divided_chords_may_be_a_polygon(n: int) -> None:
    """A clamped disk changes by twice the share between circle and chords, 2/3 of 1 - cos(pi / n)."""
    angle = 2 * np.pi * np.arange(n) / n
    corners = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    sides = 0.5 * (corners + np.roll(corners, -1, axis=0))
    domain = Domain(polygon(np.stack([corners, sides], axis=1).reshape(-1, 2)), curved=True)
    assert domain.curves.curved.all()
    assert polygon_share(domain) > 4 / 3 * (1 - np.cos(np.pi / n))
