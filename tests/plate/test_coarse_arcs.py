"""Arcs of few straight edges: their tangents are rough, the supports on them must not be."""

import numpy as np
import pytest

import kshell as ks
from kshell.analysis.solve import solve
from kshell.mesh.mesh import Mesh
from tests.plate.plates import UNIT


def quarter_ring(inner: float, along: int, across: int) -> Mesh:
    radius = inner ** (1 - np.linspace(0, 1, across + 1))
    angle = np.linspace(0, np.pi / 2, along + 1)
    points = (radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)).reshape(-1, 2)
    number = np.arange(len(points)).reshape(across + 1, along + 1)
    a, b, c, d = (
        number[:-1, :-1].ravel(),
        number[1:, :-1].ravel(),
        number[1:, 1:].ravel(),
        number[:-1, 1:].ravel(),
    )
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])

    def line(nodes):
        return np.stack([nodes[:-1], nodes[1:]], axis=1)

    groups = {"outer": line(number[-1]), "x": line(number[:, 0]), "y": line(number[:, -1])}
    return Mesh.from_arrays(points, triangles, groups)


@pytest.mark.filterwarnings("ignore:the boundary turns")
@pytest.mark.parametrize(
    ("along", "deflection", "moment"), [(3, 4e-3, 3e-2), (4, 6e-4, 3e-2), (6, 6e-6, 5e-4), (12, 5e-8, 2e-5)]
)
def test_clamped_arc_that_meets_lines_of_symmetry(along, deflection, moment):
    """The edge moment survives at the corner although the rough tangent is not quite across the line."""
    scene = ks.Scene(
        mesh=quarter_ring(0.2, along, along),
        thickness=1.0,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("outer"), ks.Symmetry("x"), ks.Symmetry("y")],
        loads=[ks.Pressure(1.0)],
        probes={"inner": (0.2, 0, 0), "outer": (1, 0, 0)},
    )
    result = solve(scene, element="argyris")
    # w = C1 + C2 r^2 + C3 ln r + C4 r^2 ln r + r^4 / 64, free at r = 0.2, clamped at r = 1
    assert result.probes["inner"]["u"][2] == pytest.approx(0.01605127397524619, rel=deflection)
    assert result.probes["outer"]["M"][0] == pytest.approx(-0.121603968844506, rel=moment)
