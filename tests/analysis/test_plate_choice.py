"""Which element and order a tolerance takes on plates."""

from __future__ import annotations

import dataclasses

import pytest

import kshell as ks
from kshell.mesh.mesh import Mesh
from tests.plate.hhj_cases import MATERIAL, l_shape, square
from tests.plate.plates import EGG_LOAD, annulus, disk, egg, rectangle


def clamped(mesh: Mesh, load: float | str = 1.0, **probes: tuple[float, float, float]) -> ks.Scene:
    return ks.Scene(
        mesh,
        thickness=1.0,
        material=MATERIAL,
        supports=[ks.Clamped("edge")],
        loads=[ks.Pressure(load)],
        probes=probes,
        solve={"large_deflection": False},
    )


def model(scene: ks.Scene, tolerance: float, **options: object) -> tuple[str, int, list[str]]:
    found = ks.solve(scene, tolerance=tolerance, **options)
    assert found.error["estimate"] <= tolerance
    return found.model["element"], found.model["order"], found.model["reasons"]


@pytest.mark.parametrize(("tolerance", "order"), [(1e-3, 5), (1e-6, 6), (1e-9, 8)])
def test_curved_edges_are_of_hhj_elements_whose_order_is_that_of_the_tolerance(tolerance, order):
    scene = clamped(egg(6), EGG_LOAD, centre=(0.0, 0.0, 0.0))
    scene = scene if tolerance > 1e-5 else clamped(disk(2), "exp(x)*cos(3*y)", centre=(0.0, 0.0, 0.0))
    element, found, why = model(scene, tolerance)
    assert (element, found) == ("hhj", order)
    assert [words for words in why if words.startswith("element")] == [
        "element hhj: with curved edges it reaches a tolerance with the least time"
    ]
    assert any(f"order {order}: for a tolerance of {tolerance:g}" in words for words in why)


def test_straight_edges_keep_their_guaranteed_bounds():
    result = ks.solve(clamped(square(2), centre=(0.5, 0.5, 0.0)), tolerance=1e-3)
    assert result.model["element"] == "argyris"
    assert result.error["kind"] == "guaranteed"


def test_straight_edges_with_nodes_in_their_middle_are_answered_after_a_look_at_large_deflections():
    plane = ks.geometry.Plane().mesh(3, 3, u_range=(0, 1), v_range=(0, 1), order=2, names=("edge",) * 4)
    scene = dataclasses.replace(clamped(plane, 1e-3, centre=(0.5, 0.5, 0.0)), solve={})
    found, other = (ks.solve(scene, tolerance=1e-3, element=element) for element in ("auto", "argyris"))
    assert not any("as asked for" in words for words in found.model["reasons"])
    assert sum(words.startswith("kind ") for words in found.model["reasons"]) == 1
    w = other.probe("centre")["u"][2]
    assert found.probe("centre")["u"][2] == pytest.approx(w, rel=2e-3)


def test_words_of_an_order_have_whole_numbers():
    found = ks.solve(clamped(square(2), centre=(0.5, 0.5, 0.0)), element="hhj", error="off")
    assert any("triangles, few elements" in words and ".0" not in words for words in found.model["reasons"])


def test_what_is_named_stays():
    scene = clamped(disk(2), centre=(0.0, 0.0, 0.0))
    assert model(scene, 1e-3, element="argyris")[0] == "argyris"
    assert model(scene, 1e-3, element="hhj", order=4)[:2] == ("hhj", 4)
    assert model(clamped(square(2), centre=(0.5, 0.5, 0.0)), 1e-3, element="hhj")[:2] == ("hhj", 5)


def test_what_hhj_elements_do_not_have_is_left_to_argyris():
    scene = dataclasses.replace(clamped(disk(2), centre=(0.0, 0.0, 0.0)), thickness="1 + 0.1*x")
    assert model(scene, 1e-3)[0] == "argyris"


def test_corners_keep_the_order_moderate():
    scene = clamped(l_shape(1), near=(0.25, 0.25, 0.0))
    _, order, why = model(scene, 1e-6, element="hhj")
    assert order == 6
    assert any("corners where moments grow" in words for words in why)


def test_the_ring_is_known_as_well_as_it_says():
    """Clamped outside, free inside, under unit pressure: w = C1 + C2 r^2 + C3 ln r + C4 r^2 ln r + r^4 / 64."""
    made = ks.Scene(
        mesh=annulus(2, 12, 0.2),
        thickness=1.0,
        material=MATERIAL,
        supports=[ks.Clamped("outer")],
        loads=[ks.Pressure(1.0)],
        probes={"inner": (0.2, 0, 0)},
        solve={"large_deflection": False},
    )
    for tolerance in (1e-3, 1e-7):
        found = ks.solve(made, tolerance=tolerance)
        off = abs(found.probe("inner")["u"][2] / 0.01605127397524619 - 1)
        assert off <= found.error["estimate"] + 1e-12 <= tolerance


def test_a_mesh_of_order_2_with_straight_edges_has_the_bounds_of_one_of_order_1():
    straight = rectangle(4)
    middles = straight.points[straight.edges].mean(axis=1)
    values = []
    for mesh in (straight, ks.Mesh(straight.points, straight.triangles, middles, straight.groups)):
        scene = ks.Scene(
            mesh=mesh,
            thickness=0.01,
            material=ks.Isotropic(E=210e9, nu=0.3),
            supports=[ks.SimplySupported("edge")],
            loads=[ks.Pressure("1 + x")],
            probes={"centre": (0.5, 0.5, 0.0)},
        )
        result = ks.solve(scene, tolerance=1e-4, large_deflection=False)
        assert result.error["probes"]["centre"]["u"]["kind"] == "guaranteed"
        values.append(result.probe("centre")["u"][2])
    assert values[1] == pytest.approx(values[0], rel=1e-9)
