import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kshell as ks
from kshell.material.laminate import laminate, require_symmetric

CARBON = ks.Orthotropic(E1=140.0, E2=10.0, nu12=0.3, G12=5.0, density=1.6)
quick = settings(max_examples=30, derandomize=True, deadline=None)
angles = st.floats(-90.0, 90.0)


@quick
@given(angle=angles, thickness=st.floats(1e-4, 1.0))
def test_one_layer_is_a_plate(angle, thickness):
    stack = laminate([ks.Layer(CARBON, thickness, angle)])
    turned = ks.Orthotropic(E1=140.0, E2=10.0, nu12=0.3, G12=5.0, angle=angle).plane_stress()
    np.testing.assert_allclose(stack.A, thickness * turned, rtol=1e-10, atol=1e-9 * thickness)
    np.testing.assert_allclose(stack.D, thickness**3 / 12 * turned, rtol=1e-10, atol=1e-9 * thickness**3)
    assert stack.coupling < 1e-14
    assert stack.mass == pytest.approx(1.6 * thickness)


@quick
@given(half=st.lists(st.tuples(angles, st.floats(0.01, 1.0)), min_size=1, max_size=5))
def test_mirrored_stacks_have_no_coupling(half):
    layers = [ks.Layer(CARBON, t, a) for a, t in half]
    stack = laminate(layers + layers[::-1])
    require_symmetric(stack.coupling)
    # cutting a layer in two changes nothing
    cut = [ks.Layer(CARBON, t / 2, a) for a, t in half for _ in range(2)]
    again = laminate(cut + cut[::-1])
    np.testing.assert_allclose(again.D, stack.D, rtol=1e-9, atol=1e-9 * np.abs(stack.D).max())


def test_outer_layers_bend_stiffest_in_their_fibre_direction():
    stack = laminate([ks.Layer(CARBON, 1.0, a) for a in (0, 90, 90, 0)])
    Q0, Q90 = CARBON.plane_stress(), ks.Layer(CARBON, 1.0, 90).plane_stress()
    # z^3 / 3 between the faces: inner from -1 to 1, outer from 1 to 2 on both sides
    np.testing.assert_allclose(stack.D, Q90 * 2 / 3 + Q0 * 14 / 3, rtol=1e-12, atol=1e-10)
    np.testing.assert_allclose(stack.A, 2 * Q0 + 2 * Q90, rtol=1e-12, atol=1e-10)
    np.testing.assert_allclose(stack.top, Q0)


def test_first_layer_is_the_bottom():
    stiff, soft = ks.Isotropic(E=2.0, nu=0.0), ks.Isotropic(E=1.0, nu=0.0)
    stack = laminate([ks.Layer(stiff, 1.0), ks.Layer(soft, 1.0)])
    assert stack.B[0, 0] == pytest.approx(2 * (-0.5) + 1 * 0.5)  # integral of z: -1/2 below, 1/2 above
    assert stack.bottom[0, 0] == pytest.approx(2.0)


def test_unsymmetric_laminates_are_refused_with_the_reason():
    with pytest.raises(ks.InputError, match=r"not symmetric.*stretches.*0\.\d+.*mirror"):
        require_symmetric(laminate([ks.Layer(CARBON, 1.0, 0), ks.Layer(CARBON, 1.0, 90)]).coupling)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ks.Layer(CARBON, 0.0), "thickness = 0"),
        (lambda: ks.Layer(CARBON, -1.0), "thickness = -1"),
        (lambda: ks.Layer("carbon", 1.0), "'carbon'"),
        (lambda: ks.Layer(CARBON), "thickness is missing"),
        (lambda: laminate([]), "empty"),
    ],
)
def test_impossible_layers_are_refused(make, words):
    with pytest.raises(ks.InputError, match=words):
        make()
