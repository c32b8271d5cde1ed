"""Growing loads stay on their branch, and end on a stable one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipk

import kshell as ks
from kshell.verify.cases.large_scenes import rectangle

T = 0.005
MATERIAL = ks.Isotropic(12 / T**3, 0.0)  # EI = 1 per width


def half_strip(rise=0.0):
    """Half of a strip of length 1 between hinges, x = 0 its middle, bent by a half wave of a rise."""
    mesh = rectangle(0.5, 0.1, 8, 1)
    points = mesh.points.copy()
    points[:, 2] = rise * np.cos(np.pi * points[:, 0])
    return replace(mesh, points=points)


def solved(mesh, end, loads):
    supports = [ks.Symmetry("x0"), end, ks.Fixed("y0", "y")]
    scene = ks.Scene(
        mesh=mesh, thickness=T, material=MATERIAL, supports=supports, loads=loads,
        probes={"c": (0, 0.05, 0)}, solve={"large_deflection": True},
    )  # fmt: skip
    return ks.solve(scene)


def elastica(force):
    """Deflection in the middle of an inextensible strip, EI = L = 1, hinged: 2 k / sqrt(P), 2 K(k) = sqrt(P)."""
    m = brentq(lambda m: 2 * ellipk(m) - np.sqrt(force), 1e-9, 0.99)
    return 2 * np.sqrt(m) / np.sqrt(force)


def test_a_strip_with_an_imperfection_does_not_hop_to_the_other_side():
    result = solved(half_strip(1e-4), ks.Fixed("x1", "z"), [ks.LineForce("x1", (-1.0101 * np.pi**2, 0, 0))])
    assert result.probe("c")["u"][2] == pytest.approx(0.09379, rel=2e-3)
    assert result.path[-1]["stable"]
    assert not result.critical
    assert not result.warnings


def test_ends_pushed_together_under_pressure():
    """By 2 %: the amplitude of the elastica."""
    result = solved(half_strip(), ks.Fixed("x1", "xyz", value=(-0.01, 0, 0)), [ks.Pressure(1.0)])
    assert result.probe("c")["u"][2] == pytest.approx(0.0895, rel=2e-3)
    assert result.path[-1]["stable"]
    assert not result.critical


def test_an_unstable_end_is_left_for_a_stable_state_with_a_word():
    """A perfect strip under 1.5 times its buckling load: the elastica has 0.3943 in the middle."""
    result = solved(half_strip(), ks.Fixed("x1", "z"), [ks.LineForce("x1", (-1.5 * np.pi**2, 0, 0))])
    assert result.path[-1]["stable"]
    assert abs(result.probe("c")["u"][2]) == pytest.approx(elastica(1.5 * np.pi**2), rel=2e-3)
    assert any("the mirror image" in words for words in result.warnings)
