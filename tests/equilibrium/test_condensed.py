"""Unknowns inside triangles, eliminated there: the same solution as without."""

import numpy as np
import pytest

from kshell.equilibrium import condensed, free_matrices
from kshell.equilibrium.linear import LinearSolver
from kshell.shell.section import Section
from tests.shell.shapes import Model, rectangle

SECTION = Section.isotropic(2.0, 0.3, 0.1)


def arch(order, hold):
    """A shallow arch; its supports have rows of the basis with none, one and two entries."""
    model = Model(
        rectangle(3, 2, 0, 1, 0, 0.8),
        order,
        SECTION,
        lambda x: np.stack([x[..., 0], x[..., 1], 0.3 * x[..., 0] ** 2], axis=-1),
    )
    model.supports.clamp(model.edges(0, 0.0))
    model.supports.along(model.surface.nodes_of_edges(model.edges(0, 1.0)), [1.0, 0.5, 0.0])
    if hold:
        model.supports.translation(model.surface.nodes_of_triangles([2]), "z")
    return model


@pytest.fixture(autouse=True)
def sparse(monkeypatch):
    monkeypatch.setattr(free_matrices, "DENSE_UP_TO", 0)


@pytest.mark.parametrize("order", [2, 3, 5])
@pytest.mark.parametrize("hold", [False, True])
def test_the_solution_is_that_without(order, hold, monkeypatch):
    """Nothing is inside triangles of order 2, and what is held inside them is left alone."""
    model = arch(order, hold)
    reduction = model.reduction()
    load = np.random.default_rng(order).standard_normal(model.surface.unknowns)
    both = np.random.default_rng(1).standard_normal((reduction.basis.shape[1], 2))
    made = []
    reduce = condensed.Condensation.reduce
    monkeypatch.setattr(
        condensed.Condensation, "reduce", lambda self, *parts: (made.append(1), reduce(self, *parts))
    )
    here = LinearSolver(model.koiter, reduction)
    assert bool(made) == (order > 2 and not hold)
    found, responses = here.solve(load), (here.respond(both), here.respond(both[:, 0]))
    made.clear()
    model.koiter.inner = np.zeros(0, dtype=np.int64)
    there = LinearSolver(model.koiter, reduction)
    expected = there.solve(load)
    assert not made
    for one, other in (
        (found.x, expected.x),
        (found.forces, expected.forces),
        (found.stress, expected.stress),
    ):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-11 * np.abs(other).max())
    for one, other in zip(responses, (there.respond(both), there.respond(both[:, 0])), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-7 * np.abs(other).max())
