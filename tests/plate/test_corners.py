"""Corners with infinite moments are named."""

import numpy as np
import pytest

import kshell as ks
from kshell.plate.corner_exponents import Star, least_exponent
from kshell.plate.corners import corner_angles
from tests.plate.plates import UNIT, disk, rectangle, solve

RHOMBUS = {"b": np.sin(np.pi / 6), "skew": 1 / np.tan(np.pi / 6)}


def l_shape(n):
    full = rectangle(2 * n)
    centre = full.points[full.triangles].mean(axis=1)
    keep = (centre[:, 0] < 0.5) | (centre[:, 1] < 0.5)
    mesh = ks.Mesh.from_arrays(full.points, full.triangles[keep])
    return ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"edge": mesh.edges[mesh.boundary_edges]})


def test_angles_of_corners():
    angles = np.degrees(sorted(corner_angles(rectangle(4, **RHOMBUS)).values()))
    assert np.allclose(angles, [30, 30, 150, 150])
    assert np.allclose(np.degrees(max(corner_angles(l_shape(2)).values())), 270)
    assert corner_angles(disk(4)) == {}


@pytest.mark.parametrize("element", ["morley", "argyris"])
def test_obtuse_supported_corners_are_named_and_clamped_ones_are_not(element):
    mesh = rectangle(4, **RHOMBUS)
    words = solve(mesh, [ks.SimplySupported("edge")], [ks.Pressure(1.0)], element).warnings
    assert len(words) == 1
    assert "2 obtuse supported corners" in words[0]
    assert "150 degrees" in words[0]
    assert solve(mesh, [ks.Clamped("edge")], [ks.Pressure(1.0)], element).warnings == []


def test_a_re_entrant_corner_is_named_with_its_place():
    words = solve(l_shape(2), [ks.Clamped("edge")], [ks.Pressure(1.0)]).warnings
    assert len(words) == 1
    assert "re-entrant corner: at (0.5, 0.5) the edges meet at 270 degrees" in words[0]


HOLDS = {"c": ks.Clamped, "s": ks.SimplySupported, "y": lambda on: ks.Fixed(on, "r"), "f": None}


@pytest.mark.parametrize("degrees", [50, 75, 90, 93, 118, 122, 150, 176])
@pytest.mark.parametrize("pair", ["cc", "ff", "ss", "yy", "cs", "cf", "sf", "sy", "fy", "cy"])
def test_corners_are_named_by_their_exponents(pair, degrees):
    """Those below 1.5, whatever holds the edges: at 93 degrees beside symmetry pi / (2 omega) mirrored, 2 - .968."""
    angle = np.radians(degrees)
    skewed = rectangle(2, b=np.sin(angle), skew=1 / np.tan(angle))
    held = [HOLDS[kind](on) for kind, on in zip(pair, ("bottom", "left"), strict=True) if HOLDS[kind]]
    words = solve(skewed, [*held, ks.Clamped("right"), ks.Clamped("top")], [ks.Pressure(1.0)]).warnings
    nu = UNIT["nu"]
    stiffness = (1.0, nu, 0.0, nu, 1.0, 0.0, 0.0, 0.0, (1 - nu) / 2)
    rays = [(kind in "cs", kind in "cy") for kind in pair]
    exponent = least_exponent(
        Star((angle,), tuple(h for h, _ in rays), tuple(t for _, t in rays), (stiffness,), closed=False)
    )
    at_corner = [w for w in words if "at (0, 0)" in w and "grow without bound" in w]
    assert len(at_corner) == (exponent < 1.5)
