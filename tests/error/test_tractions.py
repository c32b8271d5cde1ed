"""Moments and forces of several deflections at once, by rows and point by point; the estimate solves each dual once."""

from __future__ import annotations

import numpy as np
import pytest

import kshell as ks
from kshell.elements.quadrature import interval_rule
from kshell.error.residual import PlateResidual
from kshell.error.tractions import POINTS, ConstantTractions, VaryingTractions, tractions_of
from kshell.plate.loads import Loads
from kshell.plate.model import PlateModel
from tests.plate.hhj_cases import problem, square
from tests.plate.plates import disk

ORTHOTROPIC = ks.Orthotropic(E1=25.0, E2=1.0, nu12=0.25, G12=0.5)


@pytest.mark.parametrize("mesh", [square(3), disk(2)], ids=["square", "disk"])
def test_both_ways_agree(mesh):
    """Also with the fields that results are read from."""
    of = problem(mesh, [ks.Clamped("edge")], [ks.Pressure(1.0)], material=ORTHOTROPIC)
    d = np.random.default_rng(1).standard_normal((of.layout.count, 2))
    rows, points = ConstantTractions(of, d), VaryingTractions(of, d, [Loads(), Loads()])
    assert isinstance(tractions_of(of, list(d.T), [Loads(), Loads()]), ConstantTractions)
    xi = np.array([[0.2, 0.3], [0.5, 0.1]])
    np.testing.assert_allclose(rows.inside(xi), points.inside(xi), rtol=1e-8, atol=1e-8 * np.abs(d).max())
    for one, other in zip(rows.sides(), points.sides(), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-9 * np.abs(one).max())
    m, q = rows.at(of.every, xi)
    xy = rows.affine.corners[:, None, 0] + xi @ np.swapaxes(rows.affine.jacobian, 1, 2)
    fields = of.fields(d[:, 1].copy())
    np.testing.assert_allclose(
        m[:, 1], fields.moment(of.every, xi, xy), rtol=1e-9, atol=1e-9 * np.abs(m).max()
    )
    np.testing.assert_allclose(
        q[:, 1], fields.shear(of.every, xi, xy), rtol=1e-9, atol=1e-9 * np.abs(q).max()
    )
    s, w = interval_rule(POINTS)
    patch = of.domain.edge_points(mesh.boundary_edges.astype(np.int64), s, w)
    for one, other in zip(rows.along(patch), points.along(patch), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-9 * np.abs(one).max())


def test_jumps_of_a_smooth_deflection_vanish_where_the_stiffness_varies():
    """w = x^3 y belongs to the quintics; its moments with any continuous stiffness are continuous."""
    of = problem(square(3), [ks.Clamped("edge")], [ks.Pressure(1.0)], thickness="1 + x*y")
    layout, (x, y) = of.layout, of.domain.points.T
    d = np.zeros(layout.count)
    at = layout.vertex_dofs(np.arange(layout.vertex_count))
    d[at] = np.stack([x**3 * y, 3 * x**2 * y, x**3, 6 * x * y, 3 * x**2, 0 * x], axis=1)
    edges = of.mesh.edges
    xm, ym = of.domain.points[edges].mean(axis=1).T
    d[layout.edge_dofs(np.arange(len(edges)))] = (
        of.space.edge_normals * np.stack([3 * xm**2 * ym, xm**3], axis=1)
    ).sum(axis=1)
    tractions = tractions_of(of, [d], [Loads()])
    assert isinstance(tractions, VaryingTractions)
    inner = of.mesh.edge_counts == 2
    for jump in PlateResidual(of)._jumps(tractions):
        assert np.abs(jump[inner]).max() < 1e-6 * np.abs(jump[~inner]).max()


def test_duals_are_solved_once_for_all_cases(monkeypatch):
    respond, calls = PlateModel.respond, []

    def counted(self, load):
        calls.append(np.shape(load))
        return respond(self, load)

    monkeypatch.setattr(PlateModel, "respond", counted)
    mesh = square(4)
    scene = ks.Scene(
        mesh,
        thickness=0.05,
        material=ks.Isotropic(E=1e3, nu=0.3),
        supports=[ks.Clamped("edge")],
        loads=[ks.Pressure(1e-4, name="a"), ks.PointForce((0.5, 0.5, 0), (0, 0, 1e-5), name="b")],
        probes={"p": (0.5, 0.5, 0), "q": (0.25, 0.5, 0)},
        cases=[ks.Case("one", ["a"]), ks.Case("two", ["b"])],
    )
    result = ks.solve(scene, model="plate")
    assert len(calls) == 1
    assert calls[0][1] == 2
    assert result.cases["one"].error["budget"]["shear"] > 0.0
    assert "force" in result.cases["two"].error["shear_why_not"]
    assert set(result.cases["two"].error["probes"]) == {"p", "q"}
