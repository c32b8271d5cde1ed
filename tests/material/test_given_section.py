import numpy as np
import pytest

import kshell as ks
from kshell.material.laminate import laminate
from kshell.material.section import shell_section
from tests.scene.fabricated import square_mesh

CARBON = ks.Orthotropic(E1=140.0, E2=10.0, nu12=0.3, G12=5.0, density=1.6, G13=5.0, G23=3.0)
STEEL = ks.Isotropic(E=2e5, nu=0.3, density=7.8)
LOPSIDED = [ks.Layer(CARBON, 0.01, angle) for angle in (0, 30)]
MIRRORED = [ks.Layer(CARBON, 0.01, angle) for angle in (0, 30, 30, 0)]
UNIT = np.eye(3)


def given(layers, **more):
    stack = laminate(layers)
    return ks.Section(A=stack.A, B=stack.B, D=stack.D, mass=stack.mass, S=stack.S, **more)


def answer(**section):
    scene = ks.Scene(
        mesh=square_mesh(4),
        supports=[ks.Clamped("left")],
        loads=[ks.Gravity((0, 0, -1e-6))],
        probes={"end": (1, 0.5, 0)},
        **section,
    )
    return ks.solve(scene, large_deflection=False)


@pytest.mark.parametrize(("layers", "kind"), [(MIRRORED, "plate"), (LOPSIDED, "shell")])
def test_a_laminate_given_by_its_stiffness_is_the_laminate(layers, kind):
    whole, direct = answer(layers=layers), answer(section=given(layers))
    assert whole.model["kind"] == direct.model["kind"] == kind
    for key in ("u", "M", "N"):
        a, b = whole.probe("end")[key], direct.probe("end")[key]
        np.testing.assert_allclose(b, a, rtol=1e-9, atol=1e-9 * max(np.abs(a).max(), 1e-300))


@pytest.mark.parametrize("layers", [MIRRORED, LOPSIDED])
def test_without_thickness_there_are_no_stresses(layers):
    result = answer(section=given(layers))
    assert not [
        name for name in [*result.fields, *result.probe("end")] if name.startswith(("stress_", "von_mises"))
    ]
    assert "von_mises" not in result.to_dict()["extremes"]
    probe = answer(section=given(layers, thickness=0.05)).probe("end")
    expected = probe["N"] / 0.05 + 6 * probe["M"] / 0.05**2
    np.testing.assert_allclose(probe["stress_top"], expected, rtol=1e-9, atol=1e-12)


def test_parts_by_group_are_those_of_each():
    mesh = square_mesh(4)
    every = np.arange(len(mesh.triangles))
    points = mesh.points[mesh.triangles].mean(axis=1)[:, None]
    found = shell_section(mesh, {"*": 0.1, "west": 0.2}, STEEL, {"east": LOPSIDED})
    west = points[:, 0, 0] < 0.5
    np.testing.assert_allclose(found.thickness(every, points)[:, 0], np.where(west, 0.2, 0.02))
    stack = laminate(LOPSIDED)
    np.testing.assert_allclose(found.coupling(every, points)[~west, 0], np.broadcast_to(stack.B, (16, 3, 3)))
    np.testing.assert_allclose(found.coupling(every, points)[west], 0.0)
    np.testing.assert_allclose(found.shear(every, points)[west, 0, 0, 0], 5 / 6 * 0.2 * 2e5 / 2.6)


def test_blocks_by_group_are_dicts_by_group():
    scene = {
        "mesh": "plate.msh",
        "thickness": 0.1,
        "material": {"E": 1.0, "nu": 0.3},
        "group": {
            "rib": {"thickness": 0.2, "offset": 0.05, "direction": [0, 1, 0]},
            "skin": {"section": {"A": UNIT, "D": UNIT}},
        },
    }
    found = ks.Scene.from_dict(scene)
    assert found.thickness == {"*": 0.1, "rib": 0.2}
    assert found.offset == {"rib": 0.05}
    assert found.direction == {"rib": (0.0, 1.0, 0.0)}
    assert found.section == {"skin": ks.Section(A=UNIT, D=UNIT)}


def test_scenes_by_group_are_saved(tmp_path):
    scene = ks.Scene(
        mesh=tmp_path / "plate.msh",
        thickness={"*": 0.1, "rib": "0.2 + x"},
        material={"*": STEEL, "rib": CARBON},
        layers={"skin": LOPSIDED},
        section={"web": ks.Section(A=UNIT, D=UNIT, S=np.eye(2), mass=2.0)},
        offset={"rib": 0.05},
        direction={"skin": (0, 1, 0)},
    )
    scene.save(tmp_path / "scene.toml")
    again = ks.Scene.load(tmp_path / "scene.toml")
    for key in ("material", "layers", "section", "offset", "direction"):
        assert getattr(again, key) == getattr(scene, key)
    assert again.thickness["*"] == 0.1


