"""Large deflections from scene to result: references, auto, paths, interruption, what is refused."""

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

import kshell as ks
from kshell.cli.commands import run
from kshell.mesh import write_msh
from kshell.verify.cases import large_scenes
from tests.plate.plates import disk
from tests.scene.fabricated import square_mesh

ROOT = Path(__file__).parents[2]


def test_cantilever_in_one_step():
    result = ks.solve(large_scenes.cantilever(), large_deflection=True, order=2)
    u = result.probe("tip")["u"]
    assert (-u[0], u[2]) == pytest.approx(large_scenes.CANTILEVER, rel=2e-4)
    assert result.solver["steps"] == 1
    assert result.solver["iterations"] <= 10
    # the moment of the reaction is that of the force at its displaced place, about the origin
    assert result.reactions["x0"]["force"] == pytest.approx([0, 0, -4.0], abs=1e-9)
    assert result.reactions["x0"]["moment"][1] == pytest.approx(4.0 * (10.0 + u[0]), rel=1e-4)
    assert result.balance < 1e-9
    # the end of the elastica at alpha = 4 turns by 1.1212
    assert result.probe("tip")["rotation"] == pytest.approx([0, -1.1212, 0], abs=5e-3)


@pytest.mark.parametrize(("alpha", "known"), large_scenes.ELASTICA.items())
def test_elastica(alpha, known):
    u = ks.solve(large_scenes.elastica(alpha), large_deflection=True, order=3).probe("tip")["u"] / 10
    assert (u[2], -u[0]) == pytest.approx(known, rel=1e-4)


@pytest.mark.parametrize("Q", [1, 50])
def test_von_karman_plate(Q):
    result = ks.solve(large_scenes.von_karman(Q, 6), large_deflection=True)
    assert result.probe("centre")["u"][2] / 0.01 == pytest.approx(large_scenes.VON_KARMAN[Q], rel=1e-3)


def test_auto_goes_on_where_it_matters_and_says_so():
    scene = large_scenes.cantilever()
    large = ks.solve(scene)
    assert large.model["large_deflection"]
    assert large.model["kind"] == "shell"
    reasons = " ".join(large.model["reasons"])
    assert "they change the displacements by 42 %, more than the tolerance of 1 %" in reasons
    assert "large_deflection = false keeps the linear solution" in reasons
    assert 'probe "tip": u = (-3.28' in reasons
    assert "linear (0, 0, 13.33" in reasons  # P L^3 / 3 EI

    gentle = dataclasses.replace(scene, loads=[ks.LineForce("x1", (0, 0, 0.004))])
    plate = ks.solve(gentle)
    assert (plate.model["kind"], plate.model["large_deflection"]) == ("plate", False)
    shell = ks.solve(gentle, model="shell")
    assert not shell.model["large_deflection"]
    assert shell.error["budget"]["large_deflection"] < 0.01
    true = ks.solve(gentle, large_deflection=True, order=3)
    assert shell.probe("tip")["u"][2] == pytest.approx(true.probe("tip")["u"][2], rel=1e-3)

    # bent by a thickness, but free to: the plate was right
    bent = ks.solve(dataclasses.replace(scene, loads=[ks.LineForce("x1", (0, 0, 0.03))]))
    assert (bent.model["kind"], bent.model["large_deflection"]) == ("plate", False)
    assert any("times the thickness" in words for words in bent.model["reasons"])

    with pytest.warns(ks.KshellWarning, match="times the thickness"):
        asked = ks.solve(scene, model="plate")
    assert asked.model["kind"] == "plate"


def test_auto_leaves_plates_whose_motion_in_the_plane_is_not_said_linear_and_warns():
    disk = ks.geometry.Plane().mesh(6, 6, names=("a", "b", "c", "d"))
    edges, unit = ["a", "b", "c", "d"], ks.Isotropic(E=12 * (1 - 0.3**2) / 1e-6, nu=0.3)
    scene = ks.Scene(disk, 0.01, unit, [ks.SimplySupported(edges)], [ks.Pressure(1.0)])
    with pytest.warns(ks.KshellWarning, match="would deflect by 83% of that"):
        result = ks.solve(scene)
    assert result.model["kind"] == "plate"
    assert result.extremes["deflection"]["value"] == pytest.approx(0.00406235, rel=1e-3)
    absurd = dataclasses.replace(scene, supports=[ks.Clamped(edges)], loads=[ks.Pressure(1e6)])
    with pytest.warns(ks.KshellWarning, match="times the thickness"):
        assert ks.solve(absurd).model["kind"] == "plate"


