"""Strains without stress: free shells take them up, held ones carry minus the stiffness times them."""

import dataclasses

import numpy as np
import pytest

import kshell as ks
from tests.scene.fabricated import square_mesh
from tests.shell.shapes import panel
from tests.shell.shell_scenes import MESHES

E0 = (2e-3, -1e-3, 0.7e-3)
STRAIN = np.array([2e-3, -1e-3, 1.4e-3])  # with the shear doubled
CARBON = ks.Orthotropic(E1=140e9, E2=9e9, nu12=0.3, G12=5e9)
SECTIONS = {
    "isotropic": {"thickness": 0.02, "material": ks.Isotropic(E=1e9, nu=0.3)},
    "varying": {"thickness": "0.02*(1 + x)", "material": ks.Isotropic(E=1e9, nu=0.3)},
    "laminate": {"layers": [ks.Layer(CARBON, 0.01, 0.0), ks.Layer(CARBON, 0.01, 90.0), ks.Layer(CARBON, 0.02, 30.0)]},
}  # fmt: skip
TILTED = panel((1, 2, 3), (1.0, 0, 0.5), (0, 1, 0), 3)
HELD = [
    ks.Fixed((1, 2, 3), "xyz"),
    ks.Fixed((2, 2, 3.5), "y"),
    ks.Fixed((2, 2, 3.5), "z", axes=((1, 0, 0.5), (0, 1, 0), (-0.5, 0, 1))),
    ks.Fixed((1, 3, 3), "z", axes=((1, 0, 0.5), (0, 1, 0), (-0.5, 0, 1))),
]


def stiffness(section, x=0.5):
    """A and B of a section."""
    if "layers" in section:
        from kshell.material.laminate import laminate

        stack = laminate(section["layers"])
        return stack.A, stack.B
    t = 0.02 * (1 + x) if isinstance(section["thickness"], str) else section["thickness"]
    return t * section["material"].plane_stress(), np.zeros((3, 3))


@pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)
@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_a_free_patch_strains_without_stress(section, order):
    mesh = ks.Mesh.from_arrays(*TILTED)
    scene = ks.Scene(mesh=mesh, supports=HELD, loads=[ks.InitialStrain(E0)], **section)
    result = ks.solve(scene, element="koiter", order=order, large_deflection=False)
    blocked = np.abs(stiffness(section)[0] @ STRAIN).max()
    assert np.abs(result.fields["membrane_force"]).max() < 1e-8 * blocked
    # along the axes of the patch: e_1 along (1, 0, 0.5), e_2 along y
    e1 = np.array([1, 0, 0.5]) / np.sqrt(1.25)
    arm = mesh.points - [1, 2, 3]
    u = result.fields["displacement"]
    s, t = arm @ e1, arm[:, 1]
    stretch = np.linalg.lstsq(np.stack([s, t], axis=1), np.stack([u @ e1, u[:, 1]], axis=1), rcond=None)[0]
    symmetric = 0.5 * (stretch + stretch.T)
    np.testing.assert_allclose(symmetric, [[E0[0], E0[2]], [E0[2], E0[1]]], atol=1e-9)


@pytest.mark.parametrize("section", ["isotropic", "laminate"])
@pytest.mark.parametrize("element", ["koiter", "argyris"])
def test_a_clamped_patch_carries_it(section, element):
    """N = -A e0 and M = -B e0."""
    section = SECTIONS[section]
    chart = {"chart": ks.geometry.Plane()} if element == "argyris" else {}
    scene = ks.Scene(
        mesh=square_mesh(4), supports=[ks.Clamped(["left", "right", "bottom", "top"])],
        loads=[ks.InitialStrain(E0)], probes={"p": (0.5, 0.5, 0)}, **chart, **section,
    )  # fmt: skip
    result = ks.solve(scene, model="shell", element=element, large_deflection=False)
    a, b = stiffness(section)
    probe = result.probe("p")
    np.testing.assert_allclose(probe["N"], -a @ STRAIN, rtol=1e-7)
    np.testing.assert_allclose(probe["M"], -b @ STRAIN, atol=1e-9 * np.abs(a).max() * 0.02 * 2e-3)
    assert np.abs(result.fields["displacement"]).max() < 1e-12
    assert result.balance < 1e-9
    assert not result.warnings


