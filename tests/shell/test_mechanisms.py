"""What can move without strains is refused, however thin, whatever acts and on any mesh."""

from __future__ import annotations

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.halve import halved
from kshell.mesh.mesh import Mesh
from tests.shell.shapes import joined, panel


def three_sheets() -> Mesh:
    """Of different directions, joined along the y axis; two of their free edges carry nothing."""
    angles = np.radians([0.0, 139.0, 253.0])
    parts = [panel((0, 0, 0), (np.cos(a), 0, np.sin(a)), (0, 1.2, 0), 3) for a in angles]
    mesh = joined(*parts)
    ends = mesh.points[mesh.edges]
    fold = (np.abs(ends[:, :, [0, 2]]).max(axis=(1, 2))) < 1e-9
    held = (np.abs(ends[:, :, 0] - 1.0).max(axis=1)) < 1e-9
    groups = {"fold": mesh.edges[fold], "held": mesh.edges[held], "all": mesh.triangles}
    return Mesh.from_arrays(mesh.points, mesh.triangles, groups)


@pytest.mark.parametrize("order", [1, 3, pytest.param(5, marks=pytest.mark.full)])
@pytest.mark.parametrize("load", ["pressure", "warmth"])
@pytest.mark.parametrize("finer", [False, True])
def test_sheets_on_a_hinge_are_a_mechanism(order: int, load: str, finer: bool) -> None:
    """Two sheets turn about the hinge; warmth drives nothing, and rounding moved them anywhere."""
    mesh = halved(three_sheets()) if finer else three_sheets()
    steel = ks.Isotropic(E=210e9, nu=0.3, expansion=1e-5)
    acts = ks.Pressure(10.0) if load == "pressure" else ks.Temperature(mean=20.0, gradient=1000.0)
    supports = [ks.Clamped("held"), ks.Hinge("fold")]
    scene = ks.Scene(mesh, thickness=0.003, material=steel, supports=supports, loads=[acts])
    with pytest.raises(ks.InputError, match="can move freely"):
        ks.solve(scene, large_deflection=False, order=order)


@pytest.mark.parametrize("thickness", [1e-1, 1e-3, 1e-4])
def test_thin_shells_that_are_held_are_none(thickness: float) -> None:
    scene = ks.Scene(
        three_sheets(),
        thickness=thickness,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.Clamped("held")],
        loads=[ks.Pressure(1e10 * thickness**3)],
        probes={"p": (np.cos(np.radians(139.0)), 0.6, np.sin(np.radians(139.0)))},
    )
    result = ks.solve(scene, large_deflection=False, order=3)
    assert result.balance < 1e-11 / thickness**2  # rounding of membrane forces beside moments
