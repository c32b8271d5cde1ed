import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kshell as ks
from kshell.material.elastic_constants import CONSTANTS, elastic_constants
from kshell.material.materials import rotated

quick = settings(max_examples=40, derandomize=True, deadline=None)
moduli = st.floats(1e-3, 1e12)
ratios = st.floats(-0.95, 0.495)
angles = st.floats(-400.0, 400.0)
PAIRS = [(a, b) for i, a in enumerate(CONSTANTS) for b in CONSTANTS[i + 1 :]]


@pytest.mark.parametrize("pair", PAIRS, ids="-".join)
@quick
@given(E=moduli, nu=ratios)
def test_every_pair_of_constants_leads_back_to_all(pair, E, nu):
    if "lame_lambda" in pair and abs(nu) < 0.01:
        nu = 0.2  # lame_lambda says little about nearly vanishing nu
    constants = elastic_constants(E=E, nu=nu)
    again = elastic_constants(**{name: constants[name] for name in pair})
    for name in CONSTANTS:
        size = 1.0 if name == "nu" else E
        assert again[name] == pytest.approx(constants[name], rel=1e-7, abs=1e-9 * size)


def test_constants_of_steel():
    steel = ks.Isotropic(E=210e9, nu=0.3)
    assert steel.lame_mu == pytest.approx(80.769230769e9)
    assert steel.lame_lambda == pytest.approx(121.153846154e9)
    assert steel.bulk_modulus == pytest.approx(175e9)
    assert ks.Isotropic(lame_lambda=steel.lame_lambda, lame_mu=steel.lame_mu).nu == pytest.approx(0.3)
    assert ks.Isotropic.from_constants(bulk_modulus=175e9, E=210e9).nu == pytest.approx(0.3)


def test_plane_stress_of_an_isotropic_material():
    Q = ks.Isotropic(E=2.0, nu=0.25).plane_stress()
    compliance = np.array([[0.5, -0.125, 0.0], [-0.125, 0.5, 0.0], [0.0, 0.0, 1.25]])  # 2 (1 + nu) / E
    np.testing.assert_allclose(np.linalg.inv(Q), compliance, atol=1e-15)


@quick
@given(E=moduli, nu=ratios, angle=angles)
def test_isotropic_stiffness_does_not_depend_on_the_axes(E, nu, angle):
    Q = ks.Isotropic(E=E, nu=nu).plane_stress()
    np.testing.assert_allclose(rotated(Q, angle), Q, rtol=1e-12, atol=1e-12 * np.abs(Q).max())


@quick
@given(
    E1=moduli, ratio=st.floats(0.05, 20.0), part=st.floats(-0.9, 0.9), G=st.floats(0.01, 10.0), angle=angles
)
def test_orthotropic_stiffness(E1, ratio, part, G, angle):
    constants = {"E1": E1, "E2": E1 * ratio, "nu12": part * ratio**-0.5, "G12": G * E1}
    Q = ks.Orthotropic(**constants, angle=angle).plane_stress()
    turned = ks.Orthotropic(**constants, angle=angle + 180.0).plane_stress()
    np.testing.assert_allclose(turned, Q, rtol=1e-9, atol=1e-10 * np.abs(Q).max())
    assert np.linalg.eigvalsh(Q)[0] > 0
    # a quarter turn exchanges the axes
    quarter = ks.Orthotropic(**constants, angle=90.0).plane_stress()
    straight = ks.Orthotropic(**constants).plane_stress()
    swapped = straight[np.ix_([1, 0, 2], [1, 0, 2])]
    np.testing.assert_allclose(quarter, swapped, rtol=1e-12, atol=1e-12 * np.abs(Q).max())
    # compliance along axis 1
    assert np.linalg.inv(straight)[0, 0] * E1 == pytest.approx(1.0)
    assert -np.linalg.inv(straight)[1, 0] * E1 == pytest.approx(constants["nu12"], abs=1e-12)


def test_stress_along_the_fibre_at_an_angle():
    """A pull along a fibre turned by 30 degrees stretches it by 1 / E1."""
    Q = ks.Orthotropic(E1=10.0, E2=1.0, nu12=0.3, G12=0.5, angle=30.0).plane_stress()
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    stress = np.array([c * c, s * s, c * s])
    strain = np.linalg.solve(Q, stress)
    along = c * c * strain[0] + s * s * strain[1] + c * s * strain[2]
    assert along == pytest.approx(0.1)


def isotropic_space(E, nu):
    c = elastic_constants(E=E, nu=nu)
    C = np.diag([2 * c["lame_mu"]] * 3 + [c["lame_mu"]] * 3)
    C[:3, :3] += c["lame_lambda"]
    return C


@quick
@given(E=st.floats(0.1, 10.0), nu=st.floats(-0.9, 0.45), angle=angles)
def test_condensed_stiffness_in_space_is_plane_stress(E, nu, angle):
    Q = ks.Anisotropic(C=isotropic_space(E, nu), angle=angle).plane_stress()
    np.testing.assert_allclose(Q, ks.Isotropic(E=E, nu=nu).plane_stress(), rtol=1e-9, atol=1e-10 * E)


