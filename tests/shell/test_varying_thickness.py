"""Thickness that varies inside triangles is that of each quadrature point, not a mean."""

import numpy as np
import pytest
from scipy.integrate import quad

import kshell as ks
from tests.shell.shell_scenes import MESHES

LENGTH, TAPER = 4.0, "0.1*(1 - x/5)"


def thickness(x):
    return 0.1 * (1 - x / 5)


def strip(n, element, **changes):
    """A cantilever along x that becomes thinner, of width 1."""
    mesh = ks.geometry.Plane().parameter_mesh(n, 1, ("root", "tip", "a", "b"), (0, LENGTH), (0, 1))
    data = {
        "mesh": mesh,
        "thickness": TAPER,
        "material": ks.Isotropic(E=1e6, nu=0.0),
        "supports": [ks.Clamped("root")],
        "loads": [ks.LineForce("tip", (3.0, 0, 0.1))],
        "probes": {"tip": (LENGTH, 0.5, 0), "middle": (LENGTH / 2, 0.5, 0)},
    }
    if element == "argyris":
        data["chart"] = ks.geometry.Plane()
    return ks.Scene(**{**data, **changes})


def exact():
    """Stretch and deflection of the tip."""
    stretch = quad(lambda x: 3.0 / (1e6 * thickness(x)), 0, LENGTH)[0]
    bend = quad(lambda x: 0.1 * (LENGTH - x) ** 2 * 12 / (1e6 * thickness(x) ** 3), 0, LENGTH)[0]
    return stretch, bend


RUNS = [
    ("koiter", 2, 8, 4e-5, 1e-4),
    ("koiter", 3, 4, 2e-5, 1e-5),
    ("koiter", 3, 8, 4e-7, 1e-6),
    ("argyris", "auto", 4, 1e-6, 1e-4),
]


@pytest.mark.parametrize(("element", "order", "n", "stretch_error", "bend_error"), RUNS)
def test_tapered_strip(element, order, n, stretch_error, bend_error):
    """Moments are linear along it, which degree 2 and more have exactly."""
    for force, known, error in zip(
        ((3.0, 0, 0), (0, 0, 0.1)), exact(), (stretch_error, bend_error), strict=True
    ):
        scene = strip(n, element, loads=[ks.LineForce("tip", force)])
        result = ks.solve(scene, model="shell", element=element, order=order, large_deflection=False)
        assert 2 * result.strain_energy / max(force) == pytest.approx(known, rel=error)
        assert result.probe("middle")["N"][0] == pytest.approx(force[0], abs=1e-2 * 3)
        assert not any("mean" in words for words in result.model["reasons"])


def test_stress_follows_the_thickness_of_the_place():
    """sigma = N / t at the middle."""
    result = ks.solve(
        strip(8, "koiter", loads=[ks.LineForce("tip", (3.0, 0, 0))]), order=3, large_deflection=False
    )
    probe = result.probe("middle")
    assert probe["stress_top"][0] == pytest.approx(3.0 / thickness(2.0), rel=1e-3)


def test_a_roof_that_becomes_thinner_converges_faster_than_with_means():
    """One mesh against a fine one: the error is that of the element, 1e-3 and less, not that of a mean."""
    scene = ks.Scene.load(MESHES / "tube.toml")
    values = {}
    for n in (3, 6, 20):
        mesh = scene.chart.parameter_mesh(n, n, ("cuts", "cuts", "end", "far"), (0, np.pi / 2), (0, 1))
        one = ks.Scene(
            mesh=mesh, chart=scene.chart, thickness="0.1*(1 + z)**2", material=scene.material,
            supports=[ks.Symmetry("cuts"), ks.Clamped("far")], loads=[ks.LineForce("end", (1e-6, 0, 0))],
            probes={"end": (1, 0, 0)},
        )  # fmt: skip
        values[n] = ks.solve(one, element="koiter", order=3, large_deflection=False).probe("end")["u"][0]
    errors = [abs(values[n] / values[20] - 1) for n in (3, 6)]
    assert errors[1] < 1e-3
    assert errors[0] > 4 * errors[1]