def test_offset_and_direction_by_group_are_those_for_all_where_all_have_them():
    layers = [ks.Layer(CARBON, 0.02, 20)]
    one = answer(layers=layers, offset=0.01, direction=(0, 1, 0))
    both = answer(layers=layers, offset={"west": 0.01, "east": 0.01}, direction={"plate": (0, 1, 0)})
    np.testing.assert_allclose(both.probe("end")["u"], one.probe("end")["u"], rtol=1e-9)
    other = answer(layers=layers, offset={"west": 0.01}, direction={"west": (0, 1, 0)})
    assert abs(other.probe("end")["u"][2] / one.probe("end")["u"][2] - 1) > 0.01


def test_shear_of_layers():
    """One material: 5/6 G t, in one piece or cut. A soft core carries the shear of a sandwich: G (c + f)^2 / c."""
    for layers in ([ks.Layer(CARBON, 0.3, 0)], [ks.Layer(CARBON, 0.1, 0)] * 3):
        np.testing.assert_allclose(
            laminate(layers).S, 5 / 6 * 0.3 * np.diag([5.0, 3.0]), rtol=1e-9, atol=1e-12
        )
    face, core = ks.Isotropic(E=1e6, nu=0.3), ks.Isotropic(E=1.0, nu=0.3)
    c, f = 1.0, 0.01
    S = laminate([ks.Layer(face, f), ks.Layer(core, c), ks.Layer(face, f)]).S
    np.testing.assert_allclose(S, core.lame_mu * (c + f) ** 2 / c * np.eye(2), rtol=1e-2, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ks.Section(A=UNIT), ["section: D is missing"]),
        (lambda: ks.Section(A=UNIT, D=np.eye(2)), ["D has the shape (2, 2)", "3 x 3"]),
        (lambda: ks.Section(A=UNIT, D=-UNIT), ["D", "not positive definite"]),
        (lambda: ks.Section(A=[[1, 2, 0], [0, 1, 0], [0, 0, 1]], D=UNIT), ["A12 = 2 but A21 = 0"]),
        (lambda: ks.Section(A=UNIT, D=UNIT, B=2 * UNIT), ["B", "too large"]),
        (lambda: ks.Section(A=UNIT, D=UNIT, S=UNIT), ["S has the shape (3, 3)", "2 x 2"]),
        (lambda: ks.Section(A=UNIT, D=UNIT, mass=-1.0), ["mass = -1"]),
        (lambda: ks.Section(A=UNIT, D=UNIT, thickness=0.0), ["thickness = 0"]),
        (lambda: ks.Section(A="stiff", D=UNIT), ["A = 'stiff'", "not a matrix"]),
        (lambda: ks.Section(A=np.nan * UNIT, D=UNIT), ["A11 = nan"]),
        (lambda: ks.Orthotropic(E1=1.0, E2=1.0, nu12=0.3, G12=1.0, G13=-1.0), ["G13 = -1"]),
        (lambda: ks.Scene(mesh="a.msh", section=3), ["section = 3", "ks.Section"]),
        (
            lambda: ks.Scene(mesh="a.msh", section=ks.Section(A=UNIT, D=UNIT), thickness=1),
            ["section and thickness"],
        ),
        (lambda: ks.Scene(mesh="a.msh", section={"a": 1}), ['for "a" must be a ks.Section']),
        (
            lambda: answer(thickness={"west": 0.1}, material=STEEL),
            ["16 triangles belong to none", "thickness"],
        ),
        (lambda: answer(thickness=0.1, material={"west": STEEL}), ["material", "16 triangles"]),
        (
            lambda: answer(thickness={"west": 0.1}, material=STEEL, section={"plate": given(MIRRORED)}),
            ["both section and thickness", "leave one of them out"],
        ),
        (lambda: answer(thickness=0.1, material={"weste": STEEL}), ["material", "'west'"]),
        (lambda: answer(thickness=0.1, material=STEEL, offset={"left": 0.1}), ["offset", "left"]),
        (
            lambda: ks.Scene.from_dict({"mesh": "a.msh", "group": {"rib": {"thicknes": 1}}}),
            ["[group.rib]", '"thicknes"', "thickness"],
        ),
        (
            lambda: ks.Scene.from_dict(
                {"mesh": "a.msh", "thickness": {"rib": 1}, "group": {"rib": {"thickness": 1}}}
            ),
            ["given twice"],
        ),
        (
            lambda: ks.Scene.from_dict({"mesh": "a.msh", "section": {"A": UNIT, "D": UNIT, "C": 1}}),
            ["[section]", '"C"'],
        ),
    ],
)
def test_impossible_sections_are_refused_in_words(make, words):
    with pytest.raises(ks.InputError) as caught:
        make()
    for word in words:
        assert word in str(caught.value)
