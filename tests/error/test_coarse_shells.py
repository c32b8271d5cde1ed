"""Few triangles of thin shells: what they do not follow counts in intervals, or nothing is said."""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.error.fold_ends import hidden_at_fold_ends
from kshell.error.foundations import HiddenLayers
from kshell.error.geometry_share import curvature_of_triangles
from kshell.mesh.halve import halved
from kshell.mesh.mesh import Mesh
from kshell.scene.structure import resolve
from kshell.verify.cases.catalogue import find
from tests.plate.plates import rectangle
from tests.shell.shapes import joined

MATERIAL = ks.Isotropic(E=1e9, nu=0.3)
LINEAR = {"large_deflection": False}


def meets(result: ks.Result, other: ks.Result) -> bool:
    mine, its = result.error["energy"], other.error["energy"]
    return bool(mine["lower"] <= its["upper"] and its["lower"] <= mine["upper"])


def saddle(n_u: int, n_v: int, thickness: float) -> ks.Scene:
    """On two sides: bending without stretching that few triangles cannot follow."""
    chart = ks.geometry.Chart.from_expressions("u", "v", "u*v/2")
    return ks.Scene(
        chart.parameter_mesh(n_u, n_v, u_range=(-1.0, 1.0), v_range=(-1.0, 0.8)),
        chart=chart,
        thickness=thickness,
        material=MATERIAL,
        supports=[ks.Clamped("v1"), ks.SimplySupported("u0")],
        loads=[ks.Pressure(10.0)],
        solve=LINEAR,
    )


def throat(n_u: int, n_v: int, thickness: float) -> ks.Scene:
    """On three sides: membrane forces, with layers of bending along supports."""
    chart = ks.geometry.Chart.from_expressions("cosh(v)*cos(u)", "cosh(v)*sin(u)", "v")
    return ks.Scene(
        chart.parameter_mesh(n_u, n_v, u_range=(0.0, 1.2), v_range=(-0.4, 0.7)),
        chart=chart,
        thickness=thickness,
        material=MATERIAL,
        supports=[ks.SimplySupported(["u0", "u1", "v0"])],
        loads=[ks.Pressure(80.0)],
        solve=LINEAR,
    )


@cache
def known(build: Any, thickness: float) -> ks.Result:
    result = ks.solve(build(4, 4, thickness), tolerance=1e-2, quantity="energy")
    assert result.error["estimate"] <= 1e-2
    return result


@pytest.mark.parametrize("cells", [(2, 2), (3, 2)])
@pytest.mark.parametrize("thickness", [3e-4, 3e-3])
@pytest.mark.parametrize("build", [saddle, throat])
def test_few_triangles_of_thin_shells(build: Any, thickness: float, cells: tuple[int, int]) -> None:
    for order in (2, 3, 4):
        result = ks.solve(build(*cells, thickness), element="koiter", order=order)
        assert meets(result, known(build, thickness)), order


def test_layers_are_hidden_until_triangles_see_them() -> None:
    """Half of what moments differ by at most, and a share of the membrane that falls as one over the size."""
    a, d = np.eye(3)[None] * 1e6, np.eye(3)[None] * 1e-2
    added = []
    for n in (2, 4, 64):
        mesh = ks.geometry.Cylinder(1.0).mesh(n, n, order=2, u_range=(0.0, 0.5), v_range=(0.0, 0.5))
        layers = HiddenLayers(mesh, 3, curvature_of_triangles(mesh), a, d)
        ones = np.ones(len(mesh.triangles))
        assert layers.any == (n < 64)
        assert (layers.energy(ones, 1e-6 * ones) <= layers.energy(ones, ones) + 1e-15).all()
        added.append(float(layers.energy(ones, 1e9 * ones).mean()))
    assert added[1] == pytest.approx(2.0 * added[0], rel=0.02)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_a_tube_of_few_triangles(order: int) -> None:
    """Clamped, under pressure: 8 triangles are longer than what bends at its ends."""
    case = find("shell.tube.clamped.pressure")
    run = next(run for run in case.runs if run.element == "koiter")
    fine = ks.solve(case.build(8, run.order), error="auto", tolerance=1e-4, quantity="energy", order="auto")
    result = ks.solve(case.build(1, run.order), element="koiter", order=order)
    assert meets(result, fine)


def profile(cells: int, wide: int) -> Mesh:
    """Three flat parts that meet at folds, and hang from one end of the first."""
    turn = np.radians([0.0, 55.0, -20.0])
    corner = np.concatenate([[[0.0, 0.0]], np.cumsum(np.stack([np.cos(turn), np.sin(turn)], axis=1), axis=0)])
    parts = []
    for (x, z), (dx, dz) in zip(corner[:-1], np.diff(corner, axis=0), strict=True):
        flat = rectangle(wide, cells, wobble=0.2)
        s, t = flat.points[:, 0], flat.points[:, 1]
        parts.append((np.stack([x + s * dx, 1.5 * t, z + s * dz], axis=1), flat.triangles))
    mesh = joined(*parts)
    ends = mesh.points[mesh.edges][:, :, 1]
    held = mesh.edges[(ends < 1e-9).all(axis=1) & (mesh.points[mesh.edges][:, :, 0] < 1.0 + 1e-9).all(axis=1)]
    return Mesh.from_arrays(mesh.points, mesh.triangles, {"held": held, "all": mesh.triangles})