def test_condensation_removes_the_stresses_across_the_plate():
    rng = np.random.default_rng(3)
    root = rng.normal(size=(6, 6))
    C = root @ root.T + 6 * np.eye(6)
    Q = ks.Anisotropic(C=C).plane_stress()
    strain = np.zeros(6)
    strain[[0, 1, 5]] = rng.normal(size=3)
    across = [2, 3, 4]
    strain[across] = np.linalg.solve(C[np.ix_(across, across)], -C[across][:, [0, 1, 5]] @ strain[[0, 1, 5]])
    stress = C @ strain
    np.testing.assert_allclose(stress[across], 0.0, atol=1e-12)
    np.testing.assert_allclose(Q @ strain[[0, 1, 5]], stress[[0, 1, 5]], rtol=1e-12)


def test_cubic_and_monoclinic_classes():
    iron = ks.Anisotropic.cubic(C11=230.0, C12=135.0, C44=117.0)
    Q = iron.plane_stress()
    assert Q[0, 0] == pytest.approx(230 - 135**2 / 230)
    assert Q[0, 1] == pytest.approx(135 - 135**2 / 230)
    np.testing.assert_allclose(
        ks.Anisotropic.cubic(C11=230.0, C12=135.0, C44=117.0, angle=90.0).plane_stress(), Q, atol=1e-12 * 230
    )
    constants = {"C11": 10.0, "C12": 3.0, "C13": 2.0, "C22": 8.0, "C23": 1.0, "C33": 7.0}
    shears = {"C44": 2.0, "C55": 3.0, "C66": 4.0, "C16": 0.5, "C26": 0.2, "C36": 0.1, "C45": 0.3}
    oblique = ks.Anisotropic.monoclinic(**constants, **shears).plane_stress()
    assert oblique[0, 2] == pytest.approx(0.5 - 2.0 * 0.1 / 7.0)


def test_plane_stress_matrix_is_taken_as_it_is():
    Q = ks.Isotropic(E=3.0, nu=0.2).plane_stress()
    np.testing.assert_allclose(ks.Anisotropic(C=Q).plane_stress(), Q)
    assert ks.Anisotropic(C=Q) == ks.Anisotropic(C=Q.tolist())


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ks.Isotropic(), ["E and nu", "lame_lambda and lame_mu"]),
        (lambda: ks.Isotropic(E=1.0), ["E given", "E and nu"]),
        (lambda: ks.Isotropic(E=1.0, nu=0.2, lame_mu=3.0), ["E and nu and lame_mu"]),
        (lambda: ks.Isotropic(E=1.0, nu=0.5), ["nu = 0.5", "between -1 and 1/2"]),
        (lambda: ks.Isotropic(E=1.0, nu=-1.0), ["nu = -1"]),
        (lambda: ks.Isotropic(E=0.0, nu=0.3), ["E = 0", "> 0"]),
        (lambda: ks.Isotropic(E="210e9", nu=0.3), ["E = '210e9'", "number"]),
        (lambda: ks.Isotropic(E=float("nan"), nu=0.3), ["E = nan", "finite"]),
        (lambda: ks.Isotropic(E=True, nu=0.3), ["E = True"]),
        (lambda: ks.Isotropic(lame_lambda=-1.0, lame_mu=1.0), ["3 lame_lambda + 2 lame_mu", "-0.66"]),
        (lambda: ks.Isotropic(lame_lambda=1.0, lame_mu=-1.0), ["lame_mu = -1"]),
        (lambda: ks.Isotropic(E=1.0, nu=0.3, rho=1.0), ['"rho"', "density"]),
        (lambda: ks.Isotropic(E=1.0, nu=0.3, density=-1.0), ["density = -1"]),
        (lambda: ks.Isotropic.from_constants(E=10.0, lame_mu=1.0), ["nu = 4", "from E = 10, lame_mu = 1"]),
        (lambda: ks.Isotropic.from_constants(E=10.0), ["two constants"]),
        (lambda: ks.Isotropic.from_constants(E=1.0, mu=1.0), ['"mu"', "lame_mu"]),
        (lambda: ks.Isotropic.from_constants(lame_lambda=0.0, nu=0.0), ["nu = 0"]),
        (lambda: ks.Isotropic.from_constants(lame_lambda=2.0, bulk_modulus=1.0), ["lame_lambda = 2"]),
        (lambda: ks.Orthotropic(E1=1.0, E2=2.0, nu12=0.1), ["G12 is missing"]),
        (lambda: ks.Orthotropic(E1=1.0, E2=4.0, nu12=0.5, G12=1.0), ["nu12 = 0.5", "E1 / E2"]),
        (lambda: ks.Orthotropic(E1=1.0, E2=-4.0, nu12=0.5, G12=1.0), ["E2 = -4"]),
        (lambda: ks.Anisotropic(C=np.eye(4)), ["(4, 4)", "6 x 6"]),
        (lambda: ks.Anisotropic(C="steel"), ["'steel'", "matrix"]),
        (lambda: ks.Anisotropic(C=[[1, 0.2, 0], [0.1, 1, 0], [0, 0, 1]]), ["not symmetric", "C12"]),
        (lambda: ks.Anisotropic(C=np.diag([1.0, 1, 1, 1, 1, 0])), ["eigenvalue 0", "xy"]),
        (lambda: ks.Anisotropic(C=np.diag([1.0, 1.0, np.nan])), ["C33", "finite"]),
        (lambda: ks.Anisotropic.cubic(C11=1.0, C12=2.0, C44=1.0), ["eigenvalue -1"]),
    ],
)
def test_impossible_materials_are_refused_in_words(make, words):
    with pytest.raises(ks.InputError) as caught:
        make()
    for word in words:
        assert word in str(caught.value)
