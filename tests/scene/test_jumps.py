"""Loads that jump inside triangles: what is missed is told, and about as much as it is."""

import re

import numpy as np
import pytest

import kshell as ks
from kshell.scene.jumps import rough_words
from tests.scene.fabricated import square_mesh

EVERY = np.arange(128)


@pytest.mark.parametrize(
    "value", [3.0, "1 + x", "sin(pi*x)*sin(pi*y)", "exp(-3*x)", "1*(x > 0.5)", "1/(0.3 + x)"]
)
def test_smooth_loads_and_jumps_along_edges_are_silent(value):
    assert rough_words(ks.Pressure(value), square_mesh(8), EVERY) == ""


@pytest.mark.parametrize(
    "value", ["1*(x > 0.31)", "1*(x > 0.3)*(x < 0.45)*(y > 0.41)", "exp(-8000*((x-0.4)**2+(y-0.4)**2))"]
)
def test_jumps_and_peaks_inside_are_told(value):
    for load in (ks.Pressure(value), ks.Traction((0, value, 0)), ks.Snow(value)):
        words = rough_words(load, square_mesh(8), EVERY)
        assert "changes faster inside triangles" in words


def test_what_is_told_is_about_what_is_missed():
    scene = ks.Scene(
        mesh=square_mesh(8),
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.SimplySupported(["left", "right", "bottom", "top"])],
        loads=[ks.Pressure("1*(x > 0.31)*(y > 0.43)")],
    )
    result = ks.solve(scene, large_deflection=False, error="off")
    (words,) = [words for words in result.warnings if "inside triangles" in words]
    told = float(re.search(r"about ([\d.e-]+) %", words)[1]) / 100
    total = -sum(reaction["force"][2] for reaction in result.reactions.values())
    missed = abs(total / (0.69 * 0.57) - 1)
    assert missed < 5 * told
    assert told < 0.2


def test_loads_in_time_and_of_heat_are_left_alone():
    assert rough_words(ks.Temperature(gradient="1*(x > 0.31)", expansion=1e-5), square_mesh(8), EVERY) == ""
    assert rough_words(ks.Pressure("0*x"), square_mesh(8), EVERY) == ""
