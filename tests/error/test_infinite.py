"""The energy of a moment at a point, and of a force in the plane of a shell, is infinite: no mesh tells it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.error.in_plane import FACTORS, pushed
from kshell.mesh.mesh import Mesh
from kshell.scene.structure import resolve
from kshell.shell.koiter.model import KoiterModel
from tests.plate.plates import rectangle
from tests.shell.shapes import joined

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


def sheet(n: int, loads: list[Any], supports: list[Any] | None = None, **given: Any) -> ks.Scene:
    content: dict[str, Any] = {"supports": supports or [ks.Clamped("left")], "thickness": 0.01} | given
    mesh = content.pop("mesh", rectangle(n))
    return ks.Scene(
        mesh,
        material=ks.Isotropic(E=1e9, nu=0.3),
        loads=loads,
        solve={"model": "shell", "order": 2, "large_deflection": False},
        **content,
    )


def shell_model(of: ks.Scene) -> KoiterModel:
    return KoiterModel(resolve(of, of.read_mesh()), 2)


PUSH = ks.PointForce((1.0, 0.5, 0.0), (1e3, 0.0, 0.0))


@pytest.mark.parametrize(("at", "least"), [((1.0, 0.5, 0.0), 0.98), ((0.5, 0.5, 0.0), 0.85)])
def test_forces_in_the_plane_at_points(at: Any, least: float) -> None:
    """Every halving adds to the energy what the law says; of a mesh that ends nowhere it is infinite."""
    results = [
        ks.solve(
            sheet(n, [ks.PointForce(at, (1e3, 0.0, 0.0))], probes={"p": at, "q": (1.0, 0.0, 0.0)}),
            error="off",
        )
        for n in (4, 8)
    ]
    model = shell_model(sheet(8, [ks.PointForce(at, (1e3, 0.0, 0.0))]))
    (found,) = pushed(model, model.solve(), None)
    halving = found.energy / FACTORS * np.log(2.0)
    assert least * halving < results[1].strain_energy - results[0].strain_energy < 1.01 * halving
    result = ks.solve(sheet(8, [ks.PointForce(at, (1e3, 0.0, 0.0))], probes={"p": at}))
    assert "energy" not in result.error
    assert "p" not in result.error["probes"]
    assert "in the plane of the shell" in result.error["why_not"]
    elsewhere = ks.solve(sheet(8, [ks.PointForce(at, (1e3, 0.0, 0.0))], probes={"q": (1.0, 0.0, 0.0)}))
    assert elsewhere.error["probes"]["q"]["u"]["kind"] == "estimated"


@pytest.mark.parametrize("quantity", ["energy", "p"])
def test_no_mesh_reaches_a_tolerance_of_it(quantity: str) -> None:
    of = sheet(4, [PUSH], probes={"p": (1.0, 0.5, 0.0)})
    result = ks.solve(of, tolerance=0.01, quantity=quantity)
    assert len(result.error["levels"]) == 1
    assert any("has no interval; a force at a point" in words for words in result.warnings)


def test_forces_along_the_normal_and_held_ones_are_finite() -> None:
    for loads, supports in (
        ([ks.PointForce((1.0, 0.5, 0.0), (0.0, 0.0, 1.0))], None),
        ([PUSH, ks.Pressure(1.0)], [ks.Clamped(["left", "right"])]),
    ):
        of = sheet(4, loads, supports)
        model = shell_model(of)
        assert pushed(model, model.solve(), None) == []
        assert "energy" in ks.solve(of).error


def test_a_little_in_the_plane_widens_by_what_it_can_add() -> None:
    both = [ks.PointForce((1.0, 0.5, 0.0), (0.3, 0.0, 1.0))]
    of = sheet(4, both, probes={"p": (1.0, 0.5, 0.0)})
    model = shell_model(of)
    (found,) = pushed(model, model.solve(), None)
    assert found.energy == pytest.approx(0.5 * FACTORS * 2.0 / np.pi / 1e7 * 0.09, rel=1e-9)
    result = ks.solve(of)
    alone = ks.solve(sheet(4, [ks.PointForce((1.0, 0.5, 0.0), (0.0, 0.0, 1.0))]))
    width = [r.error["energy"]["upper"] - r.error["energy"]["lower"] for r in (result, alone)]
    assert width[0] == pytest.approx(width[1] + 2.0 * found.energy, rel=1e-3)


def test_folds_end_it_at_the_thickness() -> None:
    """Across a fold the other sheet bends; along it both stretch, and nothing ends that."""
    turned = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    flat = rectangle(4)
    mesh = joined(*((flat.points[:, :2] @ axes, flat.triangles) for axes in turned))
    held = mesh.edges[(np.abs(mesh.points[mesh.edges][:, :, 0] - 1.0) < 1e-9).all(axis=1)]
    mesh = Mesh.from_arrays(mesh.points, mesh.triangles, {"held": held})
    for force, endless in (((1.0, 0.0, 1.0), False), ((0.0, 1.0, 0.0), True)):
        of = sheet(4, [ks.PointForce((0.0, 0.5, 0.0), force)], [ks.Clamped("held")], mesh=mesh)
        model = shell_model(of)
        (found,) = pushed(model, model.solve(), None)
        assert (found.endless > 0.0) == endless
        assert found.displacement > 0.0


def test_reactions_of_points_in_the_plane() -> None:
    """Two pins that carry a sheet sink into it; such as keep it in its place alone carry nothing."""
    pins = [ks.Fixed((0.0, 0.0, 0.0), "xyz"), ks.Fixed((1.0, 0.0, 0.0), "yz"), ks.Fixed((0.0, 1.0, 0.0), "z")]
    probes = {"p": (1.0, 0.5, 0.0)}
    carried = ks.solve(sheet(4, [ks.Traction((0.0, 100.0, 0.0))], pins, probes=probes))
    assert "reaction of a support" in carried.error["why_not"]
    assert not carried.error["probes"]
    kept = ks.solve(sheet(4, [ks.Pressure(1.0)], pins, probes=probes))
    assert "energy" in kept.error
    assert "p" in kept.error["probes"]
