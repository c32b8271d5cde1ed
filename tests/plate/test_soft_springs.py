"""Plates on springs alone, under loads that balance: they drift by rounding, little or told."""

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import UNIT, rectangle


def on_springs(stiffness, element, load="cos(2*pi*x)", **changes):
    """D = 1; without springs w = cos(2 pi x) / (2 pi)^4 and what free edges add, and any rigid motion."""
    data = {
        "mesh": rectangle(8, wobble=0.2),
        "thickness": 1.0,
        "material": ks.Isotropic(**UNIT),
        "supports": [ks.Elastic("plate", stiffness)],
        "loads": [ks.Pressure(load)],
    }
    return ks.solve(ks.Scene(**{**data, **changes}), element=element, error="off", model="plate")


def told(result):
    return any("springs alone keep the plate in place" in warning for warning in result.warnings)


@pytest.mark.parametrize("element", ["argyris", "morley", "hhj"])
def test_a_drift_by_rounding_is_small_or_told(element):
    held = on_springs(1e-3, element)
    size = np.abs(held.fields["displacement"]).max()
    assert not told(held)
    assert not told(on_springs(1e-5, element))
    for stiffness in (1e-6, 1e-8, 3e-9, 1e-10, 1e-12):
        try:
            result = on_springs(stiffness, element)
        except ks.SolveError:  # called singular
            assert stiffness < 1e-8
            continue
        x, w = result.points[:, :2], result.fields["displacement"][:, 2] - held.fields["displacement"][:, 2]
        rigid = np.column_stack([np.ones(len(x)), x - 0.5])
        drift = np.abs(np.linalg.lstsq(rigid, w, rcond=None)[0]).max()
        assert drift < 5e-3 * size or told(result)


def test_loads_that_do_not_balance_and_plates_that_are_held_are_not_told():
    assert not told(on_springs(1e-2, "argyris", load="1"))
    supports = [ks.Elastic("plate", 1e-13), ks.SimplySupported("left")]
    assert not told(on_springs(1.0, "argyris", supports=[*supports, ks.Fixed((1, 0, 0), "z")]))
