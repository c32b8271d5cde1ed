"""Motion by small deflections: plates and shells against series, Duhamel's integral, and large deflections."""

import numpy as np
import pytest

import kshell as ks
from kshell.draw.pictures import pictures
from kshell.verify.cases import large_scenes
from tests.plate.plates import disk, rectangle

E, NU, THICKNESS, DENSITY = 1e7, 0.3, 0.01, 100.0
STIFFNESS, MASS = E * THICKNESS**3 / 12 / (1 - NU**2), DENSITY * THICKNESS
FIRST = float(2 * np.pi**2 * np.sqrt(STIFFNESS / MASS))  # of the unit square, simply supported
PERIOD = 2 * np.pi / FIRST
EDGES = ["left", "right", "top", "bottom"]
CELLS = {"argyris": 3, "morley": 10}


def plate(element="argyris", **changes):
    given = {
        "mesh": rectangle(CELLS[element]),
        "thickness": THICKNESS,
        "material": ks.Isotropic(E=E, nu=NU, density=DENSITY),
        "supports": [ks.SimplySupported(EDGES)],
        "probes": {"centre": (0.5, 0.5, 0)},
        "solve": {"element": element, "time": 2.3 * PERIOD, "step": PERIOD / 40},
    }
    return ks.Scene(**{**given, **changes})


def at_centre(result):
    return result.history["time"], result.history["probes"]["centre"]["u"][:, 2]


def period(result):
    t, z = at_centre(result)
    up = [k for k in range(1, len(z) - 1) if z[k] <= 0 < z[k + 1]]
    return float(np.mean(np.diff([t[k] - z[k] * (t[k + 1] - t[k]) / (z[k + 1] - z[k]) for k in up])))


MODE = (0, 0, f"1e-4*{FIRST}*sin(pi*x)*sin(pi*y)")


@pytest.mark.parametrize(
    ("scheme", "error"),
    [("alpha", 2.17e-3), ("em", (np.pi / 20) ** 2 / 12), ("bdf2", 8.0e-3), ("euler", (np.pi / 20) ** 2 / 3)],
)
def test_period_of_a_square(scheme, error):
    """Longer than 2 pi / (2 pi^2 sqrt(D / m)) by what theory says of the scheme at 40 steps a period."""
    result = ks.simulate(plate(initial_velocity=MODE), scheme=scheme)
    assert result.model["kind"] == "plate"
    assert not result.model["large_deflection"]
    assert period(result) / PERIOD - 1 == pytest.approx(error, rel=0.05)
    history = result.history
    energy = history["kinetic_energy"] + history["strain_energy"]
    assert energy[0] == pytest.approx(0.5 * MASS * (1e-4 * FIRST) ** 2 / 4, rel=1e-6)
    if scheme == "em":
        assert np.ptp(energy) < 1e-10 * energy[0]
        assert result.balance < 1e-10


def test_order_of_the_schemes():
    """Twice the step, four times the error of the period; of Morley's plate against its own frequency."""
    for element in CELLS:
        scene = plate(element, initial_velocity=MODE)
        own = (
            1
            / ks.modes(scene.changed(initial_velocity=None, solve={"element": element}), count=1).eigen[0][
                "frequency"
            ]
        )
        for scheme in ("alpha", "em"):
            error = [
                period(ks.simulate(scene, scheme=scheme, step=PERIOD / n)) / own - 1 for n in (10, 20, 40)
            ]
            assert error[0] / error[1] == pytest.approx(4.0, rel=0.1)
            assert error[1] / error[2] == pytest.approx(4.0, rel=0.1)


def duhamel(t, drive, damping=0.0, most=7):
    """(time,) deflection of the middle under the pressure sin(drive t): the integral of every mode."""
    total = np.zeros_like(t)
    fine = np.linspace(0, t[-1], 40 * (len(t) - 1) + 1)
    for m in range(1, most, 2):
        for n in range(1, most, 2):
            w = np.pi**2 * (m * m + n * n) * np.sqrt(STIFFNESS / MASS)
            ratio = damping * w / FIRST  # of a viscous material
            own = w * np.sqrt(1 - ratio**2)
            force = 16 / (np.pi**2 * m * n) / MASS * np.sin(drive * fine)
            # int f(s) e^(-zeta w (t - s)) sin(own (t - s)) / own, by the sums of sine and cosine
            grown = np.exp(ratio * w * fine)
            step = fine[1]
            sums = [
                np.concatenate([[0], np.cumsum(0.5 * step * (part[1:] + part[:-1]))])
                for part in (force * grown * np.cos(own * fine), force * grown * np.sin(own * fine))
            ]
            found = (np.sin(own * fine) * sums[0] - np.cos(own * fine) * sums[1]) / grown / own
            total += (found * np.sin(m * np.pi / 2) * np.sin(n * np.pi / 2))[::40]
    return total


