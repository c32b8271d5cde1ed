"""The order that `auto` takes: refining a mesh never makes the answer worse."""

import numpy as np
import pytest

import kshell as ks
from kshell.analysis.model_choice import true_shape_order
from kshell.verify.cases import beams
from kshell.verify.cases.case import TRUE_SURFACE


def test_order_never_falls_while_memory_lasts():
    orders = [true_shape_order(n, 16e9)[0] for n in (10, 1000, 3999, 4001, 20_000, 60_000)]
    assert orders == [3] * 6


def test_quadratics_where_cubics_do_not_fit():
    order, why = true_shape_order(100_000, 4e9)
    assert order == 2
    assert "GB" in why
    assert true_shape_order(10_000, None)[0] == 3


def cone(n, m):
    """A frustum in torsion: end radii 1 and 0.5, held below, turned by unit moment per length above."""
    phi, s = np.linspace(0, 2 * np.pi, n, endpoint=False), np.linspace(0, 1, m + 1)
    around, along = np.meshgrid(phi, s)

    def at(around, along):
        r = 1 - 0.5 * along
        return np.stack([r * np.cos(around), r * np.sin(around), along], axis=-1)

    a = (np.arange(m)[:, None] * n + np.arange(n)).ravel()
    b = (np.arange(m)[:, None] * n + (np.arange(n) + 1) % n).ravel()
    triangles = np.concatenate([np.stack([a, b, b + n], 1), np.stack([a, b + n, a + n], 1)])
    points = at(around, along).reshape(-1, 3)
    flat = ks.Mesh.from_arrays(points, triangles)
    middle = points[flat.edges].mean(axis=1)
    middle = at(np.arctan2(middle[:, 1], middle[:, 0]), middle[:, 2])
    rim = flat.edges[flat.boundary_edges]
    groups = {
        "low": rim[points[rim[:, 0], 2] < 0.5],
        "high": rim[points[rim[:, 0], 2] > 0.5],
    }
    return ks.Mesh.from_arrays(points, triangles, groups, middle)


@pytest.mark.full
def test_cone_in_torsion_gets_no_worse_across_the_old_threshold():
    """Shear N_12 = T / (2 pi r^2) of a cone turned at its top, by statics; 2,048, then 4,608 triangles."""
    errors = []
    for n, m in ((64, 16), (96, 24)):
        scene = ks.Scene(
            mesh=cone(n, m),
            thickness=0.01,
            material=ks.Isotropic(E=1e9, nu=0.3),
            supports=[ks.Clamped("low")],
            loads=[ks.LineForce("high", ["-y", "x", "0"])],
        )
        result = ks.solve(scene, large_deflection=False)
        assert result.model["order"] == 3
        torque = 2 * np.pi * 0.5 * 0.5 * 0.5  # circumference, force per length, arm
        shear = result.at([[0.75, 0.0, 0.5]])["N"][0, 2]
        errors.append(abs(abs(shear) / (torque / (2 * np.pi * 0.75**2)) - 1))
    assert max(errors) < 1e-4  # bending leaves 5e-5; quadratics on the finer mesh 7e-4


def test_charts_without_second_derivatives_are_koiter_shells():
    """Which the Argyris element looks at: the Raasch hook, whose curvature jumps."""
    scene = next(beams.raasch()).build(6, TRUE_SURFACE)
    result = ks.solve(scene, element="auto", error="off")
    assert result.model["element"] == "koiter"
    assert any("derivatives up to order 1 only" in words for words in result.model["reasons"])
    with pytest.raises(ks.InputError, match="order 2"):
        ks.solve(scene, element="argyris", error="off")
