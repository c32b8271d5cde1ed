"""Paths of scenes: work, imperfections, branches, controlled displacements."""

import dataclasses

import numpy as np
import pytest

import kshell as ks
from kshell.verify.cases import large_scenes


def test_energy_is_the_work_of_loads_reactions_and_motions():
    """Integrated along the path; the more steps, the closer."""
    moved = [ks.Clamped("x0"), ks.Fixed("x1", "z", value=(0, 0, 4.0))]
    sprung = [ks.Clamped("x0"), ks.Elastic("x1", 1.0, "z")]
    force = ks.LineForce("x1", (0, 0, 4.0))
    for scene, steps, close in (
        (large_scenes.cantilever(), 8, 1e-3),
        (large_scenes.roll_up(n=12), 8, 1e-6),  # rotations of an edge do the work
        (large_scenes.strip(8, 10.0, force, supports=moved, loads=[]), 8, 2e-2),
        (large_scenes.strip(8, 10.0, force, supports=sprung), 8, 1e-3),
        (large_scenes.roof(3, order=2, share=0.8), 8, 5e-2),
    ):
        result = ks.trace(scene, order=2, steps=steps)
        assert result.external_work == pytest.approx(result.strain_energy, rel=close)


def test_motion_without_loads_in_one_step():
    """A prescribed motion starts from a state without any energy."""
    supports = [ks.Clamped("x0"), ks.Fixed("x1", "z", value=(0, 0, 4.0))]
    scene = large_scenes.strip(8, 10.0, None, supports=supports, loads=[])
    one, many = (ks.solve(scene, order=2, large_deflection=True, steps=steps) for steps in (1, 5))
    assert one.probe("tip")["u"] == pytest.approx(many.probe("tip")["u"], abs=1e-6)
    assert one.balance < 1e-6


EULER = np.pi**2 * 100 / (4 * 10.0**2)  # of a strip clamped at one end


def test_imperfection_of_a_buckling_mode():
    """A strip of the shape of its buckling mode bends further by 1 / (1 - P / Euler), in small deflections."""
    load = ks.LineForce("x1", (-0.5 * EULER, 0, 0))
    for order, close in ((1, 2e-2), (2, 1e-3), (3, 1e-3)):
        scene = large_scenes.strip(8, 10.0, load, imperfection=ks.Imperfection(amplitude=0.01))
        result = ks.solve(scene, large_deflection=True, order=order)
        assert abs(result.probe("tip")["u"][2]) == pytest.approx(0.01, rel=close)
        (words,) = (words for words in result.model["reasons"] if "linear buckling mode 1" in words)
        assert float(words.split()[-1]) == pytest.approx(2.0, rel=close)
        assert np.abs(result.mesh.points[:, 2]).max() == pytest.approx(0.01, rel=1e-6)


def test_imperfection_from_a_file(tmp_path):
    """Offsets given vertex by vertex, and the mode of an earlier result scaled."""
    load = ks.LineForce("x1", (-0.5 * EULER, 0, 0))
    scene = large_scenes.strip(8, 10.0, load)
    x = scene.mesh.points
    shape = np.stack([0 * x[:, 0], 0 * x[:, 0], 0.01 * (1 - np.cos(np.pi * x[:, 0] / 20))], axis=1)
    np.savetxt(tmp_path / "offsets.txt", np.hstack([x, shape]))
    scene = dataclasses.replace(scene, imperfection={"file": tmp_path / "offsets.txt"})
    result = ks.solve(scene, large_deflection=True, order=1)
    assert abs(result.probe("tip")["u"][2]) == pytest.approx(0.01, rel=3e-2)

    found = ks.trace(large_scenes.strip(8, 10.0, ks.LineForce("x1", (-1.1 * EULER, 0, 0))), order=2)
    found.save(tmp_path)
    again = dataclasses.replace(
        scene, imperfection=ks.Imperfection(amplitude=0.01, file=tmp_path / "result.vtu", field="mode_1")
    )
    assert np.abs(again.imperfection.amplitude) == 0.01
    result = ks.solve(again, large_deflection=True, order=1)
    assert abs(result.probe("tip")["u"][2]) == pytest.approx(0.01, rel=3e-2)

    wrong = dataclasses.replace(scene, mesh=large_scenes.rectangle(10.0, 1.0, 7, 1))
    with pytest.raises(ks.InputError, match="off the next vertex"):
        ks.solve(wrong)


