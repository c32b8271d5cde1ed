"""Concentrated forces at corners, together with the forces along the edges, make up the reaction."""

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.mesh import Mesh
from kshell.verify.cases import Run, find
from kshell.verify.cases.quantities import EdgeForce
from tests.plate.plates import disk, rectangle, solve


def force_along_x0(result, cells):
    """Integral of Kirchhoff's force of the support along x = 0, 0 <= y <= 1."""
    at, weight = np.polynomial.legendre.leggauss(6)
    y = ((np.arange(cells)[:, None] + (at + 1) / 2) / cells).ravel()
    force = [-EdgeForce((0.0, float(place)), "x", 1e-3).of(result) for place in y]
    return np.dot(force, np.tile(weight / 2 / cells, cells))


@pytest.mark.parametrize(
    ("id", "shares"),
    [("ssss.uniform.ba1", (0.5, 0.5)), ("levy.SFSF.ba1", (1, 1)), ("levy.SSSF.ba1", (0.5, 1))],
)
def test_edge_and_corner_forces_make_up_the_reaction(id, shares):
    """A corner between two supported sides counts half for each, one beside a free side in full."""
    result = find(id).solve(Run("argyris", 12))
    reaction = result.reactions["x0"]
    corners = {round(float(c["at"][1])): c["force"][2] for c in reaction["corners"]}
    assert sorted(corners) == [0, 1]
    concentrated = shares[0] * corners[0] + shares[1] * corners[1]
    assert force_along_x0(result, 12) + concentrated == pytest.approx(reaction["force"][2], rel=2e-3)


def test_a_clamped_corner_has_none():
    result = find("clamped.uniform.ba1").solve(Run("argyris", 4))
    forces = [c["force"][2] for group in result.reactions.values() for c in group["corners"]]
    assert np.abs(forces).max() < 1e-12


HELD = [ks.SimplySupported("edge")]
# 2 (1 - nu) times the sum over odd m, n of 16 / (pi^4 (m^2 + n^2)^2): Navier's series, summed over n
M = np.arange(1, 20001, 2)
OVER_N = np.pi * np.tanh(np.pi * M / 2) / (8.0 * M**3)
OVER_N -= (np.pi / np.cosh(np.pi / 2 * np.minimum(M, 200)) / (4.0 * M)) ** 2
SQUARE = 1.4 * 16 / np.pi**4 * OVER_N.sum()


def corner_forces(result, group="edge"):
    """Forces along z by place, rounded to two digits."""
    return {tuple(np.round(c["at"][:2], 2)): c["force"][2] for c in result.reactions[group]["corners"]}


@pytest.mark.parametrize(("n", "error"), [(4, 1e-6), (8, 1e-7), (16, 1e-8)])
def test_the_square_has_its_corner_forces(n, error):
    """The second derivatives at the corner itself are off by 7e-4 on the finest of these meshes."""
    found = corner_forces(solve(rectangle(n), HELD, [ks.Pressure(1.0)]))
    assert len(found) == 4
    assert np.allclose(list(found.values()), SQUARE, rtol=error, atol=0)


def test_they_turn_and_scale_with_the_plate():
    mesh = rectangle(8, 6)
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    points = 1e3 + 2.0 * mesh.points[:, :2] @ turn.T
    groups = {"edge": mesh.edges[mesh.groups["edge"].members]}
    moved = Mesh.from_arrays(points, mesh.triangles, groups)
    here, there = (solve(m, HELD, [ks.Pressure(1.0)]).reactions["edge"]["corners"] for m in (mesh, moved))
    at = {tuple(np.round(1e3 + 2.0 * turn @ c["at"][:2], 6)): c["force"][2] for c in here}
    for c in there:
        assert c["force"][2] == pytest.approx(4 * at[tuple(np.round(c["at"][:2], 6))], rel=1e-6)


def test_a_pressure_that_varies():
    """w = sin(pi x) sin(pi y) exactly."""
    found = corner_forces(solve(rectangle(8), HELD, [ks.Pressure("4*pi**4*sin(pi*x)*sin(pi*y)")]))
    assert list(found.values()) == pytest.approx([1.4 * np.pi**2] * 4, rel=1e-6)


def test_a_twisted_plate_has_them_exactly():
    """w = x y, held at three corners and by its straight edges on two sides."""
    held = [ks.SimplySupported(["left", "bottom"])]
    result = solve(rectangle(3), held, [ks.PointForce((1, 1, 0), (0, 0, 1.4))])
    assert result.at((0.5, 0.5, 0))["u"][0, 2] == pytest.approx(0.25, rel=1e-9)
    assert corner_forces(result, "left")[0, 0] == pytest.approx(1.4, rel=1e-8)


