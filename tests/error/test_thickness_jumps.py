"""A thickness that jumps inside triangles: intervals hold the plate on a mesh that follows the step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.elements.quadrature import triangle_rule
from kshell.error.missed_stiffness import divided
from kshell.mesh.mesh import Mesh
from tests.plate.plates import rectangle

UNIT = ks.Isotropic(E=12e6 * (1 - 0.3**2), nu=0.3)
SUPPORTS: dict[str, list[Any]] = {
    "clamped on the left": [ks.Clamped("left")],
    "supported": [ks.SimplySupported(on) for on in ("left", "right", "top", "bottom")],
}
AT = 0.37


def solved(mesh: Mesh, thickness: Any, supports: list[Any], **options: Any) -> ks.Result:
    content: dict[str, Any] = {"supports": supports, "loads": [ks.Pressure(1.0)]}
    scene = ks.Scene(mesh, thickness=thickness, material=UNIT, probes={"q": (0.8, 0.3, 0)}, **content)
    return ks.solve(scene, model="plate", large_deflection=False, **options)


def following(ratio: float, supports: list[Any]) -> tuple[float, float]:
    """Energy and deflection of the probe, of a mesh with edges along the step."""
    mesh = rectangle(6)
    x = mesh.points[:, 0]
    points = mesh.points.copy()
    points[:, 0] = np.where(x < 0.5, 2 * AT * x, AT + 2 * (1 - AT) * (x - 0.5))
    thin = points[mesh.triangles, 0].mean(axis=1) < AT
    lines = {name: group for name, group in mesh.groups.items() if group.dimension == 1}
    groups = {name: mesh.edges[group.members] for name, group in lines.items()}
    groups |= {"thin": mesh.triangles[thin], "thick": mesh.triangles[~thin]}
    whole = Mesh.from_arrays(points, mesh.triangles, groups)
    thickness = {"thin": 0.01, "thick": 0.01 * ratio}
    energy = solved(whole, thickness, supports, tolerance=1e-4, quantity="energy").strain_energy
    return energy, solved(whole, thickness, supports, tolerance=1e-4).probe("q")["u"][2]


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("ratio", [1.3, 0.4])
@pytest.mark.parametrize("supports", SUPPORTS)
def test_intervals_hold_a_step(supports: str, ratio: float) -> None:
    held = SUPPORTS[supports]
    energy, deflection = following(ratio, held)

    def thickness(x: Any, y: Any, z: Any) -> Any:
        return 0.01 * np.where(x > AT, ratio, 1.0)

    for n, options in ((2, {}), (4, {}), (8, {}), (4, {"tolerance": 1e-2})):
        result = solved(rectangle(n), thickness, held, element="argyris", **options)
        found, within = result.error["energy"], result.error["probes"]["q"]["u"]
        assert within["kind"] == found["kind"] == "estimated"
        assert found["lower"] - 1e-4 * energy <= energy <= found["upper"] + 1e-4 * energy, (n, options)
        off = abs(result.probe("q")["u"][2] - deflection)
        assert off <= within["half_width"][2] + 1e-4 * abs(deflection), (n, options)


def test_a_smooth_thickness_is_integrated() -> None:
    """Nothing is added: the interval is that of residuals alone, and of a linear thickness as narrow as before."""
    held = SUPPORTS["supported"]
    linear = solved(rectangle(4), lambda x, y, z: 0.01 * (1 + 1e-9 * x), held, element="argyris")
    same = solved(rectangle(4), 0.01, held, element="argyris")
    for name in ("lower", "upper"):
        assert linear.error["energy"][name] == pytest.approx(same.error["energy"][name], rel=1e-6)


@pytest.mark.parametrize("parts", [1, 2, 4])
def test_divided_rules_integrate_what_they_are_for(parts: int) -> None:
    xi, w = divided(*triangle_rule(6), parts)
    assert w.sum() == pytest.approx(0.5)
    assert ((xi >= 0) & (xi.sum(axis=1) <= 1)[:, None]).all()
    assert w @ (xi[:, 0] ** 4 * xi[:, 1] ** 2) == pytest.approx(
        24 * 2 / 40320, rel=1e-12
    )  # i! j! / (i + j + 2)!