@pytest.mark.parametrize("name", ["scordelis_lo", "hemisphere_hole", "twisted_beam", "raasch_hook"])
def test_auto_leaves_small_loads_alone(name):
    """Of loads s times smaller, the change is s times smaller, down to rounding."""
    scene = ks.Scene.load(ROOT / "meshes" / f"{name}.toml")
    changes = []
    for share in (1e-3, 1e-4):
        loads = [dataclasses.replace(load, value=times(load.value, share)) for load in scene.loads]
        result = ks.solve(dataclasses.replace(scene, loads=loads), large_deflection="auto")
        assert not result.model["large_deflection"]
        changes.append(result.error["budget"]["large_deflection"])
    assert changes[0] < 1e-3
    assert changes[1] == pytest.approx(0.1 * changes[0], rel=0.3, abs=1e-5)


def times(value, share):
    return share * value if np.isscalar(value) else tuple(share * np.array(value, dtype=float))


def test_auto_notices_that_the_linear_solution_is_unstable():
    """A strip pressed along its axis with twice the Euler load of a cantilever: the residual alone is nothing."""
    euler = np.pi**2 * 100 / (4 * 10.0**2)
    for share, unstable in ((0.9, False), (2.0, True)):
        scene = large_scenes.strip(8, 10.0, ks.LineForce("x1", (-share * euler, 0, 0)))
        result = ks.solve(scene, order=2)
        assert result.model["large_deflection"] is unstable
        assert any("linear solution is unstable" in words for words in result.model["reasons"]) is unstable
        assert any("a small disturbance makes the shell buckle" in w for w in result.warnings) is unstable


def test_auto_measures_the_error_of_the_linear_solution():
    """Where the clamped plate says 1 percent, that is about what large deflections change."""
    for Q, matters in ((0.5, False), (2, True)):
        scene = large_scenes.von_karman(Q, 6)
        assert ks.solve(scene).model["large_deflection"] is matters


def test_free_thermal_expansion_under_large_deflections():
    """Strains of one percent: Green's strain of a stretch s is (s^2 - 1) / 2."""
    scene = ks.Scene(
        mesh=square_mesh(4), thickness=0.01, material=ks.Isotropic(1e9, 0.3),
        supports=[ks.Symmetry("left"), ks.Symmetry("bottom"), ks.Fixed("plate", "z")],
        loads=[ks.Temperature(mean=100.0, expansion=1e-4)], probes={"p": (1.0, 1.0, 0.0)},
    )  # fmt: skip
    for analysis in ("static", "path"):
        result = ks.solve(scene, large_deflection=True, analysis=analysis)
        assert result.probe("p")["u"][:2] == pytest.approx([np.sqrt(1.02) - 1] * 2, rel=1e-6)
        assert np.abs(result.probe("p")["N"]).max() < 1.0  # held, it would be 1.4e5


def test_follower_pressure_of_a_scene():
    """The clamp carries the pressure on the chord, turned by 90 degrees."""
    scene = large_scenes.strip(10, 10.0, ks.Pressure(2.0, follower=True))
    result = ks.solve(scene, order=2, steps=4)
    u = result.probe("tip")["u"]
    assert u[2] > 3.0
    chord = np.array([-u[2], 0.0, 10.0 + u[0]])
    assert result.reactions["x0"]["force"] == pytest.approx(-2.0 * chord, abs=2e-2)
    assert result.balance < 1e-6


@pytest.fixture(scope="module")
def roof_result():
    return ks.trace(large_scenes.roof(3, order=2, share=0.8))


