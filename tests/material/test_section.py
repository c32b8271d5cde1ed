import numpy as np
import pytest

import kshell as ks
from kshell.material.section import BOTTOM, TOP, plate_section
from tests.scene.fabricated import square_mesh

STEEL = ks.Isotropic(E=210e9, nu=0.3, density=7850)
CARBON = ks.Orthotropic(E1=140.0, E2=10.0, nu12=0.3, G12=5.0, density=1.6)


@pytest.fixture(scope="module")
def mesh():
    return square_mesh(4)


def centroids(mesh):
    return np.arange(len(mesh.triangles)), mesh.points[mesh.triangles].mean(axis=1)[:, None]


def test_uniform_plate(mesh):
    section = plate_section(mesh, 0.01, STEEL)
    assert section.constant_per_triangle
    D = 210e9 * 0.01**3 / 12 / (1 - 0.09)
    bending = section.bending_per_triangle()
    assert bending.shape == (32, 3, 3)
    np.testing.assert_allclose(bending[5], D * np.array([[1, 0.3, 0], [0.3, 1, 0], [0, 0, 0.35]]), rtol=1e-12)
    np.testing.assert_allclose(section.mass(*centroids(mesh)), 78.5)


def test_stress_is_twelve_moment_z_over_thickness_cubed(mesh):
    section = plate_section(mesh, "0.1 + 0.05*x", STEEL)
    triangles, points = centroids(mesh)
    curvature = np.array([0.3, -0.2, 0.7])
    moment = -section.bending(triangles, points) @ curvature
    t = section.thickness(triangles, points)[..., None]
    top, bottom = (-section.stress(face, triangles, points)[1] for face in (TOP, BOTTOM))
    np.testing.assert_allclose(top @ curvature, 6 * moment / t**2, rtol=1e-12)
    np.testing.assert_allclose(bottom @ curvature, -6 * moment / t**2, rtol=1e-12)


def test_varying_thickness(mesh):
    triangles, points = centroids(mesh)
    by_text = plate_section(mesh, "0.1*(1 + x*y)", STEEL)
    by_function = plate_section(mesh, lambda x, y, z: 0.1 * (1 + x * y), STEEL)
    assert not by_text.constant_per_triangle
    expected = 0.1 * (1 + points[..., 0] * points[..., 1])
    for section in (by_text, by_function):
        np.testing.assert_allclose(section.thickness(triangles, points), expected)
    with pytest.raises(ValueError, match="varies"):
        by_text.bending_per_triangle()


def test_thickness_by_group(mesh):
    triangles, points = centroids(mesh)
    section = plate_section(mesh, {"west": 0.1, "east": 0.2}, STEEL)
    assert section.constant_per_triangle
    expected = np.where(points[..., 0] < 0.5, 0.1, 0.2)
    np.testing.assert_allclose(section.thickness(triangles, points), expected)
    np.testing.assert_allclose(
        section.bending_per_triangle()[:, 0, 0], 210e9 * expected[:, 0] ** 3 / 12 / 0.91, rtol=1e-12
    )
    mixed = plate_section(mesh, {"west": "0.1 + x", "east": lambda x, y, z: 0.3 + 0 * x}, STEEL)
    np.testing.assert_allclose(
        mixed.thickness(triangles[::-1], points[::-1]),
        np.where(points[..., 0] < 0.5, 0.1 + points[..., 0], 0.3)[::-1],
    )


def test_laminate(mesh):
    triangles, points = centroids(mesh)
    section = plate_section(mesh, layers=[ks.Layer(CARBON, 1.0, a) for a in (0, 90, 0)])
    assert section.constant_per_triangle
    assert section.bending(triangles, points).shape == (32, 1, 3, 3)
    np.testing.assert_allclose(section.thickness(triangles, points), 3.0)
    np.testing.assert_allclose(section.mass(triangles, points), 4.8)
    top, bottom = (-section.stress(face, triangles, points)[1] for face in (TOP, BOTTOM))
    np.testing.assert_allclose(top[0, 0], -1.5 * CARBON.plane_stress())
    np.testing.assert_allclose(bottom, -top)
    single = plate_section(mesh, layers=[ks.Layer(CARBON, 2.0, 30)])
    alone = plate_section(mesh, 2.0, ks.Orthotropic(E1=140.0, E2=10.0, nu12=0.3, G12=5.0, angle=30))
    np.testing.assert_allclose(single.bending_per_triangle(), alone.bending_per_triangle(), atol=1e-12)


@pytest.mark.parametrize(
    ("thickness", "words"),
    [
        ({"west": 0.1}, ["16 triangles belong to none", "one at (", "west, east, plate"]),
        ({"plate": 0.1, "east": 0.2}, ['"plate" and "east" overlap', "one at ("]),
        ({"west": 0.1, "eastt": 0.2}, ["thickness", "'eastt'", "'east'"]),
        ({"west": 0.1, "left": 0.2}, ["thickness", "left"]),
        ({"west": 0.1, "east": "x - 0.9"}, ['"east"', '"x - 0.9" is -0.4', "> 0"]),
        ("0.5 - x", ['"0.5 - x" is -0.5 at (1, ', "> 0"]),
        ("log(x)", ["-inf at (0, "]),
        (lambda x, y, z: x / 0, ["finite"]),
    ],
)
def test_impossible_thickness_is_refused_with_the_place(mesh, thickness, words):
    with pytest.raises(ks.InputError) as caught:
        plate_section(mesh, thickness, STEEL)
    for word in words:
        assert word in str(caught.value)


def test_unsymmetric_laminates_are_refused(mesh):
    with pytest.raises(ks.InputError, match="not symmetric"):
        plate_section(mesh, layers=[ks.Layer(CARBON, 1.0, a) for a in (0, 90)])
