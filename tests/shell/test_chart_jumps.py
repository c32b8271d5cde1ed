"""Derivatives of the displacement that jump across lines inside a chart."""

import pytest

import kshell as ks
from tests.plate.test_jumps import halves


def strip(load):
    """A cantilever strip of two thicknesses, nu = 0: E t = 2400 and 1200, D = 8 and 1."""
    return ks.Scene(
        mesh=halves(8, 2, 2.0, 0.5, 0.2),
        chart=ks.geometry.Plane(),
        thickness={"A": 0.2, "B": 0.1},
        material=ks.Isotropic(E=12e3, nu=0.0),
        supports=[ks.Clamped("left")],
        loads=[ks.LineForce("right", load)],
        probes={"tip": (2, 0.25, 0), "A": (1 - 1e-6, 0.25, 0), "B": (1 + 1e-6, 0.25, 0)},
        solve={"large_deflection": False},
    )


def test_auto_takes_koiter_elements_at_a_step_and_says_why():
    for load, key, tip, expected in (
        ((0, 0, 1e-3), "M", 2, 1e-3 * (1 / 3 + 7 / 24)),
        ((1.0, 0, 0), "N", 0, 1 / 2400 + 1 / 1200),
    ):
        result = ks.solve(strip(load))
        assert result.model["element"] == "koiter"
        assert any("jump across lines inside the shell" in words for words in result.model["reasons"])
        assert result.probe("tip")["u"][tip] == pytest.approx(expected, rel=1e-8)
        size = -1e-3 if key == "M" else 1.0
        for side in "AB":
            assert result.probe(side)[key][0] == pytest.approx(size, rel=2e-6)


def test_argyris_elements_asked_for_are_warned_of():
    with pytest.warns(ks.KshellWarning, match="smooth out"):
        ks.solve(strip((0, 0, 1e-3)), element="argyris")