@pytest.mark.parametrize("load", [ks.Pressure(10.0), ks.Traction((5.0, -20.0, 10.0))], ids=["p", "q"])
@pytest.mark.parametrize("wide", [1, 2, 3])
def test_coarse_folded_shells(wide: int, load: Any) -> None:
    """A fold begins at the end of the clamped edge: halvings find less and less, down to the thickness."""
    of = ks.Scene(
        profile(3, wide),
        thickness=3e-3,
        material=MATERIAL,
        supports=[ks.Clamped("held")],
        loads=[load],
        crease=5.0,
        solve={**LINEAR, "model": "shell"},
    )
    exact = ks.solve(of, order=3, tolerance=0.02, quantity="energy")
    assert exact.error["estimate"] <= 0.02
    for order in (1, 2, 3, 4):
        result = ks.solve(of, order=order)
        if "energy" in result.error:
            assert meets(result, exact), order
    assert "energy" in result.error


def test_folds_that_end_at_a_clamp() -> None:
    """Such as beside which another part is not held; across a whole section nothing turns."""
    mesh = profile(3, 2)
    pieces = np.repeat(np.arange(3), 12)
    whole = mesh.edges[(mesh.points[mesh.edges][:, :, 1] < 1e-9).all(axis=1)]
    mesh = Mesh.from_arrays(
        mesh.points, mesh.triangles, {"held": mesh.edges[mesh.groups["held"].members], "whole": whole}
    )
    more = {}
    for name, support in (
        ("held", ks.Clamped("held")),
        ("whole", ks.Clamped("whole")),
        ("free", ks.SimplySupported("held")),
        ("plane", ks.Symmetry("held")),
    ):
        of = ks.Scene(mesh, thickness=3e-3, material=MATERIAL, supports=[support])
        more[name] = hidden_at_fold_ends(resolve(of, mesh), pieces, 3e-3)
    end = np.flatnonzero(np.linalg.norm(mesh.points - [1.0, 0.0, 0.0], axis=1) < 1e-9)
    assert ((more["held"] > 1.0) == (mesh.triangles == end).any(axis=1)).all()
    for name in ("whole", "free", "plane"):
        assert more[name].tolist() == [1.0] * len(mesh.triangles)
    of = ks.Scene(mesh, thickness=0.5, material=MATERIAL, supports=[ks.Clamped("held")])
    assert hidden_at_fold_ends(resolve(of, mesh), pieces, 1.0).tolist() == [1.0] * len(mesh.triangles)


def barrel(n: int, **given: Any) -> ks.Scene:
    """A thin half tube of flat triangles under its weight, between diaphragms."""
    mesh = ks.geometry.Cylinder(1.0).mesh(n, n // 4, order=1, u_range=(0.0, np.pi), v_range=(0.0, 2.0))
    return ks.Scene(
        mesh,
        thickness=1e-3,
        material=MATERIAL,
        supports=[ks.Fixed(["v0", "v1"], "xy"), ks.Fixed((1.0, 0.0, 0.0), "z")],
        loads=[ks.Traction((0.0, -10.0, 0.0))],
        probes={"p": (0.0, 1.0, 1.0)},
        facets="flat",
        solve={**LINEAR, "order": 2, **given},
    )


def test_of_large_facets_nothing_is_said() -> None:
    coarse = ks.solve(barrel(8))
    assert coarse.error["kind"] == "none"
    assert "energy" not in coarse.error
    assert not coarse.error["probes"]
    assert "flat triangles stand for a curved surface" in coarse.error["why_not"]
    result = ks.solve(barrel(8), tolerance=0.05, quantity="p")
    assert len(result.error["levels"]) == 1
    assert any("has no interval; flat triangles stand for" in words for words in result.warnings)


def test_small_facets_have_wide_intervals() -> None:
    of = barrel(40)
    result = ks.solve(of)
    assert 0.2 < result.error["budget"]["geometry"] < 1.02 * 5.0 * np.pi / 40
    curved = dataclasses.replace(of, facets="curved")
    assert meets(result, ks.solve(curved))


def tee(cells: int) -> Mesh:
    parts = []
    for a, b in ((1.0, 0.0), (-1.0, 0.0), (0.47, 0.65)):
        flat = rectangle(1, cells)
        s, t = flat.points[:, 0], flat.points[:, 1]
        parts.append((np.stack([a * s, 1.5 * t, b * s], axis=1), flat.triangles))
    mesh = joined(*parts)
    x = mesh.points[mesh.edges]
    standing = (x[..., 2].max(axis=1) > 0.1) & (x[..., 2].min(axis=1) < 1e-9)
    groups = {
        name: mesh.edges[standing & (np.abs(x[..., 1] - y) < 1e-9).all(axis=1)]
        for name, y in (("near", 0.0), ("far", 1.5))
    }
    return Mesh.from_arrays(mesh.points, mesh.triangles, groups)


def test_small_components_of_large_motions() -> None:
    """A part that is supported at one end swings far, and a little along its axes."""
    tip = (-1.0, 1.5, 0.0)
    of = ks.Scene(
        tee(4),
        thickness=4e-3,
        material=ks.Isotropic(E=1e9, nu=0.3),
        supports=[ks.SimplySupported("near"), ks.Elastic("far", 1e5, "xyz")],
        loads=[ks.Traction((2.0, 45.0, 26.0)), ks.Pressure(37.0)],
        probes={"tip": tip},
        crease=5.0,
        solve={**LINEAR, "model": "shell"},
    )
    exact = ks.solve(dataclasses.replace(of, mesh=halved(halved(of.mesh))), order=4)
    for order in (2, 3, 4):
        result = ks.solve(of, order=order)
        off = np.abs(result.probe("tip")["u"] - exact.probe("tip")["u"])
        width = [np.array(r.error["probes"]["tip"]["u"]["half_width"]) for r in (result, exact)]
        assert (off <= width[0] + width[1]).all(), order
