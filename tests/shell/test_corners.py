"""Corners that turn into a shell: found in flat parts and curved surfaces, and kept out of the largest stress."""

import warnings

import numpy as np
import pytest

import kshell as ks
from kshell.shell.corners import RE_ENTRANT, re_entrant_corners
from tests.plate.plates import annulus, rectangle
from tests.shell.shapes import joined

STEEL = ks.Isotropic(E=2e11, nu=0.3)


def found(mesh, patches=None):
    return re_entrant_corners(mesh, np.zeros(len(mesh.triangles), int) if patches is None else patches)


def part(mesh, keep, lift=lambda x: x):
    """The triangles of a mesh whose middles are kept, moved into space, with their border as "rim"."""
    chosen = mesh.triangles[keep(mesh.points[mesh.triangles].mean(axis=1))]
    used = np.unique(chosen)
    plain = ks.Mesh.from_arrays(lift(mesh.points[used]), np.searchsorted(used, chosen))
    return ks.Mesh.from_arrays(plain.points, plain.triangles, {"rim": plain.edges[plain.boundary_edges]})


def l_shape(n, lift=lambda x: x):
    return part(rectangle(n), lambda x: (x[:, 0] < 0.5) | (x[:, 1] < 0.5), lift)


TURN = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
BENT = {
    "flat": lambda x: x,
    "turned": lambda x: 7.0 * x @ TURN.T,
    "cylinder": lambda x: np.stack([2 * np.sin(x[:, 0] / 2), x[:, 1], 2 * np.cos(x[:, 0] / 2)], axis=1),
    "saddle": lambda x: np.column_stack([x[:, :2], 0.3 * (x[:, 0] ** 2 - x[:, 1] ** 2)]),
}


@pytest.mark.parametrize("shape", BENT)
@pytest.mark.parametrize("n", [4, 8])
def test_the_corner_of_an_l_and_no_other(shape, n):
    mesh = l_shape(n, BENT[shape])
    (vertex,) = found(mesh)
    assert mesh.points[vertex] == pytest.approx(BENT[shape](np.array([[0.5, 0.5, 0.0]]))[0])


def test_openings_have_four_and_round_holes_none():
    opening = part(rectangle(8), lambda x: np.abs(x[:, :2] - 0.5).max(axis=1) > 0.25)
    assert len(found(opening)) == 4
    for around in (8, 16):
        assert found(annulus(2, around)) == {}
    assert found(rectangle(4)) == {}


def test_curved_edges_tell_by_their_tangents():
    assert found(ks.Scene.load("meshes/disk.toml", ['mesh="disk_order2.msh"']).read_mesh()) == {}


def test_the_end_of_a_slit_is_one():
    mesh = rectangle(4)
    along = np.flatnonzero(np.abs(mesh.points[mesh.edges][:, :, 1] - 0.5).max(axis=1) < 1e-9)
    crack = mesh.edges[along][(mesh.points[mesh.edges[along]][:, :, 0] < 0.51).all(axis=1)]
    whole = ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"crack": crack})
    slit = ks.slit(whole, "crack")
    assert [slit.points[v].tolist() for v in found(slit)] == [[0.5, 0.5, 0.0]]


def test_a_wall_on_the_corner_holds_it():
    """Where another sheet meets the corner it is none of the border of one sheet."""
    base = l_shape(4)
    wall = rectangle(4)
    up = np.stack(
        [wall.points[:, 0] * 0.0 + 0.5, 0.5 + wall.points[:, 0] * 0.5, wall.points[:, 1] * 0.5], axis=1
    )
    mesh = joined((base.points, base.triangles), (up, wall.triangles))
    flat = (np.abs(mesh.points[mesh.triangles][:, :, 2]).max(axis=1) < 1e-9).astype(int)
    corner = int(np.argmin(np.linalg.norm(mesh.points - [0.5, 0.5, 0.0], axis=1)))
    assert corner not in found(mesh, flat)


@pytest.mark.parametrize("shape", ["flat", "turned", "cylinder"])
def test_the_largest_stress_is_taken_elsewhere(shape):
    """At the corner it grows on with every mesh; that of the rest does not."""
    far, peaks = [], []
    for n in (8, 16):
        mesh = l_shape(n, BENT[shape])
        scene = ks.Scene(
            mesh=mesh,
            thickness=0.02 * mesh.size,
            material=STEEL,
            supports=[ks.Clamped("rim") if shape == "cylinder" else ks.SimplySupported("rim")],
            loads=[ks.Pressure(1e4)],
        )
        with pytest.warns(ks.KshellWarning, match="grow without bound at a re-entrant corner"):
            result = ks.solve(scene, model="shell", large_deflection=False, error="off")
        extreme = result.extremes["von_mises"]
        assert extreme["peak"]["why"].startswith(f"a {RE_ENTRANT} at ")
        far.append(extreme["value"])
        peaks.append(extreme["peak"]["value"])
    assert peaks[1] > 1.1 * peaks[0]
    assert max(far) < min(peaks)


def test_silent_where_the_largest_stress_is_not_there():
    opening = part(rectangle(8), lambda x: np.abs(x[:, :2] - 0.5).max(axis=1) > 0.13)
    left = opening.edges[(np.abs(opening.points[opening.edges][:, :, 0]) < 1e-9).all(axis=1)]
    mesh = ks.Mesh.from_arrays(opening.points, opening.triangles, {"left": left})
    scene = ks.Scene(
        mesh=mesh, thickness=0.02, material=STEEL, supports=[ks.Clamped("left")], loads=[ks.Pressure(1e2)]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error", ks.KshellWarning)
        result = ks.solve(scene, model="shell", large_deflection=False, error="off")
    assert result.extremes["von_mises"]["peak"] is None
    assert result.extremes["von_mises"]["at"][0] == pytest.approx(0.0)
