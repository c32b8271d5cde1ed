"""Warnings of what no structure does: loads that kept their direction, motions and strains beyond all theory."""

import re
import warnings

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import rectangle

E = 1e6


def strip(load, **options):
    """A cantilever 12 x 1 of thickness 0.1, EI = E t^3 / 12 per width."""
    mesh = rectangle(12, 1, 12.0, 1.0)
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.1,
        material=ks.Isotropic(E=E, nu=0.0),
        supports=[ks.Clamped("left")],
        loads=[load],
        solve={"error": "off", **options},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return ks.solve(scene)


def said(result, words):
    return [warning for warning in result.warnings if words in warning]


def test_a_pressure_that_keeps_its_direction_is_said_with_the_turn():
    stiffness = E * 0.1**3 / 12
    load = 2.0 * stiffness / 12**3
    dead = strip(ks.Pressure(load), large_deflection=True)
    (words,) = said(dead, "keeps the direction it had at rest")
    mean, most = map(int, re.findall(r"(\d+) degrees in the mean, (\d+) at most", words)[0])
    tip = np.degrees(np.linalg.norm(dead.fields["rotation"], axis=1).max())
    assert most == pytest.approx(tip, abs=3)
    assert 0.5 * most < mean < most
    assert not said(strip(ks.Pressure(load, follower=True), large_deflection=True), "keeps the direction")
    assert not said(strip(ks.Traction((0, 0, load)), large_deflection=True), "keeps the direction")
    assert not said(strip(ks.Pressure(0.05 * load), large_deflection=True), "keeps the direction")
    assert not said(strip(ks.Pressure(load), large_deflection=False), "keeps the direction")


def test_displacements_beyond_the_size_are_no_linear_answer():
    """p L^4 / 8 EI = 2,278 on a length of 12."""
    stiffness = E * 0.1**3 / 12
    load = 2278 * 8 * stiffness / 12**4
    result = strip(ks.Pressure(load), large_deflection=False, model="plate")
    (words,) = said(result, "beyond any linear theory")
    assert "times the size of the structure, 12" in words
    assert not said(strip(ks.Pressure(1e-4 * load), large_deflection=False), "linear theory")


@pytest.mark.parametrize("large", [True, False])
def test_strains_that_no_linear_material_bears(large):
    pulled = strip(ks.LineForce("right", (E * 0.1 * 0.8, 0, 0)), large_deflection=large)
    assert len(said(pulled, "more than any material bears")) == 1
    assert not said(strip(ks.LineForce("right", (E * 0.1 * 0.01, 0, 0)), large_deflection=large), "strains")


def test_a_load_case_in_which_the_pressure_rests_says_nothing_of_it():
    stiffness = E * 0.1**3 / 12
    scene = ks.Scene(
        mesh=rectangle(12, 1, 12.0, 1.0),
        thickness=0.1,
        material=ks.Isotropic(E=E, nu=0.0),
        supports=[ks.Clamped("left")],
        loads=[
            ks.Pressure(2.0 * stiffness / 12**3, name="wind"),
            ks.Traction((0, 0, 2.0 * stiffness / 12**3), name="snow"),
        ],
        cases=[ks.Case("a", ["wind"]), ks.Case("b", ["snow"])],
        solve={"large_deflection": True, "error": "off"},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cases = ks.solve(scene).cases
    assert said(cases["a"], "keeps the direction")
    assert not said(cases["b"], "keeps the direction")