def test_path_through_limit_points(roof_result, tmp_path):
    kinds = [point["kind"] for point in roof_result.critical]
    assert kinds == ["limit", "limit"]
    high, low = (0.8 * point["factor"] for point in roof_result.critical)
    assert high == pytest.approx(0.7421, rel=1e-2)
    assert low == pytest.approx(0.1729, rel=5e-2)
    assert roof_result.path[0]["factor"] == 0.0
    assert roof_result.path[-1]["factor"] == pytest.approx(1.0)
    assert not all(entry["stable"] for entry in roof_result.path)
    assert any("limit point" in words for words in roof_result.warnings)
    names = {Path(name).name for name in roof_result.save(tmp_path)}
    steps = len(roof_result.path)
    assert {"path.pvd", "load_deflection.png", f"step-{steps - 1:04d}.vtu"} <= names
    assert (tmp_path / "path.pvd").read_text(encoding="utf-8").count("DataSet") == steps
    last = meshio.read(tmp_path / f"step-{steps - 1:04d}.vtu")
    deepest = last.point_data["displacement"][:, 2].min()
    assert deepest == pytest.approx(roof_result.path[-1]["probes"]["crown"]["u"][2], rel=1e-6)
    assert np.abs(meshio.read(tmp_path / "result.vtu").point_data["mode_1"]).max() == pytest.approx(
        1.0, rel=0.2
    )
    document = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert document["analysis"] == "path"
    assert len(document["path"]) == steps


@pytest.mark.parametrize(
    "options",
    [{"analysis": "path"}, {"analysis": "static", "large_deflection": "auto"}],
    ids=["path", "auto"],
)
def test_load_that_cannot_grow_leaves_the_last_good_state(options, monkeypatch):
    """Neither jumps nor a long way round are allowed."""
    monkeypatch.setattr("kshell.equilibrium.limit_points.MOST_JUMPS", 0)
    monkeypatch.setattr("kshell.equilibrium.limit_points.MOST_ARC_STEPS", 2)
    with pytest.raises(ks.SolveError, match="cannot be increased beyond the factor") as caught:
        ks.solve(large_scenes.roof(2, order=2), steps=4, **options)
    state = caught.value.state
    assert 0.7 < max(entry["factor"] for entry in state.path) < 0.8
    assert np.isfinite(state.fields["displacement"]).all()
    assert state.balance < 1e-6
    assert ("large_deflection = false" in str(caught.value)) is ("large_deflection" in options)


def test_static_load_jumps_over_the_limit_point():
    """The state behind the jump is that on the path at the same load."""
    scene = large_scenes.roof(3, order=2, share=0.9)
    result = ks.solve(scene, large_deflection=True, steps=3)
    assert [(point["kind"], point["then"]) for point in result.critical] == [("limit", "jumped")]
    assert 0.9 * result.critical[0]["factor"] == pytest.approx(0.7421, rel=1e-2)
    assert any("jumps there to another stable state" in words for words in result.warnings)
    assert all(entry["stable"] for entry in result.path)
    assert result.probe("crown")["u"][2] == pytest.approx(-28.2, abs=0.3)  # 0.9 in the table
    path = ks.trace(scene)
    assert result.probe("crown")["u"][2] == pytest.approx(path.probe("crown")["u"][2], rel=1e-6)


SCENE = """
mesh = "strip.msh"
thickness = 0.1
material = {E = 1.2e6, nu = 0.0}
support = [{on = "x0", kind = "clamped"}]
load = [{kind = "line_force", on = "x1", value = [0, 0, 4.0]}]
probe = [{name = "tip", at = [10, 1, 0]}]
solve = {order = 2, steps = 40}
"""


@pytest.fixture
def strip_file(tmp_path):
    write_msh(large_scenes.cantilever(16).mesh, tmp_path / "strip.msh")
    path = tmp_path / "strip.toml"
    path.write_text(SCENE, encoding="utf-8")
    return path


# Stops itself right after a step is written: a signal from outside might come when all is done. Whoever started the
# tests may have had interrupts ignored, as shells do for jobs in the background, and a child inherits that.
STOPPED = """
import os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
from kshell.cli.commands import main
from kshell.equilibrium.checkpoint import Checkpoints
write = Checkpoints.write
def write_and_stop(self, number, *rest):
    write(self, number, *rest)
    if number == {step}:
        {stop}
Checkpoints.write = write_and_stop
main()
"""


