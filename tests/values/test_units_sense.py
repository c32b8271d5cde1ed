"""Names of units that do not fit each other."""

import pytest

import kshell as ks
from kshell.values.units_sense import doubts
from tests.plate.plates import UNIT, rectangle

pytest.importorskip("pint")


@pytest.mark.parametrize(
    "units", ["", "N, mm", "N, m, kg, s", "N, mm, t, s", "kN, m, t, s", "lbf, ft, slug, s", "zork, blorp"]
)
def test_fit(units):
    assert doubts(units) == ()


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ("mm, N", '"mm" stands for the unit of force'),
        ("N, kg", '"kg" stands for the unit of length'),
        ("N, mm, kg, s", "kg mm/s^2 is 0.001 N"),
    ],
)
def test_do_not_fit(units, words):
    assert any(words in doubt for doubt in doubts(units))


def test_a_result_warns():
    scene = ks.Scene(
        mesh=rectangle(1),
        units="N, mm, kg, s",
        thickness=1.0,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("left")],
        loads=[ks.Pressure(1.0)],
    )
    assert any("0.001 N" in words for words in ks.solve(scene, large_deflection=False).warnings)
