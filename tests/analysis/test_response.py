"""Harmonic response: against one mode in closed form, against a direct solution, and what is refused."""

import dataclasses

import numpy as np
import pytest
import scipy.sparse as sp

import kshell as ks
from kshell.analysis.models import model_of
from kshell.solvers.harmonic import harmonic_solution
from tests.analysis.test_buckling import press
from tests.analysis.test_modes import square

RATIO = 0.02
LOAD = ks.Pressure("sin(pi*x)*sin(pi*y)")
CENTRE = {"centre": (0.5, 0.5, 0.0)}


def shaken(load=LOAD, probes=CENTRE, damping={"ratio": RATIO}, **options):  # noqa: B006
    scene = square("SSSS", n=6, loads=[load], density=1.0)
    return ks.Scene(
        mesh=scene.mesh, thickness=1.0, material=scene.material, supports=list(scene.supports), loads=[load],
        probes=probes, damping=damping, solve={"analysis": "response", **options},
    )  # fmt: skip


def complex_at(result, name="centre"):
    u = result.response["probes"][name]["u"]
    return np.array(u["real"]) + 1j * np.array(u["imag"])


def test_one_mode_in_closed_form():
    """sin(pi x) sin(pi y) drives the first mode alone: w = 1 / (4 pi^4) / (1 - s^2 + 2 i zeta s)."""
    result = ks.solve(shaken(range=(0, 6)))
    f = np.array(result.response["frequency"])
    s = f / (np.pi)  # omega_1 = 2 pi^2
    exact = 1 / (4 * np.pi**4) / (1 - s**2 + 2j * RATIO * s)
    assert complex_at(result)[:, 2] == pytest.approx(exact, rel=1e-4)
    peak = np.abs(complex_at(result)[:, 2]).max()
    assert peak == pytest.approx(1 / (4 * np.pi**4) / (2 * RATIO), rel=1e-3)
    assert f[np.abs(complex_at(result)[:, 2]).argmax()] == pytest.approx(np.pi, rel=1e-3)


def test_static_share_of_the_modes_left_out():
    """Slowly, under a force that all modes feel, the answer is the static one."""
    force = ks.PointForce((0.5, 0.5, 0.0), (0, 0, 1.0))
    result = ks.solve(shaken(force, range=(0, 1)))
    still = ks.solve(shaken(force), analysis="static", large_deflection=False)
    assert complex_at(result)[0, 2].real == pytest.approx(still.probe("centre")["u"][2], rel=1e-9)


def test_against_a_direct_solution_without_damping():
    force = ks.PointForce((0.5, 0.5, 0.0), (0, 0, 1.0))
    result = ks.solve(shaken(force, range=(4.0, 4.5), damping=None))
    model = model_of(shaken(force, range=(4.0, 4.5)))
    omega = 2 * np.pi * result.response["frequency"][50]
    dynamic = (model.stiffness() - omega**2 * model.mass()).toarray()
    x = model.expand(np.linalg.solve(dynamic, model.load_vectors().sum(axis=0)))
    w = model.motion_at(x, np.array([[0.5, 0.5, 0.0]]))[0, 2]
    assert complex_at(result)[50, 2].real == pytest.approx(w, rel=2e-3)


def test_picture_and_document():
    result = ks.solve(shaken(range=(0, 6)))
    document = result.to_dict()
    assert document["analysis"] == "response"
    assert len(document["response"]["frequency"]) == len(
        document["response"]["probes"]["centre"]["u"]["real"]
    )
    assert result.plot("response").axes[0].get_xlabel() == "frequency"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "needs a range"),
        ({"range": (0, 5), "count": 3}, "count is for"),
        ({"range": (0, 5), "prestress": True}, "needs loads, or a prescribed motion, with fixed = true"),
        ({"range": (0, 5), "damping": {"ratio": [0.02]}, "scheme": "direct"}, "a ratio for every mode"),
        ({"range": (0, 5), "scheme": "alpha"}, 'scheme = "alpha" is for analysis = "dynamic"'),
    ],
)
def test_refused(options, message):
    with pytest.raises(ks.InputError, match=message):
        ks.solve(shaken(**options))


def test_needs_a_probe():
    with pytest.raises(ks.InputError, match="needs a probe"):
        ks.solve(shaken(probes={}, range=(0, 5)))


def test_damping_has_a_block_of_its_own():
    with pytest.raises(ks.InputError, match=r"damping = 0.02: it stands in a block of its own.*ratio = 0.02"):
        ks.solve(shaken(), damping=0.02, range=(0, 5))
    with pytest.raises(ks.InputError, match='scheme = "direct" is for analysis = "response"'):
        ks.solve(shaken(), analysis="static", scheme="direct")


FORCE = ks.PointForce((0.5, 0.5, 0.0), (0, 0, 1.0))