def stopped(path, step, stop):
    """A trace that stops itself after the step: the process when it has ended, and its words."""
    command = [sys.executable, "-c", STOPPED.format(step=step, stop=stop), "trace", str(path)]
    return subprocess.run(
        [*command, "-o", str(path.parent / "out")],
        cwd=ROOT,
        capture_output=True,
        check=False,
        timeout=600,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )


def path_of(folder):
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))["path"]


def test_killed_path_is_resumed_identically(strip_file):
    whole, out = strip_file.parent / "whole", strip_file.parent / "out"
    assert run(["trace", str(strip_file), "-o", str(whole)]) == 0
    process = stopped(strip_file, 2, "os._exit(9)")  # nothing is cleaned up, as when killed
    assert process.returncode == 9
    assert not (out / "result.json").exists()
    assert len(list((out / "steps").glob("*.npz"))) < len(path_of(whole)) - 1
    (out / "steps" / "step-0099.npz-unfinished").write_bytes(b"half")
    assert run(["trace", str(strip_file), "-o", str(out), "--resume"]) == 0
    assert path_of(out) == path_of(whole)


def test_interrupted_path_saves_the_last_good_state(strip_file):
    out = strip_file.parent / "out"
    process = stopped(strip_file, 2, "signal.raise_signal(signal.SIGINT)")
    assert process.returncode == 130
    assert b"interrupted" in process.stderr
    assert b"Traceback" not in process.stderr
    path = path_of(out)
    assert 0.0 < path[-1]["factor"] < 1.0


def test_resume_refuses_steps_of_another_problem(strip_file, capsys):
    out = str(strip_file.parent / "out")
    assert run(["trace", str(strip_file), "-o", out, "--set", "solve.steps=3"]) == 0
    changed = ["--set", "solve.steps=3", "--set", "load.0.value=[0, 0, 3.0]"]
    assert run(["trace", str(strip_file), "-o", out, "--resume", *changed]) == 2
    assert "another problem" in capsys.readouterr().err
    assert run(["trace", str(strip_file), "--resume"]) == 2
    assert "-o DIR" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"analysis": "path", "large_deflection": False}, "follows large deflections"),
        ({"large_deflection": True, "model": "plate"}, "is for shells"),
        ({"large_deflection": True, "element": "morley"}, "is for shells"),
        ({"steps": 0}, "whole number"),
    ],
)
def test_options_that_contradict_each_other(options, words):
    with pytest.raises(ks.InputError, match=words):
        ks.solve(large_scenes.cantilever(), **options)


def test_element_on_a_chart_agrees_with_triangles():
    scene = dataclasses.replace(
        large_scenes.roof(3), loads=[ks.Pressure(-2e-3)], solve={"large_deflection": True}
    )
    values = [ks.solve(scene, element=element).probe("crown") for element in ("argyris", "koiter")]
    assert abs(values[1]["u"][2]) > 0.4
    assert values[0]["u"][2] == pytest.approx(values[1]["u"][2], rel=2e-3)
    assert values[0]["N"] == pytest.approx(values[1]["N"], abs=2e-2 * np.abs(values[1]["N"]).max())
    assert values[0]["M"] == pytest.approx(values[1]["M"], abs=5e-2 * np.abs(values[1]["M"]).max())


@pytest.mark.parametrize("thickness", [1e-4, pytest.param(1e-6, marks=pytest.mark.full)])
def test_a_membrane_takes_its_load_in_one_step(thickness):
    """Hencky: w = 0.6536 (q a / E t)^(1/3) a at the centre; no limit point is passed on the way."""
    modulus, rise = 1e9, 0.05
    result = ks.solve(
        ks.Scene(
            mesh=disk(4),
            thickness=thickness,
            material=ks.Isotropic(E=modulus, nu=0.3),
            supports=[ks.Clamped("edge")],
            loads=[ks.Pressure(modulus * thickness * (rise / 0.6536) ** 3)],
            probes={"c": (0, 0, 0)},
            solve={"large_deflection": True, "error": "off"},
        )
    )
    assert result.probe("c")["u"][2] == pytest.approx(rise, rel=1e-2)
    assert not result.critical
    assert result.solver["iterations"] <= 15
