"""Sizes that meet a tolerance with the fewest triangles."""

import numpy as np
import pytest

from kshell.error.sizes import MOST_GROWTH, wanted_ratios


@pytest.mark.parametrize("rate", [2.0, 4.0, 6.0])
def test_the_sum_of_marks_falls_as_wanted_and_all_become_equal(rate):
    marks = np.random.default_rng(1).uniform(1.0, 1.5, 50)
    ratio = wanted_ratios(marks, 0.4, rate)
    assert (ratio < 1.0).all()
    each = marks * ratio ** (rate + 2.0)
    np.testing.assert_allclose(each, each[0])
    assert (each * ratio**-2.0).sum() == pytest.approx(0.4 * marks.sum())


def test_growth_is_limited_and_the_worst_come_first():
    marks = np.random.default_rng(2).lognormal(0.0, 3.0, 200)
    ratio = wanted_ratios(marks, 1e-6, 4.0)
    assert (ratio**-2.0).mean() == pytest.approx(MOST_GROWTH, rel=1e-6)
    order = np.argsort(marks)
    assert (np.diff(ratio[order]) <= 0.0).all()
    assert ratio.max() <= 1.0


def test_scale_of_marks_does_not_matter_and_nothing_is_refined_for_nothing():
    marks = np.array([1.0, 2.0, 8.0])
    np.testing.assert_allclose(wanted_ratios(marks, 0.1, 4.0), wanted_ratios(1e9 * marks, 0.1, 4.0))
    np.testing.assert_array_equal(wanted_ratios(0.0 * marks, 0.1, 4.0), 1.0)
    assert (wanted_ratios(marks, 0.0, 4.0) ** -2.0).mean() == pytest.approx(MOST_GROWTH, rel=1e-6)