def test_a_strain_that_varies_is_that_of_a_known_displacement():
    """e0 = sym grad of (x^2 y, x y^2)/1000 is compatible: a free plate takes it up, and moves by that."""
    mesh = square_mesh(4)
    e0 = ("2e-3*x*y", "2e-3*x*y", "0.5e-3*(x**2 + y**2)")
    scene = ks.Scene(
        mesh=mesh, thickness=0.01, material=ks.Isotropic(E=1e9, nu=0.3), loads=[ks.InitialStrain(e0)],
        supports=[ks.Fixed((0, 0, 0), "xyz"), ks.Fixed((1, 0, 0), "yz"), ks.Fixed((0, 1, 0), "z")],
        probes={"p": (1, 1, 0)},
    )  # fmt: skip
    result = ks.solve(scene, order=3, large_deflection=False)
    assert result.model["kind"] == "shell"  # found by itself
    assert result.probe("p")["u"] == pytest.approx([1e-3, 1e-3, 0.0], abs=1e-9)
    assert np.abs(result.fields["membrane_force"]).max() < 1e-6 * 1e7 * 2e-3


@pytest.mark.parametrize("element", ["koiter", "argyris"])
def test_a_uniform_strain_is_a_temperature(element):
    """On a curved shell, too: it grows, and no moment is left."""
    tube = ks.Scene.load(MESHES / "tube.toml")
    results = [
        ks.solve(dataclasses.replace(tube, loads=[load]), element=element, large_deflection=False)
        for load in (ks.Temperature(mean=10.0, expansion=1e-4), ks.InitialStrain((1e-3, 1e-3, 0.0)))
    ]
    for result in results:
        assert result.probe("end")["u"] == pytest.approx([1e-3, 0, -1e-3], abs=1e-8)  # held at z = 1
        assert np.abs(result.fields["membrane_force"]).max() < 1e-6 * 0.01 * 1e-3
        assert np.abs(result.fields["moment"]).max() < 1e-6 * 0.01**2 * 1e-3


def test_a_clamped_ring_under_temperature_gradient_agrees_between_elements():
    tube = ks.Scene.load(MESHES / "tube.toml")
    mesh = tube.chart.parameter_mesh(6, 10, ("cuts", "cuts", "end", "far"), (0, np.pi / 2), (0, 1))
    loads = [
        ks.Temperature(mean="5*z", gradient=200.0, expansion=1e-4),
        ks.InitialCurvature((1e-2, "2e-2*z", 5e-3)),
        ks.InitialStrain((0, 1e-3, "1e-3*z")),
    ]
    probes = {"end": (1, 0, 0), "middle": (0.8, 0.6, 0.55)}
    scene = dataclasses.replace(tube, mesh=mesh, loads=loads, thickness=0.1, probes=probes)
    values = []
    for options in ({"element": "argyris"}, {"element": "koiter", "order": 3}):
        result = ks.solve(scene, large_deflection=False, **options)
        inside = result.probe("middle")
        values.append(
            np.concatenate([result.probe("end")["u"][[0, 2]], inside["u"], 100 * inside["M"], inside["N"]])
        )
    np.testing.assert_allclose(values[0], values[1], rtol=1e-2, atol=3e-6)


def test_scene_file_plate_and_shapes(tmp_path):
    with pytest.raises(ks.InputError, match="vector of three"):
        ks.InitialStrain((1.0, 2.0))
    scene = ks.Scene(
        mesh=square_mesh(4), thickness=0.01, material=ks.Isotropic(E=1e9, nu=0.3),
        supports=[ks.Clamped("left")], loads=[ks.InitialStrain(E0)],
    )  # fmt: skip
    result = ks.solve(scene, model="plate", large_deflection=False)
    assert any("stretches the plate in its plane" in words for words in result.warnings)
    assert "stretches it" in " ".join(ks.solve(scene, large_deflection=False).model["reasons"])
    loaded = ks.Scene.from_dict(
        {
            "mesh": str(MESHES / "scordelis_lo.msh"),
            "thickness": 1.0,
            "material": {"E": 1.0, "nu": 0.0},
            "load": [{"kind": "initial_strain", "value": [1e-3, 0, 0], "on": "roof"}],
        }
    )
    assert loaded.loads[0].at([[0, 0, 0]]).tolist() == [[1e-3, 0, 0]]