def test_branch_of_a_buckled_strip():
    """At 1.152 times Euler's load the end turns by 60 degrees, to 0.741 L, 0.593 L (Timoshenko & Gere, section 2.7)."""
    scene = large_scenes.strip(8, 10.0, ks.LineForce("x1", (-1.152 * EULER, 0, 0)))
    for branch in (-1, 1):
        result = ks.trace(scene, order=2, branch=branch)
        u, rotation = result.probe("tip")["u"], result.probe("tip")["rotation"]
        assert [(point["kind"], point["then"]) for point in result.critical] == [("bifurcation", "branched")]
        assert 1.152 * result.critical[0]["factor"] == pytest.approx(1.0, rel=1e-3)
        assert 10 + u[0] == pytest.approx(7.41, abs=0.01)
        assert abs(u[2]) == pytest.approx(5.93, abs=0.01)
        assert abs(np.degrees(rotation[1])) == pytest.approx(60.0, abs=0.3)
        assert all(entry["stable"] for entry in result.path)
    assert u[2] * branch * result.fields["mode_1"][:, 2].sum() > 0
    straight = ks.trace(scene, order=2)
    assert not straight.path[-1]["stable"]
    assert straight.critical[0]["then"] == "followed"


def test_displacement_control_through_limit_points():
    scene = large_scenes.roof(3, order=2)
    control = {"probe": "crown", "component": "z", "to": -30.0}
    result = ks.trace(scene, control=control, steps=5)
    assert result.probe("crown")["u"][2] == pytest.approx(-30.0, abs=1e-9)
    assert [point["kind"] for point in result.critical] == ["limit", "limit"]
    assert result.critical[0]["factor"] == pytest.approx(0.7421, rel=5e-3)
    assert result.critical[1]["factor"] == pytest.approx(0.1729, rel=3e-2)
    chart = dataclasses.replace(scene, solve={"element": "argyris"})
    limit = ks.trace(chart, control={**control, "to": -13.0}, steps=3).critical[0]["factor"]
    assert limit == pytest.approx(result.critical[0]["factor"], rel=5e-3)
    for change, words in (
        ({"probe": "crwn"}, "did you mean"),
        ({"component": "x"}, "supports hold probe"),
        ({"to": 0.0}, "goes nowhere"),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.trace(scene, control={**control, **change})
    with pytest.raises(ks.InputError, match='is for analysis = "path"'):
        ks.solve(scene, control=control)


def test_planes_of_symmetry_stay_planes_of_symmetry_on_charts():
    """At any deflection a point of the plane only turns about its normal and stays in it: not to first order only."""
    scene = dataclasses.replace(
        large_scenes.roof(3), loads=[ks.Pressure(-6e-3)], solve={"element": "argyris", "large_deflection": True},
        probes={"x": (0, 100.0, 2540), "y": (2540 * np.sin(0.05), 0, 2540 * np.cos(0.05))},
    )  # fmt: skip
    result = ks.solve(scene)
    for axis, name in enumerate("xy"):
        u, turned = result.probe(name)["u"], result.probe(name)["rotation"]
        across = np.delete(turned, axis)
        assert np.abs(u).max() > 1.0
        assert abs(u[axis]) < 1e-9
        assert np.abs(across).max() < 1e-9
    assert abs(result.probe("y")["rotation"][1]) > 0.005