@pytest.mark.parametrize("ratio", [0.0, 0.02])
def test_forced_response_against_duhamel(ratio):
    """Under a pressure that oscillates, with and without damping: of order 2 in the step."""
    drive = 0.6 * FIRST
    scene = plate(loads=[ks.Pressure(f"sin({drive}*t)")], damping={"ratio": ratio})
    errors = []
    for steps in (40, 80):
        t, z = at_centre(ks.simulate(scene, step=PERIOD / steps))
        right = duhamel(t, drive, ratio)
        errors.append(np.abs(z - right).max() / np.abs(right).max())
    assert errors[1] < 1e-2
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)


def test_one_factorisation_for_each_size_of_the_steps():
    result = ks.simulate(plate("morley", initial_velocity=MODE), scheme="alpha")
    assert result.solver["why"].startswith("factorised 1 times")
    adapted = ks.simulate(
        plate(loads=[ks.Pressure(1.0)], damping={"ratio": 0.2}), step="auto", time=3 * PERIOD
    )
    assert len(np.unique(np.round(np.diff(adapted.history["time"]) / PERIOD, 9))) > 1


@pytest.mark.parametrize("element", ["argyris", "morley"])
def test_rest_under_a_load_that_grows(element):
    """With drag a plate ends where statics has it, with its reactions; an added mass and springs take part."""
    common = {
        "loads": [ks.Pressure("2 + x"), ks.PointForce((0.5, 0.5, 0), (0, 0, 0.3))],
        "supports": [ks.SimplySupported(["left", "right"]), ks.Elastic("top", 50.0)],
        "masses": [ks.Mass((0.5, 0.5, 0), 0.2)],
    }
    scene = plate(element, **common, damping={"drag": 1.5 * FIRST})
    still = ks.solve(scene.changed(solve={"element": element}, damping=None))
    moved = ks.simulate(scene, ramp=2 * PERIOD, time=40 * PERIOD, step=PERIOD / 2, scheme="bdf2")
    assert moved.probe("centre")["u"] == pytest.approx(still.probe("centre")["u"], rel=1e-6)
    assert moved.probe("centre")["M"] == pytest.approx(still.probe("centre")["M"], rel=1e-5)
    for label, entry in still.reactions.items():
        assert moved.reactions[label]["force"] == pytest.approx(entry["force"], rel=1e-5, abs=1e-9)
        assert moved.reactions[label]["moment"] == pytest.approx(entry["moment"], rel=1e-5, abs=1e-8)
    assert moved.strain_energy == pytest.approx(still.strain_energy, rel=1e-5)
    assert moved.energies["springs"] == pytest.approx(still.energies["springs"], rel=1e-5)


def test_an_added_mass_slows_the_plate():
    scene = plate(masses=[ks.Mass((0.5, 0.5, 0), 0.4)], initial_velocity=MODE)
    own = ks.modes(scene.changed(initial_velocity=None, solve={"element": "argyris"}), count=1)
    result = ks.simulate(scene, scheme="em", step=PERIOD / 160, time=4 * PERIOD)
    assert period(result) * own.eigen[0]["frequency"] == pytest.approx(
        1.0, rel=3e-2
    )  # the second mode is in it
    assert period(result) > 1.2 * PERIOD


def test_a_free_plate_falls():
    scene = plate(supports=[], initial_velocity=(0, 0, 1.0), loads=[ks.Gravity((0, 0, -10.0))])
    result = ks.simulate(scene, time=0.5, step=0.05)
    assert result.probe("centre")["u"] == pytest.approx([0, 0, 0.5 - 1.25], abs=1e-9)
    assert result.history["momentum"][-1] == pytest.approx([0, 0, MASS * (1 - 5.0)], abs=1e-9)
    assert result.balance < 1e-9


