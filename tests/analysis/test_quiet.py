"""What is right is answered without a warning."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import disk, rectangle

ROOT = Path(__file__).parents[2]
STEEL = ks.Isotropic(E=210e9, nu=0.3, expansion=1.2e-5)
FREE = [ks.Fixed((1, 0, 0), "xyz"), ks.Fixed((-1, 0, 0), "yz"), ks.Fixed((0, 1, 0), "z")]


def quietly(scene, **options):
    """The result, any warning being an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", ks.KshellWarning)
        return ks.solve(scene, error="off", **options)


def test_the_first_example_of_the_readme(monkeypatch):
    monkeypatch.chdir(ROOT)
    code = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    lines = code[1].splitlines()
    until = next(k for k, line in enumerate(lines) if line.startswith("result = "))
    names: dict = {}
    exec("\n".join(lines[:until]), names)
    result = quietly(names["scene"])
    assert result.model["kind"] == "plate"
    assert result.warnings == []


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    ("load", "options"),
    [
        (ks.Temperature(mean=100), {"model": "shell"}),
        (ks.Temperature(gradient=1e3), {"model": "shell"}),
        (ks.Temperature(gradient=1e3), {"model": "plate"}),
    ],
)
def test_a_free_disk_that_is_heated_is_in_balance(order, load, options):
    scene = ks.Scene(mesh=disk(4, order), thickness=0.01, material=STEEL, supports=FREE, loads=[load])
    result = quietly(scene, large_deflection=False, **options)
    assert result.balance < 1e-9


@pytest.mark.parametrize("element", ["argyris", "morley", "hhj", "koiter"])
def test_a_plate_that_is_only_lifted_and_tilted_is_in_balance_and_not_called_bent(element):
    lifted = ks.SimplySupported("edge", value=(0.0, 0.0, "1 + 0.01*x"))
    scene = ks.Scene(mesh=rectangle(4), thickness=0.01, material=STEEL, supports=[lifted])
    options = {"large_deflection": False} if element == "koiter" else {}
    result = quietly(scene, element=element, model="shell" if element == "koiter" else "plate", **options)
    assert result.balance < 1e-6
    assert np.ptp(result.fields["displacement"][:, 2]) == pytest.approx(0.01, rel=1e-6)


def test_what_bends_while_it_is_lifted_is_still_called_bent():
    bent = ks.SimplySupported("edge", value="1 + 0.1*x*x")
    scene = ks.Scene(mesh=rectangle(4), thickness=0.01, material=STEEL, supports=[bent])
    with pytest.warns(ks.KshellWarning, match="times the thickness"):
        ks.solve(scene, error="off")


@pytest.mark.parametrize("element", ["argyris", "morley", "hhj"])
def test_a_plate_that_sinks_into_its_bedding_is_neither_bent_nor_strained(element):
    scene = ks.Scene(
        mesh=rectangle(4),
        thickness=0.01,
        material=STEEL,
        supports=[ks.Elastic("plate", 1e3)],
        loads=[ks.Pressure(100.0)],
    )
    result = quietly(scene, element=element)
    assert result.fields["displacement"][:, 2] == pytest.approx(np.full(len(result.points), 0.1), rel=1e-6)
    assert result.energies["springs"] == pytest.approx(0.5 * 1e3 * 0.1**2, rel=1e-6)
    assert abs(result.energies["bending"]) < 1e-6 * result.energies["springs"]
