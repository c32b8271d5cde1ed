"""Stresses that grow without bound are named and kept out of the largest; what is balanced is not warned of."""

from __future__ import annotations

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import disk, rectangle

STEEL = ks.Isotropic(E=2e11, nu=0.3, density=7800)


def solved(mesh, supports, loads, **options):
    scene = ks.Scene(mesh=mesh, thickness=0.02, material=STEEL, supports=supports, loads=loads)
    return ks.solve(scene, large_deflection=False, **options)


@pytest.mark.parametrize("model", ["plate", "shell"])
def test_a_column_under_a_slab(model):
    """Refined, the peak grows like log h; the value farther off converges."""
    far, peaks = [], []
    for n in (8, 16):
        supports = [ks.SimplySupported(["left", "right", "bottom", "top"]), ks.Fixed((0.5, 0.5, 0), "z")]
        with pytest.warns(ks.KshellWarning, match="grow without bound at a point support"):
            result = solved(rectangle(n), supports, [ks.Pressure(-1e4)], model=model)
        found = result.extremes["von_mises"]
        assert found["peak"]["why"] == "a point support at (0.5, 0.5)"
        assert found["peak"]["value"] > found["value"]
        distance = np.linalg.norm(np.array(found["at"]) - [0.5, 0.5, 0])
        assert distance > 2 / n  # the thickness is less
        far.append(found["value"])
        peaks.append(found["peak"]["value"])
    assert peaks[1] > 1.1 * peaks[0]
    assert max(far) < min(peaks)


def test_a_point_force():
    with pytest.warns(ks.KshellWarning, match="grow without bound at a point force"):
        result = solved(
            rectangle(8),
            [ks.Clamped("left"), ks.Clamped("right")],
            [ks.PointForce((0.5, 0.5, 0), (0, 0, 1e3))],
        )
    assert result.extremes["von_mises"]["peak"]["at"] == pytest.approx([0.5, 0.5, 0.0])


def test_a_mesh_without_peaks_says_none():
    result = solved(rectangle(4), [ks.Clamped("left")], [ks.Pressure(1.0)])
    assert result.extremes["von_mises"]["peak"] is None
    assert result.to_dict()["extremes"]["von_mises"]["peak"] is None
    assert not result.warnings


@pytest.mark.parametrize("options", [{"model": "plate"}, {"element": "morley"}, {"model": "shell"}])
def test_a_body_that_is_lifted_is_in_balance(options):
    mesh = disk(4, 2)
    low, high = mesh.points.argmin(axis=0), mesh.points.argmax(axis=0)
    corners = [tuple(mesh.points[v]) for v in (low[0], high[0], high[1])]
    supports = [
        ks.Fixed(point, letters, value=(0, 0, 0.3))
        for point, letters in zip(corners, ("xyz", "yz", "z"), strict=True)
    ]
    result = solved(mesh, supports, [], **options)
    assert result.balance < 1e-6
    assert not result.warnings


@pytest.mark.parametrize("load", [{"mean": 100.0}, {"gradient": 1e3}])
def test_a_free_disk_that_is_heated_is_in_balance(load):
    mesh = disk(4, 2)
    low, high = mesh.points.argmin(axis=0), mesh.points.argmax(axis=0)
    corners = [tuple(mesh.points[v]) for v in (low[0], high[0], high[1])]
    supports = [ks.Fixed(point, letters) for point, letters in zip(corners, ("xyz", "yz", "z"), strict=True)]
    result = solved(mesh, supports, [ks.Temperature(**load, expansion=1e-5)])
    assert result.balance < 1e-6
    assert not any("reactions differ" in words for words in result.warnings)


def with_lines(edges_of):
    """A square with the group wall of the edges that a function of their ends (edge, 2, 3) chooses."""
    mesh = rectangle(16)
    wall = mesh.edges[edges_of(mesh.points[mesh.edges])]
    groups = {name: mesh.edges[group.members] for name, group in mesh.groups.items() if group.dimension == 1}
    return ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups | {"wall": wall})


def test_the_end_of_a_line_inside_that_is_held():
    mesh = with_lines(
        lambda x: (abs(x[:, :, 1] - 0.5) < 1e-9).all(axis=1) & (x[:, :, 0] < 0.5 + 1e-9).all(axis=1)
    )
    supports = [ks.SimplySupported("edge"), ks.Fixed("wall", "z")]
    with pytest.warns(
        ks.KshellWarning, match="grow without bound at the end, or a corner, of a support inside"
    ):
        result = solved(mesh, supports, [ks.Pressure(1e3)])
    peak = result.extremes["von_mises"]["peak"]
    assert peak["at"] == pytest.approx([0.5, 0.5, 0.0])


def test_a_line_that_is_held_from_edge_to_edge_has_no_end():
    mesh = with_lines(lambda x: (abs(x[:, :, 1] - 0.5) < 1e-9).all(axis=1))
    result = solved(mesh, [ks.SimplySupported("edge"), ks.Fixed("wall", "z")], [ks.Pressure(1e3)])
    assert result.extremes["von_mises"]["peak"] is None
    assert not [words for words in result.warnings if "without bound" in words]


def test_a_larger_stress_of_another_cause_near_a_peak_is_no_number_of_the_mesh():
    """A clamped edge under pressure, two triangles beside a weak force: the largest stress is that of the edge."""
    supports = [ks.Clamped("left"), ks.SimplySupported(["right", "bottom", "top"])]
    result = solved(rectangle(8), supports, [ks.Pressure(1e4), ks.PointForce((0.25, 0.5, 0), (0, 0, 1.0))])
    alone = solved(rectangle(8), supports, [ks.Pressure(1e4)])
    found = result.extremes["von_mises"]
    assert found["peak"] is None
    assert found["value"] == pytest.approx(alone.extremes["von_mises"]["value"], rel=0.01)
    assert not [words for words in result.warnings if "without bound" in words]


def test_a_corner_that_turns_into_the_plate_is_a_peak():
    """Its stress grows on with every mesh; that of the rest does not."""
    far, peaks = [], []
    for n in (8, 16):
        whole = rectangle(n)
        centre = whole.points[whole.triangles].mean(axis=1)
        kept = whole.triangles[(centre[:, 0] < 0.5) | (centre[:, 1] < 0.5)]
        used = np.unique(kept)
        mesh = ks.Mesh.from_arrays(whole.points[used], np.searchsorted(used, kept))
        ends = mesh.edges[mesh.boundary_edges]
        mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"rim": ends})
        with pytest.warns(ks.KshellWarning, match="grow without bound at a re-entrant corner"):
            result = solved(mesh, [ks.SimplySupported("rim")], [ks.Pressure(1e4)])
        found = result.extremes["von_mises"]
        assert found["peak"]["at"] == pytest.approx([0.5, 0.5, 0.0])
        far.append(found["value"])
        peaks.append(found["peak"]["value"])
    assert peaks[1] > 1.15 * peaks[0]
    assert max(far) < min(peaks)
