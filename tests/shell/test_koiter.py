"""Properties of the energy that hold for every mesh: zero modes, rigid motion, derivatives."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from kshell.shell.koiter.edges import edge_angles, turn_directors
from kshell.shell.koiter.energy import Koiter, energy_density
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section
from tests.shell.shapes import SHAPES, cylinder, patch, rectangle

ORDERS = (1, 2, 3, 4)
STIFF = Section.isotropic(1.0, 0.3, 0.1)
LAMINATE = Section.from_stiffness(
    np.array([[3, 1, 0.1], [1, 2, 0.2], [0.1, 0.2, 0.8]]),
    1e-2 * np.array([[3, 0.5, 0.2], [0.5, 2, 0.1], [0.2, 0.1, 0.8]]),
    coupling=5e-2 * np.array([[1, 0.3, 0.0], [0.3, -1, 0.1], [0.0, 0.1, 0.2]]),
    angle=0.3,
)


def bent(q):
    """A surface curved in both directions, from points of the plane."""
    return np.column_stack([np.sin(q[:, 0]), q[:, 1], np.cos(q[:, 0]) + 0.1 * q[:, 1] ** 2])


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("shape", SHAPES)
def test_six_motions_without_energy(shape, order):
    koiter = Koiter(Surface(SHAPES[shape](), order), STIFF)
    eigenvalues = np.linalg.eigvalsh(koiter.linear_stiffness().toarray())
    assert np.all(np.abs(eigenvalues[:6]) < 1e-12 * eigenvalues[-1])
    assert eigenvalues[6] > 1e-7 * eigenvalues[-1]


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("shape", ["patch", "box", "moebius"])
def test_rigid_rotation_of_two_radians_leaves_no_energy(shape, order):
    surface = Surface(SHAPES[shape](), order)
    koiter = Koiter(surface, STIFF)
    rotation = scipy.linalg.expm(np.cross(np.eye(3), 2.0 * np.array([2.0, -1.0, 2.0]) / 3))
    x = np.zeros(surface.unknowns)
    u = surface.nodes @ rotation.T - surface.nodes + [1.0, 2.0, -3.0]
    x[: surface.rotation_start] = u.ravel()
    # the rotations of the edges follow from the angle on one side; the other sides must agree
    angle = edge_angles(surface, koiter.rest, u) * -np.repeat(surface.edge_sign, order, axis=1)
    x[surface.rotation_start + surface.triangle_rotations] = angle
    stretched = x.copy()
    stretched[: surface.rotation_start] += 0.1 * surface.nodes.ravel()
    scale = koiter.energy(stretched).value
    state = koiter.energy(x, 1)
    assert abs(state.value) < 1e-12 * scale
    # and the same after the directors took up the rotation
    x, directors = turn_directors(surface, koiter.rest, x)
    assert np.abs(x[surface.rotation_start :]).max() == 0.0
    assert abs(koiter.energy(x, 0, directors).value) < 1e-12 * scale


@settings(max_examples=4, deadline=None, derandomize=True)
@given(seed=st.integers(0, 1000), order=st.sampled_from(ORDERS), laminate=st.booleans())
def test_derivatives_against_finite_differences(seed, order, laminate):
    rng = np.random.default_rng(seed)
    koiter = Koiter(Surface(patch(), order, bent), LAMINATE if laminate else STIFF, block=3)
    n = koiter.surface.unknowns
    # a finite deformation, smooth enough for finite differences, from turned directors
    smooth = np.zeros(n)
    smooth[: koiter.surface.rotation_start] = (
        0.3 * np.sin(koiter.surface.nodes @ rng.normal(size=(3, 3)) + rng.normal(size=3)).ravel()
    )
    x, directors = turn_directors(koiter.surface, koiter.rest, smooth + 0.01 * rng.normal(size=n))
    x = x + 0.003 * rng.normal(size=n)
    step, h = rng.normal(size=n), 1e-6
    state = koiter.energy(x, 2, directors)
    ahead, behind = (koiter.energy(x + s * h * step, 1, directors) for s in (1, -1))
    slope = state.gradient @ step
    assert (ahead.value - behind.value) / (2 * h) == pytest.approx(slope, rel=1e-5)
    curvature = state.hessian @ step
    difference = (ahead.gradient - behind.gradient) / (2 * h)
    assert np.linalg.norm(difference - curvature) < 1e-5 * np.linalg.norm(curvature)
    assert abs(state.hessian - state.hessian.T).max() < 1e-10 * abs(state.hessian).max()


@pytest.mark.parametrize("order", ORDERS)
def test_linear_path_is_the_second_derivative_at_rest(order):
    koiter = Koiter(Surface(patch(), order, bent), LAMINATE)
    zero = np.zeros(koiter.surface.unknowns)
    stiffness = koiter.linear_stiffness()
    assert abs(koiter.energy(zero, 2).hessian - stiffness).max() < 1e-13 * abs(stiffness).max()
    x = np.random.default_rng(0).normal(size=len(zero))
    forces = koiter.linear_forces(koiter.stress(koiter.linear_strain(x)))
    assert np.allclose(forces, stiffness @ x, atol=1e-11 * np.abs(forces).max())


def test_extrapolated_stress_is_exact_to_first_order():
    koiter = Koiter(Surface(patch(), 2, bent), LAMINATE)
    rng = np.random.default_rng(3)
    x, step = 0.01 * rng.normal(size=(2, koiter.surface.unknowns))
    linear = koiter.energy(x, 2).linear
    error = [
        np.abs(
            koiter.extrapolated_stress(linear, h * step) - koiter.stress(koiter.strain(x + h * step))
        ).max()
        for h in (1e-2, 5e-3)
    ]
    assert error[1] == pytest.approx(error[0] / 4, rel=0.1)


def test_answer_does_not_depend_on_where_the_surface_lies():
    near = Koiter(Surface(patch(), 2, bent), LAMINATE)
    far = Koiter(Surface(patch(), 2, lambda q: bent(q) + [1e5, -2e5, 3e5]), LAMINATE)
    a, b = near.linear_stiffness(), far.linear_stiffness()
    assert abs(a - b).max() < 1e-8 * abs(a).max()


@pytest.mark.parametrize("order", ORDERS)
def test_changes_of_curvature_keep_their_digits(order):
    """A tiny motion must give strains that are linear in it; subtracting b and B would leave noise."""
    surface = Surface(patch(), order, cylinder(1.0))
    koiter = Koiter(surface, STIFF)
    x = np.random.default_rng(0).normal(size=surface.unknowns)
    small, smaller = (koiter.strain(1e-10 * s * x) / s for s in (1.0, 1e-2))
    assert np.abs(small - smaller).max() < 1e-8 * np.abs(small).max()


def test_energy_tends_to_the_integral_of_its_density():
    """A finite deformation of a curved patch, given by formulas, against Gauss integration of the plain formula."""
    direction = np.array([1.0, 0.0, 0.0])
    section = Section.from_stiffness(
        LAMINATE.membrane[0], LAMINATE.bending[0], LAMINATE.coupling[0], 0.0, direction
    )

    def rest(u, v):
        return np.array([np.sin(u), v, np.cos(u)]) + 0 * u

    def deformed(u, v):
        stretched = np.array([1.1 * np.sin(u) + 0.1 * v**2, v + 0.2 * u * v, np.cos(u) + 0.3 * u * v])
        return np.array([[0.6, 0, 0.8], [0, 1, 0], [-0.8, 0, 0.6]]) @ stretched

    def derivatives(f, u, v, h=1e-4):
        one, two = (f(u + h, v) - f(u - h, v)) / (2 * h), (f(u, v + h) - f(u, v - h)) / (2 * h)
        mixed = f(u + h, v + h) - f(u + h, v - h) - f(u - h, v + h) + f(u - h, v - h)
        middle = 2 * f(u, v)
        return [
            one, two, (f(u + h, v) + f(u - h, v) - middle) / h**2,
            (f(u, v + h) + f(u, v - h) - middle) / h**2, mixed / (4 * h**2),
        ]  # fmt: skip

    points, weights = np.polynomial.legendre.leggauss(6)
    exact = sum(
        0.25 * w * z * energy_density(
            derivatives(rest, (1 + s) / 2, (1 + t) / 2), derivatives(deformed, (1 + s) / 2, (1 + t) / 2),
            section.membrane[0], section.coupling[0], section.bending[0],
        )
        for s, w in zip(points, weights, strict=True) for t, z in zip(points, weights, strict=True)
    )  # fmt: skip
    error = []
    for n in (2, 4):
        surface = Surface(rectangle(n, n, 0, 1, 0, 1), 3, lambda q: rest(q[:, 0], q[:, 1]).T)
        koiter = Koiter(surface, section)
        x = np.zeros(surface.unknowns)
        u = (deformed(*surface.flat_nodes[:, :2].T) - rest(*surface.flat_nodes[:, :2].T)).T
        x[: surface.rotation_start] = u.ravel()
        angle = edge_angles(surface, koiter.rest, u) * -np.repeat(surface.edge_sign, 3, axis=1)
        place = surface.triangle_rotations.ravel()
        mean = np.bincount(place, weights=angle.ravel()) / np.bincount(place)
        x[surface.rotation_start :] = mean
        error.append(abs(koiter.energy(x).value / exact - 1))
    assert error[1] < 1e-3
    assert error[1] < 0.3 * error[0]
