"""Curved edges with Argyris: deflections and edge moments at the order of the element, on meshes of order 1 and 2."""

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import EGG_LOAD, disk, egg, ellipse, ellipse_centre, solve

NU = 0.3


def rim(result):
    """Radial and tangential moments at the vertices of the rim of a unit disk."""
    mesh = result.mesh
    at = np.unique(mesh.edges[mesh.boundary_edges])
    x, y = mesh.points[at, :2].T
    xx, yy, xy = result.fields["moment"][at].T
    return xx * x**2 + yy * y**2 + 2 * xy * x * y, xx * y**2 + yy * x**2 - 2 * xy * x * y


# support, deflection at the centre, radial and tangential moment at the rim; q = D = R = 1
DISKS = {
    "supported": (ks.SimplySupported("edge"), (5 + NU) / (1 + NU) / 64, 0.0, 0.0875),
    "clamped": (ks.Clamped("edge"), 1 / 64, -0.125, -0.0375),
}


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(("support", "centre", "radial", "tangential"), DISKS.values(), ids=DISKS.keys())
def test_disks_are_right_to_rounding(support, centre, radial, tangential, order):
    """The deflection is a quartic, and the edge a circle."""
    deflection, moment = [], []
    for rings in (1, 3):
        result = solve(disk(rings, order), [support], [ks.Pressure(1.0)])
        deflection.append(abs(result.at([[0, 0, 0]])["u"][0, 2] / centre - 1))
        found = rim(result)
        moment.append(max(np.abs(found[0] - radial).max(), np.abs(found[1] - tangential).max()))
        assert result.reactions["edge"]["force"][2] == pytest.approx(-np.pi, rel=1e-9)
        assert result.balance < 1e-9
    assert deflection[0] < 1e-8
    assert deflection[1] < 1e-10
    assert moment[0] < 1e-8
    assert moment[1] < 1e-9


@pytest.mark.parametrize("order", [1, 2])
def test_ellipses_are_right_to_rounding(order):
    """Clamped, w = w0 (1 - x^2 / a^2 - y^2 / b^2)^2: a quartic on a known curve."""
    for rings in (2, 3):
        result = solve(ellipse(rings, order), [ks.Clamped("edge")], [ks.Pressure(1.0)])
        assert result.at([[0, 0, 0]])["u"][0, 2] == pytest.approx(ellipse_centre(), rel=1e-10)
        assert result.strain_energy == pytest.approx(np.pi * 1.5 / 6 * ellipse_centre(), rel=1e-10)


@pytest.mark.parametrize("order", [1, 2])
def test_other_curves_converge_fast(order):
    """A clamped egg, which no conic is: the spline through its nodes is what is off."""
    for rings, error in ((3, 3e-5), (6, 1e-8)):
        result = solve(egg(rings, order), [ks.Clamped("edge")], [ks.Pressure(EGG_LOAD)])
        assert result.at([[0, 0, 0]])["u"][0, 2] == pytest.approx(1.0, rel=error)


@pytest.mark.parametrize("kind", [ks.SimplySupported, ks.Clamped])
def test_a_disk_of_nine_edges(kind):
    """Very coarse, and still positive definite and right to a thousandth."""
    angle = 2 * np.pi * np.arange(9) / 9
    points = np.concatenate([np.stack([np.cos(angle), np.sin(angle)], axis=1), [[0, 0]]])
    k = np.arange(9)
    triangles = np.stack([k, (k + 1) % 9, np.full(9, 9)], axis=1)
    mesh = ks.Mesh.from_arrays(points, triangles, {"edge": triangles[:, :2]})
    result = solve(mesh, [kind("edge")], [ks.Pressure(1.0)])
    exact = 1 / 64 if kind is ks.Clamped else (5 + NU) / (1 + NU) / 64
    assert result.at([[0, 0, 0]])["u"][0, 2] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("kind", [ks.SimplySupported, ks.Clamped])
def test_a_rim_that_is_moved_carries_the_disk_along(kind):
    """A prescribed deflection of the rim: lifted as a whole, and for the supported disk tilted."""
    form = "0.3 + 0.2*x - 0.1*y" if kind is ks.SimplySupported else "0.3"
    still = solve(disk(4), [kind("edge")], [ks.Pressure(1.0)])
    moved = solve(disk(4), [kind("edge", value=form)], [ks.Pressure(1.0)])
    x, y = still.mesh.points[:, :2].T
    rigid = 0.3 + (0.2 * x - 0.1 * y if kind is ks.SimplySupported else 0.0)
    difference = moved.fields["displacement"][:, 2] - still.fields["displacement"][:, 2] - rigid
    # the edge is a spline, on which x and y are polynomials up to its own error
    assert np.abs(difference).max() < 1e-6
    assert moved.balance < 1e-8
    assert moved.reactions["edge"]["force"][2] == pytest.approx(-np.pi, rel=1e-4)


def test_edge_moments_with_a_thickness_that_varies():
    """D = exp(r^2), clamped: w''' of the axisymmetric solution by integration of its equation."""
    from scipy.integrate import solve_bvp

    def equations(r, y):  # y = slope phi, moment: D (phi' + nu phi / r) = -M, (r M)' = M_t - r Q
        phi, m = y
        d = np.exp(r**2)
        dphi = -m / d - NU * phi / r
        mt = -d * (phi / r + NU * dphi)
        return np.stack([dphi, (mt - m) / r - (-r / 2) * -1.0])

    r = np.linspace(1e-6, 1, 400)
    exact = solve_bvp(equations, lambda a, b: np.array([a[0], b[0]]), r, np.zeros((2, 400)), tol=1e-9)
    result = solve(disk(8), [ks.Clamped("edge")], [ks.Pressure(1.0)], thickness="exp((x**2 + y**2) / 3)")
    radial, _ = rim(result)
    assert np.allclose(radial, exact.y[1, -1], rtol=5e-5)
