"""Harmonic response: against one mode in closed form, against a direct solution, and what is refused."""

import numpy as np
import pytest

import kshell as ks
from kshell.analysis.models import model_of
from tests.analysis.test_modes import square

RATIO = 0.02
LOAD = ks.Pressure("sin(pi*x)*sin(pi*y)")
CENTRE = {"centre": (0.5, 0.5, 0.0)}


def shaken(load=LOAD, probes=CENTRE, **options):
    scene = square("SSSS", n=6, loads=[load], density=1.0)
    return ks.Scene(
        mesh=scene.mesh, thickness=1.0, material=scene.material, supports=list(scene.supports), loads=[load],
        probes=probes, solve={"analysis": "response", "damping": RATIO, **options},
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
    still = ks.solve(shaken(force), analysis="static", damping=0.0, large_deflection=False)
    assert complex_at(result)[0, 2].real == pytest.approx(still.probe("centre")["u"][2], rel=1e-9)


def test_against_a_direct_solution_without_damping():
    force = ks.PointForce((0.5, 0.5, 0.0), (0, 0, 1.0))
    result = ks.solve(shaken(force, range=(4.0, 4.5), damping=0.0))
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
        ({"range": (0, 5), "prestress": True}, "prestress is for"),
        ({"range": (0, 5), "damping": 1.5}, "between 0 and 1"),
    ],
)
def test_refused(options, message):
    with pytest.raises(ks.InputError, match=message):
        ks.solve(shaken(**options))


def test_needs_a_probe():
    with pytest.raises(ks.InputError, match="needs a probe"):
        ks.solve(shaken(probes={}, range=(0, 5)))


def test_damping_elsewhere():
    with pytest.raises(ks.InputError, match="damping is for analysis"):
        ks.solve(shaken(), analysis="static")