@pytest.mark.parametrize("element", ["argyris", "morley"])
def test_a_plate_that_its_supports_lift(element):
    """Lifted at rest by all of its edge it keeps its shape; the reaction is the weight of its acceleration."""
    rise = PERIOD * 20
    height = f"0.01*(1 - cos(pi*t/{rise}))/2"
    scene = plate(element, supports=[ks.Fixed(EDGES, "z", value=(0, 0, height))])
    result = ks.simulate(scene, time=rise, step=PERIOD / 5, scheme="bdf2")
    t, z = at_centre(result)
    assert z == pytest.approx(0.005 * (1 - np.cos(np.pi * t / rise)), abs=2e-4)
    acceleration = 0.005 * (np.pi / rise) ** 2 * np.cos(np.pi * t / rise)
    assert result.history["reaction"][30:, 2] == pytest.approx(
        MASS * acceleration[30:], abs=0.1 * MASS * acceleration[0]
    )
    assert result.balance < 2e-2


def test_a_deflection_let_go():
    """Let go in its first mode a plate swings there and back."""
    scene = plate(initial_displacement=(0, 0, "1e-3*sin(pi*x)*sin(pi*y)"))
    result = ks.simulate(scene, time=PERIOD)
    _, z = at_centre(result)
    assert z[0] == pytest.approx(1e-3, rel=1e-3)
    assert z[20] == pytest.approx(-1e-3, rel=1e-3)
    assert z[40] == pytest.approx(1e-3, rel=1e-3)
    with pytest.raises(ks.InputError, match="moves what supports hold"):
        ks.simulate(plate(initial_displacement=(0, 0, 1e-3)))
    with pytest.raises(ks.InputError, match="moves along z only"):
        ks.simulate(plate(initial_displacement=(1e-3, 0, 0)))


def test_a_temperature_that_comes_and_goes():
    """A gradient bends a free plate; what it strains without stress stores no energy."""
    heat = ks.Temperature(gradient=f"min(t/{4 * PERIOD}, 1)", expansion=1e-3)
    scene = plate(supports=[ks.Fixed((0, 0, 0), "z"), ks.Fixed((1, 0, 0), "z"), ks.Fixed((0, 1, 0), "z")])
    scene = scene.changed(loads=[heat], damping={"ratio": 0.3})
    still = ks.solve(
        scene.changed(
            loads=[ks.Temperature(gradient=1.0, expansion=1e-3)], damping=None, solve={"element": "argyris"}
        )
    )
    result = ks.simulate(scene, time=20 * PERIOD, step=PERIOD / 4)
    assert result.probe("centre")["u"] == pytest.approx(still.probe("centre")["u"], rel=1e-3)
    assert result.history["strain_energy"][-1] < 1e-4 * result.history["strain_energy"].max()


def strip(**changes):
    """A cantilever of shell, set off."""
    given = {
        "mesh": large_scenes.rectangle(1.0, 0.1, 3, 1),
        "thickness": 0.005,
        "material": ks.Isotropic(E=2e9, nu=0.3, density=1000.0),
        "supports": [ks.Clamped("x0")],
        "probes": {"centre": (1.0, 0, 0)},
        "loads": [ks.Traction((0.02, 0, "0.02*(t < 0.1)"))],
        "initial_velocity": (0, 0, "1e-4*x**2"),
        "solve": {"order": 2, "time": 0.5, "step": 0.01},
    }
    return ks.Scene(**{**given, **changes})


@pytest.mark.parametrize("scheme", ["alpha", "em", "bdf2", "euler"])
def test_small_motion_of_a_shell_is_the_limit_of_large_ones(scheme):
    scene = strip(damping={"drag": 0.5})
    small, large = (ks.simulate(scene, scheme=scheme, large_deflection=asked) for asked in (False, "auto"))
    assert not small.model["large_deflection"]
    assert small.model["kind"] == "shell"
    for name in (
        "kinetic_energy",
        "strain_energy",
        "external_work",
        "dissipated_energy",
        "momentum",
        "reaction",
    ):
        first, second = small.history[name], large.history[name]
        assert first == pytest.approx(second, abs=2e-3 * np.abs(second).max())
    u, v = (found.history["probes"]["centre"]["u"] for found in (small, large))
    assert u == pytest.approx(v, abs=1e-3 * np.abs(v).max())
    assert small.reactions["x0"]["force"] == pytest.approx(
        large.reactions["x0"]["force"], abs=1e-3 * np.abs(large.history["reaction"]).max()
    )


