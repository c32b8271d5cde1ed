"""Exact freedoms in axes of their own."""

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import rectangle

ANGLE = np.radians(30.0)
AXES = [[np.cos(ANGLE), np.sin(ANGLE), 0.0], [-np.sin(ANGLE), np.cos(ANGLE), 0.0], [0.0, 0.0, 1.0]]


def turned_panel():
    """A unit square turned by 30 degrees about z."""
    flat = rectangle(3)
    points = flat.points @ np.array(AXES)
    groups = {name: flat.edges[flat.groups[name].members] for name in ("left", "right", "bottom", "top")}
    return ks.Mesh.from_arrays(points, flat.triangles, groups)


def scene(supports, loads=(), **more):
    material = ks.Isotropic(E=200.0, nu=0.25)
    return ks.Scene(
        mesh=turned_panel(), thickness=0.1, material=material, supports=supports, loads=list(loads), **more
    )


def test_rollers_across_inclined_edges_let_the_panel_stretch_evenly():
    """Pulled along its own x: strain N / (E t) along, -nu of it across, whatever way the panel lies."""
    supports = [
        ks.Fixed("left", "xz", axes=AXES),
        ks.Fixed("bottom", "y", axes=AXES),
        ks.Fixed("right", "z"),
    ]
    pull = [ks.LineForce("right", tuple(np.array(AXES[0])))]
    result = ks.solve(scene(supports, pull), model="shell", large_deflection=False)
    own = result.fields["displacement"] @ np.array(AXES).T
    x = result.mesh.points @ np.array(AXES).T
    strain = 1.0 / (200.0 * 0.1)
    assert np.allclose(own[:, 0], strain * x[:, 0], atol=1e-10)
    assert np.allclose(own[:, 1], -0.25 * strain * x[:, 1], atol=1e-10)
    assert result.balance < 1e-9


def test_a_prescribed_motion_is_imposed_along_the_held_axis_only():
    supports = [
        ks.Fixed("left", "xyz", axes=AXES),
        ks.Fixed("right", "x", value=tuple(0.01 * np.array(AXES[0])), axes=AXES),
        ks.Fixed("right", "z"),
    ]
    result = ks.solve(scene(supports), model="shell")
    own = result.fields["displacement"] @ np.array(AXES).T
    right = np.isclose((result.mesh.points @ np.array(AXES).T)[:, 0], 1.0)
    assert np.allclose(own[right, 0], 0.01, atol=1e-12)
    assert np.abs(own[right, 1]).max() > 1e-4


@pytest.mark.parametrize(
    "axes", [[[1, 0, 0], [1, 1, 0], [0, 0, 1]], [[0, 0, 0]] * 3, "xyz", [[1, 0], [0, 1]]]
)
def test_axes_must_be_three_vectors_at_right_angles(axes):
    with pytest.raises(ks.InputError, match="axes"):
        ks.Fixed("left", "x", axes=axes)


def test_a_plate_refuses_axes():
    with pytest.raises(ks.InputError, match='model = "shell"'):
        ks.solve(scene([ks.Fixed("left", "zr", axes=AXES)], [ks.Pressure(1.0)]), model="plate")
