"""Rigid links between curves or surfaces of a shell and a point: statics, beams, and what they refuse."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import rectangle

E, T = 1e4, 0.1
BAR = ks.Isotropic(E=E, nu=0.0, density=1.0)
POINT = (1.0, 0.5, 0.3)


def scene_with(supports, loads):
    return ks.Scene(
        mesh=rectangle(4),
        thickness=T,
        material=BAR,
        supports=supports,
        loads=loads,
        probes={"end": (1.0, 0.5, 0.0)},
    )


def solved(supports, loads, **options):
    return ks.solve(scene_with(supports, loads), **{"large_deflection": False, **options})


def test_a_force_off_the_axis_of_a_bar():
    """A bar (nu = 0) clamped on one side: force along it at a height h makes N = F and M = F h."""
    force = 2.0
    link = ks.RigidLink("right", to=POINT, name="flange")
    result = solved([ks.Clamped("left"), link], [ks.PointForce("flange", (force, 0, 0))])
    u = result.probe("end")["u"]
    bending = force * POINT[2] / (2 * E * T**3 / 12)  # M L^2 / (2 E I), the top in tension: it bends down
    np.testing.assert_allclose(u, [force / (E * T), 0.0, -bending], rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(result.reactions["left"]["force"], [-force, 0, 0], atol=1e-9)
    np.testing.assert_allclose(
        result.reactions["left"]["moment"], [0, -force * POINT[2], force * 0.5], atol=1e-9
    )
    assert result.balance < 1e-9
    assert result.strain_energy == pytest.approx(result.external_work, rel=1e-9)


def test_a_moment_at_the_point_turns_the_edge():
    moment = 0.5
    result = solved(
        [ks.Clamped("left"), ks.RigidLink("right", to=POINT, name="hub")],
        [ks.PointMoment("hub", (0, moment, 0))],
    )
    assert result.probe("end")["u"][2] == pytest.approx(-moment / (2 * E * T**3 / 12), rel=1e-8)


def test_a_held_point_holds_all_six():
    """Fixed at both ends under a traction, as a beam: the middle of w is p L^4 / (384 E I)."""
    held = [
        ks.RigidLink(side, to=(x, 0.5, 0.4), name=f"at {side}") for side, x in (("left", 0.0), ("right", 1.0))
    ]
    held += [ks.Clamped("at left"), ks.Clamped("at right")]
    scene = ks.Scene(
        mesh=rectangle(4),
        thickness=T,
        material=BAR,
        supports=held,
        loads=[ks.Pressure(1.0)],
        probes={"middle": (0.5, 0.5, 0.0)},
    )
    result = ks.solve(scene, large_deflection=False, order=3)
    assert result.probe("middle")["u"][2] == pytest.approx(1 / (384 * E * T**3 / 12), rel=1e-6)
    forces = [result.reactions[f"at {side}"]["force"] for side in ("left", "right")]
    np.testing.assert_allclose(forces, [[0, 0, -0.5]] * 2, atol=1e-8)
    assert result.balance < 1e-9


def test_a_point_is_moved():
    """Lifted by 0.1 without turning: w = 3 s^2 - 2 s^3 of it."""
    result = solved(
        [ks.Clamped("left"), ks.RigidLink("right", to=POINT, name="p"), ks.Clamped("p", value=(0, 0, 0.1))],
        [],
    )
    assert result.probe("end")["u"][2] == pytest.approx(0.1, rel=1e-9)
    expected = 12 * E * T**3 / 12 * 0.1
    assert result.reactions["p"]["force"][2] == pytest.approx(expected, rel=1e-6)


def test_a_surface_moves_as_one():
    link = ks.RigidLink("all", to=(0, 0, 0), name="body")
    mesh = rectangle(2)
    mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"all": mesh.triangles})
    scene = ks.Scene(
        mesh=mesh, thickness=T, material=BAR, supports=[link, ks.Clamped("body", value=(1, 2, 3))]
    )
    result = ks.solve(scene, large_deflection=False)
    np.testing.assert_allclose(
        result.fields["displacement"], np.tile([1, 2, 3], (len(mesh.points), 1)), atol=1e-12
    )


@pytest.mark.parametrize(
    ("extra", "loads", "options", "words"),
    [
        ([ks.Clamped("top")], [], {}, "holds nodes of it"),
        ([ks.SimplySupported("link")], [], {}, "takes point_force, point_moment, clamped and fix"),
        ([], [ks.LineForce("link", (0, 0, 1))], {}, "takes point_force"),
        ([ks.RigidLink("top", to=POINT, name="link")], [], {}, "is taken"),
        ([ks.RigidLink("top", to=POINT, name="left")], [], {}, "is taken"),
        ([], [ks.PointForce("link", (0, 0, 1))], {"large_deflection": True}, "small deflections"),
        ([], [ks.PointForce("link", (0, 0, 1))], {"model": "plate"}, "is for shells"),
    ],
)
def test_what_links_refuse(extra, loads, options, words):
    link = ks.RigidLink("right", to=POINT, name="link")
    with pytest.raises(ks.InputError, match=words):
        solved([ks.Clamped("left"), link, *extra], loads, **options)


@pytest.mark.parametrize(("force", "small"), [(1e-3, True), (1.0, False)])
def test_by_itself_the_answer_is_linear_and_says_so_where_deflections_are_large(force, small):
    link = ks.RigidLink("right", to=POINT, name="link")
    supports, loads = [ks.Clamped("left"), link], [ks.PointForce("link", (0, 0, force))]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        result = solved(supports, loads, large_deflection="auto")
    assert not result.model["large_deflection"]
    assert any("small turns only" in str(warning.message) for warning in told) != small
    linear = solved(supports, loads, large_deflection=False)
    assert result.fields["displacement"] == pytest.approx(linear.fields["displacement"], rel=1e-9, abs=1e-15)


def test_with_a_tolerance_links_are_refined_as_they_are():
    link = ks.RigidLink("right", to=POINT, name="link")
    supports, loads = [ks.Clamped("left"), link], [ks.PointForce("link", (0, 0, 1.0))]
    assert solved(supports, loads, large_deflection="auto", tolerance=0.05).error["estimate"] <= 0.05


@pytest.mark.parametrize("analysis", [ks.buckling, ks.trace, lambda s: ks.modes(s, count=1, prestress=True)])
def test_other_analyses_refuse_links(analysis):
    link = ks.RigidLink("right", to=POINT, name="link")
    scene = scene_with([ks.Clamped("left"), link], [ks.PointForce("link", (-1.0, 0, 0))])
    with pytest.raises(ks.InputError, match="rigid links are for small deflections"):
        analysis(scene)
