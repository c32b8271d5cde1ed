"""Peirce's cantilever test: how far a strip hangs tells its bending length c = (B / w)^(1/3)."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp

import kshell as ks
from kshell.verify.cases import large_scenes


def heavy_elastica(length):
    """Tip (x, z) over the length, for B = w = 1: phi'' = (L - s) cos phi, phi(0) = 0, phi'(L) = 0."""
    s = np.linspace(0, length, 200)

    def slope(s, y):
        return np.stack([y[1], -(length - s) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(a, b):
        return np.array([a[0], b[1], a[2], a[3]])

    start = np.stack([np.minimum(s, 1.4), 0 * s, s, 0 * s])
    found = solve_bvp(slope, ends, s, start, tol=1e-8, max_nodes=20000)
    assert found.success
    return found.y[2, -1] / length, abs(found.y[3, -1]) / length


@pytest.mark.parametrize(
    ("ratio", "angle"), [(1.0, 7.10), (2.0, 41.49), (3.0, 66.96), (5.0, 81.58), (8.0, 86.18)]
)
def test_overhang(ratio, angle):
    length, width, thickness, young = 1.0, 0.1, 1e-3, 1e9
    weight = young * thickness**3 / 12 * ratio**3 / length**3  # per area
    scene = ks.Scene(
        mesh=large_scenes.rectangle(length, width, 8 if ratio < 8 else 24, 1),
        thickness=thickness,
        material=ks.Isotropic(E=young, nu=0.0, density=weight / thickness / 10.0),
        supports=[ks.Clamped("x0")],
        loads=[ks.Gravity((0, 0, -10.0))],
        probes={"tip": (length, 0, 0)},
    )
    u = ks.solve(scene, large_deflection=True, order=2).probe("tip")["u"]
    x, z = heavy_elastica(ratio)
    assert 1 + u[0] == pytest.approx(x, abs=1e-3)
    assert -u[2] == pytest.approx(z, abs=1e-3)
    assert np.degrees(np.arctan2(z, x)) == pytest.approx(angle, abs=0.01)
