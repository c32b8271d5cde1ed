"""Strain, stress, traction, principal stresses and the symmetry classes of stiffness."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kshell.errors import InputError
from kshell.material import elasticity as el
from kshell.material.elastic_symmetry import CLASSES, about, stiffness, symmetry, turned
from kshell.material.materials import Isotropic

few = settings(max_examples=15, deadline=None, derandomize=True)
seeds = st.integers(0, 10**6)

SIMPLE = {"C11": 10.0, "C12": 3.0, "C13": 2.0, "C33": 8.0, "C44": 3.0}
EXAMPLES = {
    "monoclinic": {
        "C11": 10, "C12": 3, "C13": 2, "C22": 9, "C23": 2.5, "C33": 8, "C44": 3, "C55": 2.5, "C66": 2.8,
        "C16": 0.4, "C26": 0.3, "C36": 0.2, "C45": 0.1,
    },
    "orthotropic": {
        "C11": 10, "C12": 3, "C13": 2, "C22": 9, "C23": 2.5, "C33": 8, "C44": 3, "C55": 2.5, "C66": 2.8,
    },
    "tetragonal": SIMPLE | {"C66": 2.8, "C16": 0.3},
    "trigonal": SIMPLE | {"C14": 0.7, "C15": 0.3},
    "transversely isotropic": SIMPLE,
    "cubic": {"C11": 10, "C12": 3, "C44": 3},
    "isotropic": {"C11": 10, "C12": 3},
}  # fmt: skip
WITH_AXIS = ("monoclinic", "tetragonal", "trigonal", "transversely isotropic")


def rank_four(C: np.ndarray) -> np.ndarray:
    number = {}
    for a, (i, j) in enumerate(el.PAIRS):
        number[i, j] = number[j, i] = a
    index = np.array([[number[i, j] for j in range(3)] for i in range(3)])
    return C[index[:, :, None, None], index[None, None]]


@given(seeds)
@few
def test_green_strain_ignores_rotations_and_the_linear_one_does_not(seed: int) -> None:
    rng = np.random.default_rng(seed)
    gradient = 0.2 * rng.normal(size=(3, 3))
    R = Rotation.random(rng=seed).as_matrix()
    turned_gradient = R @ (np.eye(3) + gradient) - np.eye(3)
    np.testing.assert_allclose(el.green_strain(turned_gradient), el.green_strain(gradient), atol=1e-13)
    np.testing.assert_allclose(el.green_strain(R - np.eye(3)), 0.0, atol=1e-14)
    small = 1e-6 * gradient
    np.testing.assert_allclose(el.green_strain(small), el.linear_strain(small), atol=1e-11)
    # change of squared lengths: 2 e . E e
    e = rng.normal(size=3)
    F = np.eye(3) + gradient
    assert 2 * e @ el.green_strain(gradient) @ e == pytest.approx((F @ e) @ (F @ e) - e @ e, abs=1e-12)


def test_isotropic_law_agrees_with_its_matrix_and_with_uniaxial_tension() -> None:
    material = Isotropic(E=200.0, nu=0.3)
    lam, mu = material.lame_lambda, material.lame_mu
    eps = np.diag([1e-3, -0.3e-3, -0.3e-3])
    np.testing.assert_allclose(el.isotropic_stress(eps, lam, mu), np.diag([0.2, 0, 0]), atol=1e-15)
    C = stiffness("isotropic", C11=lam + 2 * mu, C12=lam)
    strain = el.linear_strain(np.random.default_rng(1).normal(size=(4, 3, 3)))
    np.testing.assert_allclose(el.stress(strain, C), el.isotropic_stress(strain, lam, mu), rtol=1e-12)
    shear = el.linear_strain([[0, 0.01, 0], [0, 0, 0], [0, 0, 0]])
    assert el.isotropic_stress(shear, lam, mu)[0, 1] == pytest.approx(mu * 0.01)
    assert el.strain_vector(shear)[5] == pytest.approx(0.01)  # gamma, twice the tensor's shear


@given(seeds)
@few
def test_traction_and_principal_stresses(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(3, 3))
    s = a + a.T
    values, normals = el.principal_stresses(s)
    assert (np.diff(values) <= 0).all()
    assert np.linalg.det(normals) == pytest.approx(1.0)
    for value, n in zip(values, normals, strict=True):
        t, along, shear = el.traction(s, 5.0 * n)
        np.testing.assert_allclose(t, value * n, atol=1e-12)
        assert along == pytest.approx(value)
        assert shear == pytest.approx(0.0, abs=1e-7)
    # the planes of largest shear halve the angle between the outer principal axes
    shear = el.traction(s, normals[0] + normals[2])[2]
    assert el.largest_shear(s) == pytest.approx(shear)
    assert (el.traction(s, rng.normal(size=(50, 3)))[2] <= shear * (1 + 1e-12)).all()
    assert values.sum() == pytest.approx(np.trace(s))


def test_von_mises() -> None:
    assert el.von_mises(np.diag([7.0, 0, 0])) == pytest.approx(7.0)
    assert el.von_mises(3.0 * np.eye(3)) == pytest.approx(0.0, abs=1e-15)
    shear = el.stress_tensor([0, 0, 0, 0, 0, 2.0])
    assert el.von_mises(shear) == pytest.approx(2 * np.sqrt(3))
    assert el.von_mises(np.zeros((4, 3, 3))).shape == (4,)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: el.traction(np.eye(3), (0, 0, 0)), "normal"),
        (lambda: el.traction([[0, 1, 0], [0, 0, 0], [0, 0, 0]], (0, 0, 1)), "symmetric"),
        (lambda: el.principal_stresses(np.eye(2)), "3x3"),
        (lambda: el.linear_strain(np.full((3, 3), np.nan)), "not finite"),
        (lambda: el.green_strain(np.diag([-2.0, 0, 0])), "inside out"),
        (lambda: el.stress(np.eye(3), np.eye(3)), "6x6"),
        (lambda: el.stress_tensor([1, 2, 3]), "6 components"),
        (lambda: stiffness("cubic", C11=1.0, C12=0.5), "C44 missing"),
        (lambda: stiffness("cubic", C11=1.0, C12=0.5, C44=1.0, C16=1.0), "C16 not among them"),
        (lambda: stiffness("round"), "no symmetry class"),
        (lambda: stiffness("isotropic", C11=1.0, C12=2.0), "positive definite"),
        (lambda: symmetry(np.eye(3)), "6x6"),
        (lambda: turned(np.eye(6), np.ones((3, 3))), "rotation"),
    ],
)
def test_bad_input_is_refused(call, message) -> None:
    with pytest.raises(InputError, match=message):
        call()


def test_every_class_has_an_example_and_its_number_of_constants() -> None:
    assert set(EXAMPLES) | {"triclinic"} == set(CLASSES)
    counts = {name: len(needed) for name, (needed, _, _) in CLASSES.items()}
    assert counts == {
        "triclinic": 21, "monoclinic": 9, "orthotropic": 9, "tetragonal": 6, "trigonal": 6,
        "transversely isotropic": 5, "cubic": 3, "isotropic": 2,
    }  # fmt: skip
    assert len(CLASSES["monoclinic"][0]) + len(CLASSES["monoclinic"][1]) == 13


@pytest.mark.parametrize("kind", EXAMPLES)
def test_a_class_is_recognised_along_any_axis_and_lost_in_a_general_one(kind: str) -> None:
    C = stiffness(kind, **EXAMPLES[kind])
    assert symmetry(C) == (kind, "z" if kind in WITH_AXIS else None)
    assert symmetry(turned(C, about("x", np.pi / 2))) == (kind, "y" if kind in WITH_AXIS else None)
    assert symmetry(turned(C, about("y", np.pi / 2))) == (kind, "x" if kind in WITH_AXIS else None)
    general = symmetry(turned(C, Rotation.random(rng=3).as_matrix())).kind
    assert general == ("isotropic" if kind == "isotropic" else "triclinic")


@given(seeds, st.sampled_from(sorted(EXAMPLES)))
@few
def test_turned_stiffness_is_the_turned_tensor(seed: int, kind: str) -> None:
    C, R = stiffness(kind, **EXAMPLES[kind]), Rotation.random(rng=seed).as_matrix()
    # C'_ijkl = R_ia R_jb R_kc R_ld C_abcd
    tensor = np.einsum("ia,jb,kc,ld,abcd->ijkl", R, R, R, R, rank_four(C))
    np.testing.assert_allclose(rank_four(turned(C, R)), tensor, atol=1e-12)
    # stress in turned axes of a turned strain
    eps = el.linear_strain(np.random.default_rng(seed).normal(size=(3, 3)))
    np.testing.assert_allclose(
        el.stress(R @ eps @ R.T, turned(C, R)), R @ el.stress(eps, C) @ R.T, atol=1e-11
    )


def test_a_triclinic_stiffness() -> None:
    rng = np.random.default_rng(5)
    a = rng.normal(size=(6, 6))
    C = a @ a.T + 6 * np.eye(6)
    rebuilt = stiffness("triclinic", **{f"C{i + 1}{j + 1}": C[i, j] for i in range(6) for j in range(i, 6)})
    np.testing.assert_array_equal(rebuilt, C)
    assert symmetry(C) == ("triclinic", None)
    assert symmetry(stiffness("hexagonal", **SIMPLE)).kind == "transversely isotropic"
