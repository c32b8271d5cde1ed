"""What only soft springs hold drifts by the rounding of its loads: little, or told."""

import numpy as np
import pytest

import kshell as ks


def sphere(stiffness, **changes):
    """Closed, of radius 1, under internal pressure that stretches it by about 0.35 percent."""
    data = {
        "mesh": ks.geometry.Sphere(1.0).mesh(12, 8, order=2),
        "thickness": 0.1,
        "material": ks.Isotropic(E=2e11, nu=0.3),
        "supports": [ks.Elastic("surface", stiffness * 2e11, "xyz")],
        "loads": [ks.Pressure(2e8)],
    }
    return ks.solve(ks.Scene(**{**data, **changes}), order=2, large_deflection=False, error="off")


def drift(result):
    """Size of the rigid part of the displacement, against the largest."""
    x, u = np.asarray(result.points), np.asarray(result.fields["displacement"])
    rigid = np.zeros((len(x), 3, 6))
    rigid[:, :, :3] = np.eye(3)
    for axis in range(3):
        rigid[:, :, 3 + axis] = np.cross(np.eye(3)[axis], x)
    return np.abs(np.linalg.lstsq(rigid.reshape(-1, 6), u.ravel(), rcond=None)[0]).max() / np.abs(u).max()


@pytest.mark.parametrize("stiffness", [1e-4, 1e-7, 1e-10, 1e-12, 1e-13, 1e-14])
def test_a_drift_by_rounding_is_small_or_told(stiffness):
    result = sphere(stiffness)
    told = any("springs alone" in warning for warning in result.warnings)
    assert drift(result) < 3e-4 or told
    assert told == (stiffness < 1e-11)


def test_what_is_held_otherwise_does_not_drift():
    supports = [ks.Elastic("surface", 1e-4, "xyz"), ks.Fixed((1, 0, 0), "xyz"), ks.Fixed((-1, 0, 0), "yz")]
    result = sphere(1.0, supports=[*supports, ks.Fixed((0, 1, 0), "z")])
    assert not any("springs alone" in warning for warning in result.warnings)


def test_real_loads_on_soft_springs_are_answered_without_a_word():
    result = sphere(1e-6, loads=[ks.Traction((0.0, 0.0, 1.0))])
    assert not any("springs alone" in warning for warning in result.warnings)
    assert result.fields["displacement"][:, 2].mean() == pytest.approx(1.0 / (1e-6 * 2e11), rel=1e-2)
