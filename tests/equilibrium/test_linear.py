"""Linear solutions begin where nothing is strained, which needs no strains, unless something is prescribed."""

import numpy as np
import pytest

from kshell.equilibrium.linear import LinearSolver
from tests.equilibrium.test_free_matrices import held, springs_on


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("moved", [False, True])
@pytest.mark.parametrize("springs", [False, True])
def test_what_is_not_evaluated_at_rest_is_zero(springs, moved, loaded):
    """Against the same with initial strains that are zero, which has all strains evaluated: number by number."""
    model, reduction = held(2, 4)
    linear = LinearSolver(model.koiter, reduction, springs_on(model) if springs else None)
    rng = np.random.default_rng(3)
    load = loaded * rng.normal(size=model.koiter.unknowns)
    given = moved * 1e-3 * rng.normal(size=model.koiter.unknowns)
    found = linear.solve(load, given)
    none = np.zeros((len(model.mesh.triangles), model.koiter.strains))
    expected = linear.solve(load, given, none)
    assert np.any(found.x) == (loaded or moved)
    for mine, theirs in zip(found, expected, strict=True):
        np.testing.assert_array_equal(mine, theirs)
        assert np.array_equal(np.signbit(mine), np.signbit(theirs))
