"""The energy of a moment at a point is infinite: it has no interval, and no mesh reaches a tolerance of it."""

from __future__ import annotations

from typing import Any

import pytest

import kshell as ks
from tests.plate.plates import rectangle

MOMENT = (1.0, 0.5, 0.0)
ELEMENTS = [{"element": "argyris"}, {"element": "hhj"}, {"element": "morley"}, {"model": "shell", "order": 3}]


def clamped(loads: list[Any], **given: Any) -> ks.Scene:
    content = {"supports": [ks.Clamped(["left", "right"])]} | given
    material = ks.Isotropic(E=1e9, nu=0.3)
    return ks.Scene(rectangle(4), thickness=0.01, material=material, loads=loads, **content)


@pytest.mark.parametrize("options", ELEMENTS, ids=["argyris", "hhj", "morley", "koiter"])
def test_moments_at_points(options: dict[str, Any]) -> None:
    scene = clamped([ks.PointMoment((0.5, 0.5, 0.0), MOMENT)], probes={"p": (0.75, 0.25, 0.0)})
    for tolerance in ({}, {"tolerance": 0.1, "quantity": "energy"}):
        result = ks.solve(scene, large_deflection=False, **options, **tolerance)
        assert "energy" not in result.error
        assert "(0.5, 0.5), is infinite" in result.error["why_not"]
    assert result.error["estimate"] is None
    assert len(result.error["levels"]) == 1
    assert any("has no interval" in words for words in result.warnings)
    probe = ks.solve(scene, large_deflection=False, tolerance=0.1, quantity="p", **options)
    assert probe.error["estimate"] <= 0.1


def test_cases_without_it_have_an_interval() -> None:
    loads = [ks.PointMoment((0.5, 0.5, 0.0), MOMENT, name="m"), ks.Pressure(1.0, name="p")]
    scene = clamped(loads, cases=[ks.Case("with", ["m", "p"]), ks.Case("without", ["p"])])
    cases = ks.solve(scene, large_deflection=False).cases
    assert "energy" not in cases["with"].error
    assert "energy" in cases["without"].error


def test_moments_on_rigid_links_have_one() -> None:
    link = ks.RigidLink("right", (1.0, 0.5, 0.0), "hub")
    scene = clamped([ks.PointMoment("hub", MOMENT)], supports=[ks.Clamped("left"), link])
    assert "energy" in ks.solve(scene, large_deflection=False, model="shell").error
