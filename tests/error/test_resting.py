"""What is held is known to be at rest, at vertices and between them; what lies beside it is held by its interval."""

from __future__ import annotations

from typing import Any

import pytest

import kshell as ks
from tests.plate.plates import rectangle

UNIT = ks.Isotropic(E=12e6 * (1 - 0.3**2), nu=0.3)
PLACES = {  # of a parallelogram with the corners (0, 0), (1, 0), (1.3, 1), (.3, 1)
    "corner": (1.0, 0.0, 0.0),
    "clamped edge": (0.15, 0.5, 0.0),
    "supported edge": (0.6, 0.0, 0.0),
    "support": (1.3, 1.0, 0.0),
}


def solved(probes: dict[str, Any], **options: Any) -> ks.Result:
    supports = [ks.Clamped("left"), ks.SimplySupported("bottom"), ks.SimplySupported(PLACES["support"])]
    scene = ks.Scene(
        rectangle(4, 3, skew=0.3), thickness=0.01, material=UNIT, supports=supports, loads=[ks.Pressure(1.0)],
        probes=probes,
    )  # fmt: skip
    return ks.solve(scene, model="plate", large_deflection=False, **options)


@pytest.mark.parametrize(
    "options", [{"element": "argyris"}, *({"element": "hhj", "order": p} for p in (2, 3, 5))]
)
@pytest.mark.parametrize("place", PLACES)
def test_what_is_held_is_at_rest(place: str, options: dict[str, Any]) -> None:
    """And not within 0 or 1e31 of a rounded value."""
    result = solved({place: PLACES[place]}, **options)
    assert result.probe(place)["u"].tolist() == [0.0, 0.0, 0.0]
    assert result.error["probes"][place]["u"]["half_width"] == pytest.approx([0.0] * 3, abs=0.0)
    assert result.error["estimate"] == 0.0


def test_a_tolerance_of_what_is_held_is_met() -> None:
    result = solved({"edge": PLACES["clamped edge"]}, tolerance=1e-6)
    assert result.error["estimate"] == 0.0
    assert "why_not" not in result.error or "not reached" not in result.error["why_not"]


@pytest.mark.parametrize("order", [2, 3, 5])
@pytest.mark.parametrize("off", [1e-4, 1e-3, 1e-2])
def test_places_beside_supports_are_held(order: int, off: float) -> None:
    """The deflection between vertices is one of its triangle, which edges hold to its own error only."""
    probes = {"a": (0.15 + off, 0.5, 0.0), "b": (0.6, off, 0.0), "c": (0.9, off, 0.0)}
    fine = solved(probes, tolerance=1e-4)
    coarse = solved(probes, element="hhj", order=order)
    for name in probes:
        exact, found = fine.probe(name)["u"][2], coarse.probe(name)["u"][2]
        within = coarse.error["probes"][name]["u"]["half_width"][2]
        known = fine.error["probes"][name]["u"]["half_width"][2]
        assert abs(exact - found) <= within + known