@pytest.mark.parametrize(
    "more", [{}, {"chart": ks.geometry.Cylinder(R=2.0), "supports": [ks.Clamped("left")], "probes": {}}]
)
def test_going_on_after_an_interruption(tmp_path, more):
    """The same motion to the last digit, from what was on disk when it stopped."""
    scene = plate(loads=[ks.Pressure(f"sin({FIRST}*t)")], damping={"ratio": 0.02}, **more)
    options = {
        "time": PERIOD,
        "output": 8,
        "large_deflection": False,
        "element": "auto" if more else "argyris",
    }
    whole = ks.simulate(scene, folder=tmp_path / "whole", **options)
    seen = []

    def stop(words):
        seen.append(words)
        if sum("t =" in w for w in seen) == 17:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ks.simulate(scene, folder=tmp_path / "cut", progress=stop, **options)
    again = ks.simulate(scene, folder=tmp_path / "cut", resume=True, **options)
    for name in ("time", "kinetic_energy", "strain_energy", "angular_momentum", "dissipated_energy"):
        assert np.array_equal(whole.history[name], again.history[name])
    assert np.array_equal(whole.fields["displacement"], again.fields["displacement"])
    assert len(again.series) == len(whole.series) == 9
    with pytest.raises(ks.InputError, match="another problem"):
        ks.simulate(scene, folder=tmp_path / "cut", resume=True, **{**options, "step": PERIOD / 20})


def test_rigid_links_move_by_small_deflections():
    """A body on a link at the end of a strip: its mass and its force are felt through it."""
    link = ks.RigidLink("x1", to=(1.2, 0.05, 0.0), name="grip")
    scene = strip(
        supports=[ks.Clamped("x0"), link],
        loads=[ks.PointForce("grip", (0, 0, "0.01*sin(3*t)"))],
        initial_velocity=None,
    )
    result = ks.simulate(scene, large_deflection=False)
    assert np.abs(result.history["probes"]["centre"]["u"]).max() > 0
    assert result.balance < 1e-2
    with pytest.raises(ks.InputError, match="rigid links are for small deflections"):
        ks.simulate(scene)


def test_what_small_motions_are_not_for():
    with pytest.raises(ks.InputError, match='element = "argyris" or "morley"'):
        ks.simulate(plate(initial_velocity=MODE), element="hhj")
    for words, options, more in (
        (
            "follower = true",
            {"large_deflection": False, "element": "auto"},
            {"loads": [ks.Pressure(1.0, follower=True)]},
        ),
        ("relaxation", {}, {"material": ks.Isotropic(E=E, nu=NU, density=DENSITY, relaxation=[[0.5, 1.0]])}),
        (
            "hardening",
            {},
            {"material": ks.Isotropic(E=E, nu=NU, density=DENSITY, yield_stress=1e3, hardening=1e5)},
        ),
        ("contact", {}, {"contact": ks.Contact()}),
        ("tolerance", {"tolerance": 0.01}, {}),
        ("density", {}, {"material": ks.Isotropic(E=E, nu=NU)}),
        ("would jump", {}, {"supports": [ks.Fixed(EDGES, "z", value=(0, 0, 0.01))]}),
        ("large_deflection", {"large_deflection": True}, {"solve": {"time": 1.0, "model": "plate"}}),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.simulate(plate(**more), **options)
    supports = [ks.Fixed("edge", "z", value=(0, 0, "0.01*sin(t)"))]
    round_plate = plate(mesh=disk(2), supports=supports, probes={"centre": (0, 0, 0)})
    with pytest.raises(ks.InputError, match="curved edge"):
        ks.simulate(round_plate)
    assert ks.simulate(round_plate, element="morley", time=3 * PERIOD).balance < 0.1


def test_deflections_that_are_not_small_are_told():
    with pytest.warns(ks.KshellWarning, match="times the thickness"):
        ks.simulate(plate(loads=[ks.Pressure(100.0)]), time=PERIOD)


def test_what_is_written(tmp_path):
    """History as a table and a picture, a series of states."""
    result = ks.simulate(plate(initial_velocity=MODE), time=PERIOD / 5, output=2)
    result.save(tmp_path)
    lines = (tmp_path / "history.csv").read_text(encoding="utf-8").splitlines()
    assert len(lines) == len(result.history["time"]) + 1
    assert (tmp_path / "series.pvd").read_text(encoding="utf-8").count("step-") == len(result.series) == 3
    assert (tmp_path / "history.png").stat().st_size > 1000
    assert {"history", "film"} <= set(pictures(result))
    words = result.plot("film").get_suptitle()
    enlarged = float(words.split("drawn ")[1].split(" times")[0])
    largest = max(np.abs(state().fields["displacement"]).max() for _, state in result.series)
    assert 0.03 < enlarged * largest / result.mesh.size < 0.11
