"""Koiter elements of orders 4 to 6: Scordelis-Lo roof against cubics, estimate of the error, large deflections."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import kshell as ks
from kshell.shell.koiter.model import moved_mesh
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import lagrange


def roof(n: int) -> ks.Scene:
    """A quarter of the roof, n by n cells."""
    angle = np.radians(40.0)
    mesh = ks.geometry.Plane().parameter_mesh(
        n, n, ("crown", "free", "middle", "wall"), u_range=(0, angle), v_range=(0, 25)
    )
    return ks.Scene(
        mesh,
        chart=ks.geometry.Chart.from_expressions("25*sin(u)", "v", "25*cos(u)"),
        thickness=0.25,
        material=ks.Isotropic(E=4.32e8, nu=0.0),
        supports=[ks.Symmetry("crown"), ks.Symmetry("middle"), ks.Fixed("wall", "xz")],
        loads=[ks.Traction((0, 0, -90.0))],
        probes={"p": (25 * np.sin(angle), 0, 25 * np.cos(angle))},
    )


# of cubics with 512 triangles and quartics with 128, equal in nine digits
DEFLECTION, ENERGY = -0.3005924567, 1206.64425


def test_quartics_converge_faster_than_cubics():
    off = []
    for n in (2, 4):
        found = ks.solve(roof(n), element="koiter", order=4, large_deflection=False, error="off")
        off.append(abs(found.strain_energy / ENERGY - 1))
        assert found.balance < 1e-9
        assert found.model["order"] == 4
    assert off[1] < 1e-6
    assert np.log2(off[0] / off[1]) > 5.5
    assert found.probe("p")["u"][2] == pytest.approx(DEFLECTION, rel=1e-7)


@pytest.mark.parametrize(("order", "energy", "deflection"), [(5, 1e-5, 2e-6), (6, 3e-7, 1e-7)])
def test_higher_orders_need_eight_triangles(order, energy, deflection):
    found = ks.solve(roof(2), element="koiter", order=order, large_deflection=False)
    assert abs(found.strain_energy / ENERGY - 1) < energy
    off = abs(found.probe("p")["u"][2] / DEFLECTION - 1)
    assert off < deflection
    assert off * abs(DEFLECTION) < found.error["probes"]["p"]["u"]["half_width"][2]
    assert found.balance < 1e-9


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6])
def test_middles_of_edges_move_as_the_polynomial_does(order):
    mesh = ks.geometry.Cylinder(1.0).mesh(1, 1, u_range=(0, 1), v_range=(0, 1))
    mesh = (
        mesh if mesh.midpoints is not None else replace(mesh, midpoints=mesh.points[mesh.edges].mean(axis=1))
    )
    surface = Surface(mesh, order)
    offsets = 0.01 * np.random.default_rng(0).standard_normal(surface.nodes.shape)
    moved = moved_mesh(mesh, order, offsets)
    assert moved.points == pytest.approx(mesh.points + offsets[: len(mesh.points)], abs=1e-15)
    shape = lagrange(order, np.array([[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]]))
    middles = np.einsum("ek,tkx->tex", shape, offsets[surface.triangle_nodes])
    where = mesh.triangle_edges
    assert moved.midpoints[where] == pytest.approx(mesh.midpoints[where] + middles, abs=1e-13)


def test_the_estimate_holds_the_error():
    found = ks.solve(roof(2), element="koiter", order=4, large_deflection=False)
    half = found.error["probes"]["p"]["u"]["half_width"][2]
    off = abs(found.probe("p")["u"][2] - DEFLECTION)
    assert off < half < 1e-2 * abs(DEFLECTION)  # most of it for the shape of triangles this large


def test_large_deflections_agree_with_cubics():
    cubic, quartic, sixth = (
        ks.solve(roof(n), element="koiter", order=order, large_deflection=True, error="off")
        for n, order in ((4, 3), (4, 4), (2, 6))
    )
    assert sixth.probe("p")["u"] == pytest.approx(quartic.probe("p")["u"], rel=1e-5, abs=1e-12)
    assert quartic.probe("p")["u"] == pytest.approx(cubic.probe("p")["u"], rel=2e-4, abs=1e-12)
