"""Warm sections against formulas by hand."""

import numpy as np
import pytest

import kshell as ks
from kshell.material.laminate import Layer, laminate
from kshell.material.thermal import along_axes, of_layers

PLY = ks.Orthotropic(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, expansion=[-0.3e-6, 28e-6])


def bimetal(nu=0.0):
    lower = ks.Isotropic(E=200e9, nu=nu, expansion=11e-6)
    upper = ks.Isotropic(E=100e9, nu=nu, expansion=23e-6)
    return laminate([Layer(lower, 1.0e-3), Layer(upper, 1.5e-3)])


def timoshenko():
    """Curvature of a bimetal strip per temperature (Timoshenko, J. Opt. Soc. Am. 11 (1925) 233-255)."""
    m, n, h = 1.0 / 1.5, 2.0, 2.5e-3
    return 6 * 12e-6 * (1 + m) ** 2 / (h * (3 * (1 + m) ** 2 + (1 + m * n) * (m**2 + 1 / (m * n))))


def test_a_bimetal_strip_bends_as_timoshenko_says():
    found = of_layers(bimetal(), None)
    assert found.curvature[:, 0] == pytest.approx([timoshenko(), timoshenko(), 0.0], rel=1e-12)
    assert found.couples


@pytest.mark.parametrize("angles", [(0, 90), (0, 90, 0), (30, -30, 10, 70), (45, -45)])
def test_stresses_left_in_layers_have_no_resultant(angles):
    stack = laminate([Layer(PLY, 1e-3 * (1 + k), angle) for k, angle in enumerate(angles)])
    left = of_layers(stack, None).layers  # linear through each layer
    h, z = np.diff(stack.z), stack.z
    size = np.abs(left).max(axis=(0, 1, 2)) * stack.thickness
    force = (0.5 * (left[:, 0] + left[:, 1]) * h[:, None, None]).sum(axis=0)
    middle = 0.5 * (z[1:] + z[:-1])
    moment = (0.5 * (left[:, 0] + left[:, 1]) * (h * middle)[:, None, None]).sum(axis=0)
    moment += ((left[:, 1] - left[:, 0]) * (h**2 / 12)[:, None, None]).sum(axis=0)
    assert np.all(np.abs(force) < 1e-12 * size)
    assert np.all(np.abs(moment) < 1e-12 * size * stack.thickness)


def test_layers_that_expand_alike_keep_no_stress():
    alike = [
        Layer(ks.Isotropic(E=E, nu=0.3, expansion=1e-5), 1e-3, angle) for E, angle in ((1e9, 0), (9e9, 30))
    ]
    found = of_layers(laminate(alike), None)
    assert not found.faces.any()
    assert not found.couples
    assert found.strain[:, 0].tolist() == [1e-5, 1e-5, 0.0]
    assert found.curvature[:, 1].tolist() == [1e-5, 1e-5, 0.0]
    assert not of_layers(laminate([Layer(PLY, 1e-3, 0), Layer(PLY, 1e-3, 90)]), (2e-5, 2e-5)).faces.any()


def test_an_expansion_along_axes_turns_with_the_material():
    turned = ks.Orthotropic(E1=2.0, E2=1.0, nu12=0.3, G12=1.0, angle=30, expansion=[1.0, 0.0])
    a = along_axes(turned, 15.0, None)
    assert a == pytest.approx([0.5, 0.5, 1.0])  # along 45 degrees, the shear doubled
    assert along_axes(turned, 60.0, None) == pytest.approx([0.0, 1.0, 0.0])


def test_a_symmetric_cross_ply_does_not_couple_but_keeps_stresses():
    found = of_layers(laminate([Layer(PLY, 1e-3, angle) for angle in (0, 90, 90, 0)]), None)
    assert not found.couples
    assert found.faces[0, 0, 0] == pytest.approx(found.faces[2, 0, 0])
    assert np.abs(found.faces).max() > 1e5


@pytest.mark.parametrize("expansion", ["hot", [1e-5], [1e-5, 2e-5, 3e-5], [1e-5, "x"], True])
def test_other_expansions_are_refused(expansion):
    with pytest.raises(ks.InputError, match="expansion"):
        ks.Isotropic(E=1.0, nu=0.3, expansion=expansion)