@pytest.mark.parametrize("damping", [{"ratio": 0.05}, {"viscosity": 0.01, "drag": 1.0}])
def test_direct_and_by_modes_agree(damping):
    """Through a resonance that answers and two that do not; what modes leave out is the inertia of the higher ones."""
    both = [
        ks.solve(shaken(FORCE, damping=damping, range=(2.0, 9.0), scheme=scheme))
        for scheme in ("direct", "modes")
    ]
    direct = complex_at(both[0])[:, 2]
    at = np.interp(
        both[0].response["frequency"], both[1].response["frequency"], np.abs(complex_at(both[1])[:, 2])
    )
    assert len(both[0].response["modes"]) >= 3
    assert np.abs(direct) == pytest.approx(at, rel=0.03, abs=2e-3 * np.abs(direct).max())


def test_ratios_of_the_modes():
    """Mode by mode, by viscosity in the ratio of the frequencies, by drag against it."""
    listed = ks.solve(shaken(FORCE, damping={"ratio": [0.01, 0.03]}, range=(0, 6)))
    assert listed.response["damping"][:3] == [0.01, 0.03, 0.03]
    viscous = ks.solve(shaken(FORCE, range=(0, 6)))
    omega = 2 * np.pi * np.array(viscous.response["modes"])
    assert viscous.response["damping"] == pytest.approx(RATIO * omega / omega[0])
    dragged = ks.solve(shaken(FORCE, damping={"drag": 0.4}, range=(0, 6)))
    assert dragged.response["damping"] == pytest.approx(0.2 / omega)


def tuned(n_x, more=(), n=6, **options):
    """A thin supported square, D = mass = 1, pressed by n_x pi^2 along x at rest, shaken by LOAD."""
    loads = [*more, *press(n_x, fixed=True)]
    scene = square("SSSS", n=n, loads=loads, thickness=0.01)
    return dataclasses.replace(
        scene, probes=CENTRE, damping=ks.Damping(ratio=RATIO),
        solve={"analysis": "response", "range": (0, 6), "prestress": True, **options},
    )  # fmt: skip


@pytest.mark.parametrize("scheme", ["modes", "direct"])
@pytest.mark.parametrize(
    ("n_x", "options", "close"),
    [(2.0, {}, 1e-4), (-2.0, {}, 1e-4), (2.0, {"model": "shell", "order": 3}, 1e-3)],
)
def test_loads_at_rest_tune_a_plate(n_x, options, close, scheme):
    """K + G = 4 pi^4 (1 - n_x / 4); the ratio is of that mode, though K alone is viscous."""
    result = ks.solve(tuned(n_x, [LOAD], n=4, **options))
    k = 4 * np.pi**4
    stiff = k * (1 - n_x / 4)
    omega = 2 * np.pi * np.array(result.response["frequency"])
    viscosity = 2 * RATIO * np.sqrt(stiff) / k
    exact = 1 / (stiff + 1j * omega * viscosity * k - omega**2)
    assert np.abs(complex_at(result)[:, 2] - exact).max() < close * np.abs(exact).max()
    assert result.response["damping"][0] == pytest.approx(RATIO)
    assert result.response["modes"][0] == pytest.approx(np.sqrt(stiff) / (2 * np.pi), rel=close)


def test_a_plate_bent_at_rest_vibrates_about_that_state():
    """Stretched in large deflections, without a turn: as by linear theory."""
    one, other = (
        ks.solve(tuned(-2.0, [LOAD], n=2, model="shell", order=2, **more))
        for more in ({"large_deflection": True}, {})
    )
    assert one.response["modes"] == pytest.approx(other.response["modes"], rel=1e-3)
    assert any("state of large deflections" in words for words in one.model["reasons"])


@pytest.mark.parametrize(
    ("n_x", "more", "options", "message"),
    [
        (5.0, [LOAD], {}, "beyond buckling: the structure does not vibrate"),
        (1.0, [LOAD], {"prestress": 0.5}, "prestress = 0.5 in a response"),
        (1.0, [LOAD], {"prestress": False}, "has fixed = true, and does not shake"),
        (1.0, [], {}, "needs loads that are not fixed"),
        (1.0, [LOAD], {"prestress": False, "large_deflection": True}, "for response about the state"),
    ],
)
def test_refused_at_rest(n_x, more, options, message):
    with pytest.raises(ks.InputError, match=message):
        ks.solve(tuned(n_x, more, n=2, **options))


def test_resonance_without_damping():
    result = ks.solve(shaken(damping=None, range=(3.0, 3.3), scheme="direct"))
    assert any("nothing damps the resonance at 3.14" in words for words in result.warnings)
    assert np.abs(complex_at(result)).max() > 50 * np.abs(complex_at(result)[0]).max()
    one = sp.identity(3, format="csr")
    with pytest.raises(ks.SolveError, match="in resonance"):
        harmonic_solution(4.0 * one, one, np.ones(3), 2.0, 0.0, 0.0)