# what else acts, the loads, the section, and the corners where second derivatives converge
EVERYWHERE = ((0, 0), (0, 1), (1, 0), (1, 1))
CASES = {
    "part of the pressure": ([], [ks.Pressure(1.0, "lower")], {}, EVERYWHERE),
    "a line inside": ([ks.SimplySupported("middle")], [ks.Pressure(1.0)], {}, EVERYWHERE),
    "a post and a force": (
        [ks.Fixed((0.5, 0.5, 0), "z")],
        [ks.PointForce((0.75, 0.75, 0), (0, 0, 1))],
        {},
        EVERYWHERE,
    ),
    "a foundation": ([ks.Elastic("lower", 50.0)], [ks.Pressure(1.0)], {}, EVERYWHERE),
    "two thicknesses": ([], [ks.Pressure(1.0)], {"thickness": {"lower": 1.0, "upper": 1.5}}, EVERYWHERE),
    "one side clamped": ([ks.Clamped("left")], [ks.Pressure(1.0)], {}, EVERYWHERE),
    "moments on a side": ([], [ks.EdgeMoment("left", 0.1), ks.Pressure(1.0)], {}, ((1, 0), (1, 1))),
    "a hot half": (
        [],
        [ks.InitialCurvature((0.1, 0.1, 0.0), "lower"), ks.Pressure(1.0)],
        {},
        ((0, 1), (1, 1)),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_else_acts_is_kept_out_of_the_average(name):
    """Against second derivatives at the corners of a mesh four times as fine, good to a few parts in a thousand."""
    more, loads, section, where = CASES[name]
    coarse, fine = (solve(rectangle(n), [*HELD, *more], loads, **section) for n in (8, 32))
    plain = _plain_forces(fine)
    found = corner_forces(coarse)
    size = max(abs(plain[place]) for place in where)
    for place in where:
        assert found[place] == pytest.approx(plain[place], abs=0.01 * size)


def _vertex_at(mesh, place):
    return int(np.linalg.norm(mesh.points - np.asarray(place), axis=1).argmin())


def _plain_forces(result):
    """2 (1 - nu) D w_xy at the corners, signed, from the moments at the vertices."""
    out = {}
    for place in corner_forces(result):
        vertex = _vertex_at(result.mesh, (*place, 0.0))
        out[place] = -2 * result.fields["moment"][vertex, 2] * (-1) ** sum(place)
    return out


@pytest.mark.parametrize(
    ("mesh", "section"),
    [
        (rectangle(8, skew=0.5), {}),
        (rectangle(8), {"material": ks.Orthotropic(E1=20.0, E2=10.0, nu12=0.3, G12=5.0)}),
        (rectangle(8), {"thickness": "1 + x"}),
    ],
    ids=["oblique", "orthotropic", "varying thickness"],
)
def test_elsewhere_they_are_the_jump_of_the_twisting_moment(mesh, section):
    result = solve(mesh, HELD, [ks.Pressure(1.0)], **section)
    for c in result.reactions["edge"]["corners"]:
        here = (mesh.edges[mesh.boundary_edges] == _vertex_at(mesh, c["at"])).any(axis=1)
        twist = 0.0
        for a, b in mesh.edges[mesh.boundary_edges[here]]:
            t = mesh.points[b, :2] - mesh.points[a, :2]
            t *= (1 if a == _vertex_at(mesh, c["at"]) else -1) / np.linalg.norm(t)
            triangle = (mesh.triangles == a).any(axis=1) & (mesh.triangles == b).any(axis=1)
            inside = mesh.points[mesh.triangles[triangle][0]].mean(axis=0)[:2] - c["at"][:2]
            n = np.array([t[1], -t[0]])
            n *= -np.sign(n @ inside)  # out of the plate
            at = c["at"] + 1e-9 * np.append(inside, 0.0)
            xx, yy, xy = result.at(at)["M"][0]
            twist += n @ np.array([[xx, xy], [xy, yy]]) @ t
        assert c["force"][2] == pytest.approx(twist, rel=1e-6)


def test_a_smooth_edge_has_none():
    assert "corners" not in solve(disk(3), HELD, [ks.Pressure(1.0)]).reactions["edge"]
