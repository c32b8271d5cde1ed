"""Shells from scene files and gmsh meshes: the references of shipped scenes, and what every shell scene must do."""

import builtins
import dataclasses
import json
from pathlib import Path

import meshio
import numpy as np
import pytest

import kshell as ks
from kshell.cli import run
from tests.scene.fabricated import square_mesh
from tests.shell.shapes import joined, panel, strip

MESHES = Path(__file__).parents[2] / "meshes"
STEEL = ks.Isotropic(E=210e9, nu=0.3, density=7850)

# scene, overrides, probe, component of u, reference, tolerance (relative)
KNOWN = [
    ("scordelis_lo", [], "free edge", 2, -0.300592457, 1e-5),
    ("scordelis_lo", [], "crown", 2, 0.0450741611, 2e-4),
    ("pinched_cylinder", [], "force", 2, -1.828195e-5, 1e-3),
    ("hemisphere_hole", [], "pull", 0, 0.0935216, 3e-4),
    ("hemisphere_hole", [], "push", 1, -0.0935216, 3e-4),
    ("hemisphere", [], "pull", 0, 0.0924131, 3e-4),
    ("raasch_hook", [], "tip", 1, 4.5580, 1e-3),
    ("twisted_beam", [], "tip", 0, 1.74949e-3, 1e-3),
    ("twisted_beam", ["load.0.value=[0, 0.90909090909, 0]"], "tip", 1, 5.39965e-3, 1e-3),
    ("twisted_beam", ["solve.element=koiter"], "tip", 0, 1.74949e-3, 1e-3),
    (
        "twisted_beam",
        ["thickness=0.0032", "load.0.value=[0.90909090909e-6, 0, 0]"],
        "tip",
        0,
        1.2928e-3,
        1e-3,
    ),
    (
        "twisted_beam",
        ["thickness=0.0032", "load.0.value=[0, 0.90909090909e-6, 0]"],
        "tip",
        1,
        5.24974e-3,
        1e-3,
    ),
    ("hypar", [], "tip", 2, -9.3118e-5, 1e-3),
    ("hypar", ["thickness=0.001"], "tip", 2, -6.3946e-3, 1e-3),
    ("tube", [], "end", 0, 2570.814, 1e-2),  # the closed form leaves out terms of the size t / R
    ("tube", ["solve.element=koiter"], "end", 0, 2570.814, 1e-2),
]


@pytest.mark.parametrize(("name", "overrides", "probe", "component", "reference", "tolerance"), KNOWN)
def test_references(name, overrides, probe, component, reference, tolerance):
    result = ks.solve(ks.Scene.load(MESHES / f"{name}.toml", overrides))
    assert result.probe(probe)["u"][component] == pytest.approx(reference, rel=tolerance)
    assert result.balance < 1e-8
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-6)
    if name == "scordelis_lo":
        assert result.unknowns <= 1700
        assert (result.model["element"], result.model["order"]) == ("koiter", 3)
        assert result.strain_energy == pytest.approx(4826.57703 / 4, rel=3e-5)


def test_sphere_under_pressure_from_the_command_line(tmp_path):
    assert run(["solve", str(MESHES / "pressurised_sphere.toml"), "--json", str(tmp_path / "r.json")]) == 0
    document = json.loads((tmp_path / "r.json").read_text())
    probe = document["probes"]["middle"]
    assert np.linalg.norm(probe["u"]) == pytest.approx(35.0 * (1 - 1e-4 / 12), rel=1e-3)
    assert probe["N"] == pytest.approx([0.5, 0.5, 0.0], abs=2e-3)
    assert "tangent plane" in probe["frame"]
    # the cut carries the pressure on a quarter disc in each direction
    assert document["reactions"]["cuts"]["force"] == pytest.approx([-np.pi / 4] * 3, rel=1e-4)
    assert document["energies"]["membrane"] > 1e3 * document["energies"]["bending"]
    assert document["model"] == {
        "kind": "shell", "large_deflection": False, "element": "koiter", "order": 3,
        "reasons": document["model"]["reasons"],
    }  # fmt: skip


def test_every_order_on_the_command_line(tmp_path, capsys):
    for order, error in (("1", 6e-3), ("2", 2e-3), ("3", 5e-4)):
        out = tmp_path / f"{order}.json"
        assert run(["solve", str(MESHES / "raasch_hook.toml"), "--order", order, "--json", str(out)]) == 0
        assert json.loads(out.read_text())["probes"]["tip"]["u"][1] == pytest.approx(4.558, rel=error)
    assert run(["check", str(MESHES / "raasch_hook.toml")]) == 0
    assert "koiter" in capsys.readouterr().out


def plate(**changes):
    data = {
        "mesh": square_mesh(8),
        "thickness": 0.01,
        "material": STEEL,
        "supports": [ks.Clamped("left"), ks.SimplySupported(["right", "bottom"])],
        "loads": [ks.Pressure("1e3*(1 + x)")],
        "probes": {"p": (0.5, 0.5, 0.0), "q": (0.8, 0.3, 0.0)},
    }
    return ks.Scene(**{**data, **changes})


LOADS = {
    "pressure": [ks.Pressure("1e3*(1 + x)")],
    "gravity": [ks.Gravity((0, 0, -9.81))],
    "line force and edge moment": [ks.LineForce("top", (0, 0, 50.0)), ks.EdgeMoment("top", 30.0)],
    "point force": [ks.PointForce((0.5, 0.5, 0), (0, 0, 100.0))],
    "temperature": [ks.Temperature(gradient=300.0, expansion=1e-5)],
    "initial curvature": [ks.InitialCurvature((1e-2, -2e-2, 0.5e-2))],
}


@pytest.mark.parametrize("loads", LOADS.values(), ids=LOADS)
def test_a_plate_scene_given_to_the_shell_gives_the_plate_answer(loads):
    scene = plate(loads=loads)
    expected, found = ks.solve(scene, model="plate"), ks.solve(scene, model="shell", order=3)
    assert (expected.model["kind"], found.model["kind"]) == ("plate", "shell")
    for name in ("p", "q"):
        a, b = expected.probe(name), found.probe(name)
        assert b["u"] == pytest.approx(a["u"], abs=5e-3 * abs(a["u"]).max())
        assert b["rotation"] == pytest.approx(a["rotation"], abs=1e-2 * abs(a["rotation"]).max())
        size = abs(a["M"]).max()
        under_force = loads[0].kind == "point_force" and name == "p"  # moments are infinite there
        assert b["M"] == pytest.approx(a["M"], abs=(0.1 if under_force else 8e-3) * size)
        assert b["stress_top"] == pytest.approx(
            a["stress_top"], abs=(0.1 if under_force else 8e-3) * 6e4 * size
        )
    # where supports meet at a corner its concentrated reaction is shared differently: the sum tells
    total = [sum(r["force"] for r in result.reactions.values()) for result in (expected, found)]
    size = max(np.abs(r["force"]).max() for r in expected.reactions.values())
    assert total[1] == pytest.approx(total[0], abs=1e-9 * size)


def test_springs_and_foundations_agree_with_the_plate():
    supports = [
        ks.Elastic("plate", 1e5),
        ks.Elastic("left", 1e4, "zr"),
        ks.Elastic((1, 1, 0), 1e3),
        ks.Fixed("left", "xy"),
    ]
    scene = plate(supports=supports)
    expected, found = ks.solve(scene), ks.solve(scene, element="koiter", order=3)
    assert found.probe("p")["u"] == pytest.approx(expected.probe("p")["u"], rel=1e-3)
    total = sum(r["force"] for r in found.reactions.values())
    assert total == pytest.approx([0, 0, -1500.0], abs=1e-6)
    assert found.energies["springs"] > 0


def test_two_symmetry_lines_of_a_flat_sector_and_a_clamped_arc():
    scene = ks.Scene.load(MESHES / "sector.toml")
    for order in (2, 3):
        found = ks.solve(scene, element="koiter", order=order)
        assert found.probe("tip")["u"][2] == pytest.approx(1 / 64, rel=2e-4)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_in_plane_load_is_solved_as_a_membrane(order):
    """Uniform tension: N = (p, 0, 0), u = p / (E t) (x, -nu y)."""
    mesh, p, t = square_mesh(4), 500.0, 0.01
    supports = [ks.Fixed("left", "x"), ks.Fixed("bottom", "y"), ks.Fixed("plate", "zr")]
    scene = ks.Scene(
        mesh=mesh, thickness=t, material=STEEL, supports=supports,
        loads=[ks.LineForce("right", (p, 0, 0))], probes={"p": (0.7, 0.4, 0)},
    )  # fmt: skip
    result = ks.solve(scene, order=order)
    assert result.model["kind"] == "shell"
    unit = p / (210e9 * t)
    assert result.probe("p")["u"] == pytest.approx([0.7 * unit, -0.3 * 0.4 * unit, 0], rel=1e-9, abs=1e-20)
    assert result.probe("p")["N"] == pytest.approx([p, 0, 0], abs=1e-8 * p)
    for face in ("top", "middle", "bottom"):
        assert result.probe("p")[f"stress_{face}"] == pytest.approx([p / t, 0, 0], abs=1e-8 * p / t)
    assert result.reactions["left"]["force"] == pytest.approx([-p, 0, 0], abs=1e-8 * p)


def test_flat_scenes_become_shells_only_where_something_stretches_them():
    kind = {
        "across": ks.solve(plate()),
        "along": ks.solve(plate(loads=[ks.LineForce("right", (1.0, 0, 5.0))])),
        "offset": ks.solve(plate(offset=0.005)),
        "layers": ks.solve(
            plate(
                thickness=None,
                material=None,
                layers=[ks.Layer(STEEL, 0.005), ks.Layer(ks.Isotropic(70e9, 0.3), 0.005)],
            )
        ),
        "moved": ks.solve(plate(supports=[ks.Clamped("left", [1e-4, 0, 0])])),
    }
    assert {name: result.model["kind"] for name, result in kind.items()} == {
        "across": "plate", "along": "shell", "offset": "shell", "layers": "shell", "moved": "shell",
    }  # fmt: skip
    assert any("in its plane" in words for words in kind["along"].model["reasons"])


def test_unsymmetric_laminate_in_cylindrical_bending():
    """A strip of two layers bends about the neutral axis: D* = D - B^2 / A where no force holds it."""
    stiff, soft = ks.Isotropic(E=2e9, nu=0.0), ks.Isotropic(E=1e9, nu=0.0)
    scene = ks.Scene(
        mesh=square_mesh(6), layers=[ks.Layer(stiff, 0.01), ks.Layer(soft, 0.01)],
        supports=[ks.Clamped("left")], loads=[ks.EdgeMoment("right", 10.0)], probes={"tip": (1, 0.5, 0)},
    )  # fmt: skip
    a, b, d = 3e7, 0.5 * (1e-4 * 1e9 - 1e-4 * 2e9), 1e-6 / 3 * 3e9
    result = ks.solve(scene)
    # positive moment puts the top in tension: it bends toward -z
    assert result.probe("tip")["u"][2] == pytest.approx(-0.5 * 10.0 / (d - b**2 / a), rel=1e-6)
    assert result.probe("tip")["u"][0] == pytest.approx(-b / a * 10.0 / (d - b**2 / a), rel=1e-6)


def test_offset_moves_the_neutral_surface_only():
    """Loads across do not care where the mesh lies in a free-to-stretch strip; its in-plane motion does."""
    scene = plate(
        supports=[ks.Clamped("left")], loads=[ks.EdgeMoment("right", 10.0)], material=ks.Isotropic(210e9, 0.0)
    )
    middle, below = ks.solve(scene, model="shell"), ks.solve(dataclasses.replace(scene, offset=0.005))
    assert below.probe("p")["u"][2] == pytest.approx(middle.probe("p")["u"][2], rel=1e-6)
    assert below.probe("p")["stress_top"] == pytest.approx(
        middle.probe("p")["stress_top"], rel=1e-4, abs=10.0
    )
    assert abs(below.probe("p")["u"][0]) > 1e-6 * abs(below.probe("p")["u"][2])


def test_free_thermal_expansion_of_a_curved_shell_leaves_no_stress():
    scene = ks.Scene.load(MESHES / "hemisphere_hole.toml")
    scene = dataclasses.replace(scene, loads=[ks.Temperature(mean=100.0, expansion=1e-5)])
    result = ks.solve(scene)
    assert result.probe("pull")["u"] == pytest.approx([1e-2, 0, 0], abs=1e-7)
    assert np.abs(result.fields["von_mises_middle"]).max() < 1e-5 * 6.825e7 * 1e-3


def test_tee_shares_the_load_between_three_sheets():
    """A T of three equal square sheets, clamped at two far edges; the hanging one is loaded like a plumb line."""
    mesh = joined(
        panel((0, 0, 0), (1, 0, 0), (0, 1, 0)), panel((-1, 0, 0), (1, 0, 0), (0, 1, 0)),
        panel((0, 0, 0), (0, 1, 0), (0, 0, -1)),
    )  # fmt: skip
    x = mesh.points[mesh.edges]
    ends = {
        name: mesh.edges[(np.abs(x[:, :, axis] - value) < 1e-9).all(axis=1)]
        for name, axis, value in (("left", 0, -1.0), ("right", 0, 1.0), ("foot", 2, -1.0))
    }
    mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, ends)
    scene = ks.Scene(
        mesh=mesh, thickness=0.01, material=STEEL, supports=[ks.Clamped("left"), ks.Clamped("right")],
        loads=[ks.LineForce("foot", (0, 0, -10.0))], probes={"foot": (0, 0.5, -1)},
    )  # fmt: skip
    result = ks.solve(scene)
    for side in ("left", "right"):
        assert result.reactions[side]["force"][2] == pytest.approx(5.0, rel=1e-6)
    assert result.probe("foot")["u"][2] < 0
    assert result.probe("foot")["u"][0] == pytest.approx(0, abs=1e-6 * abs(result.probe("foot")["u"][2]))


def cantilever_of_two(**changes):
    """Two strips end to end along x, width 1, joined at x = 1."""
    mesh = joined(panel((0, 0, 0), (1, 0, 0), (0, 1, 0)), panel((1, 0, 0), (1, 0, 0), (0, 1, 0)))
    x = mesh.points[mesh.edges][:, :, 0]
    groups = {
        n: mesh.edges[(np.abs(x - v) < 1e-9).all(axis=1)] for n, v in (("a", 0.0), ("b", 1.0), ("c", 2.0))
    }
    data = {
        "mesh": ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups),
        "thickness": 0.01,
        "material": ks.Isotropic(E=210e9, nu=0.0),
        "supports": [ks.Clamped("a"), ks.SimplySupported("c"), ks.Hinge("b")],
        "loads": [ks.LineForce("b", (0, 0, -10.0))],
        "probes": {"joint": (1, 0.5, 0)},
    }
    return ks.Scene(**{**data, **changes})


def test_hinge_releases_the_rotation():
    """Beyond the hinge the second strip only follows: the first is a cantilever with its tip force."""
    result = ks.solve(cantilever_of_two())
    stiffness = 210e9 * 0.01**3 / 12
    assert result.probe("joint")["u"][2] == pytest.approx(-10.0 / (3 * stiffness), rel=1e-6)
    assert result.reactions["c"]["force"] == pytest.approx([0, 0, 0], abs=1e-6)


WRONG = {
    "mechanism": (lambda: cantilever_of_two(supports=[ks.Clamped("a"), ks.Hinge("b")]), "can move freely"),
    "nothing held": (lambda: cantilever_of_two(supports=[ks.Hinge("b")]), "is not held"),
    "free to slide and turn": (
        lambda: cantilever_of_two(
            supports=[ks.Fixed("a", "xz"), ks.Fixed("c", "z")], solve={"element": "koiter"}
        ),
        "move along y",
    ),
    "hinge at the boundary": (
        lambda: cantilever_of_two(supports=[ks.Clamped("a"), ks.Hinge("c")]),
        "one triangle only",
    ),
    "clamped point": (
        lambda: cantilever_of_two(supports=[ks.Clamped("a"), ks.Clamped((2, 1, 0)), ks.Hinge("b")]),
        "no rotation of its own",
    ),
    "follower": (
        lambda: cantilever_of_two(loads=[ks.Pressure(1.0, follower=True)], solve={"large_deflection": False}),
        "follower",
    ),
}


@pytest.mark.parametrize(("make", "words"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_named(make, words):
    with pytest.raises(ks.KshellError, match=words):
        ks.solve(make())


def on_roof(supports, **changes):
    return dataclasses.replace(ks.Scene.load(MESHES / "scordelis_lo.toml"), supports=supports, **changes)


@pytest.mark.parametrize(
    ("supports", "words"),
    [
        ([], ["not held", "x, y and z"]),
        ([ks.Fixed("wall", "xz")], ["in 3 ways", "move along y", "turn about"]),
        ([ks.SimplySupported("crown")], ["turn about the axis", "along y"]),
        ([ks.Symmetry("free"), ks.Symmetry("wall")], ["rigid body"]),
        ([ks.Symmetry(["roof"])], ["curve is needed"]),
    ],
)
def test_rigid_motions_are_named(supports, words):
    with pytest.raises(ks.InputError) as caught:
        ks.solve(on_roof(supports))
    for word in words:
        assert word in str(caught.value)


def test_symmetry_needs_a_plane_at_right_angles():
    scene = ks.Scene.load(MESHES / "hemisphere_hole.toml")
    with pytest.raises(ks.InputError, match=r"symmetry on 'hole'.*right angle"):
        ks.solve(dataclasses.replace(scene, supports=[ks.Symmetry("hole")]))


def test_thick_shells_flat_facets_and_crossings_are_warned_of():
    hook = dataclasses.replace(ks.Scene.load(MESHES / "raasch_hook.toml"), thickness=8.0)
    assert any(
        "thickness 8 " in words and "radius of curvature 13.9" in words for words in ks.solve(hook).warnings
    )

    roof = ks.Scene.load(MESHES / "scordelis_lo.toml")
    faceted = dataclasses.replace(roof, mesh=dataclasses.replace(roof.read_mesh(), midpoints=None))
    result = ks.solve(faceted)
    assert any(
        "flat triangles" in words and "2.9 degrees" in words and "order 2" in words
        for words in result.warnings
    )
    assert result.model["order"] == 2
    assert not ks.solve(roof).warnings

    a, b = panel((0, 0, 0), (1, 0, 0), (0, 1, 0), 3), panel((0.45, 0.2, -0.5), (0, 0.5, 0), (0, 0, 1), 3)
    mesh = ks.Mesh(np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1] + len(a[0])]).astype(np.int32))
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.45, 0.2, -0.5), (0.45, 0.7, -0.5), (0.45, 0.2, 0.5)]
    scene = ks.Scene(
        mesh=mesh, thickness=0.01, material=STEEL, supports=[ks.SimplySupported(c) for c in corners],
        loads=[ks.Gravity((0, 0, -1.0))],
    )  # fmt: skip
    assert any("crosses itself" in words and "0.45" in words for words in ks.solve(scene).warnings)


def test_pressure_over_a_branch_with_opposed_normals_is_warned_of():
    scene = ks.Scene.load(MESHES / "box_girder.toml")
    assert not ks.solve(scene).warnings
    scene = dataclasses.replace(scene, loads=[ks.Pressure(1e3, "top")])
    assert any("opposite sides" in words for words in ks.solve(scene).warnings)


def test_symmetric_half_of_the_girder_is_half_of_the_whole():
    """Reactions: the end carries the load, the plane of symmetry only bending."""
    result = ks.solve(ks.Scene.load(MESHES / "box_girder.toml"))
    assert result.reactions["end"]["force"] == pytest.approx([0, 0, 20000.0], abs=1e-3)
    assert result.reactions["middle"]["moment"][1] == pytest.approx(-40000.0, rel=1e-6)  # 20000 times 2
    assert result.cell_fields["thickness"].min() == 0.01
    assert result.cell_fields["thickness"].max() == 0.02


def test_files_and_pictures(tmp_path, monkeypatch):
    result = ks.solve(ks.Scene.load(MESHES / "raasch_hook.toml"))
    result.save(tmp_path, plots=True)
    names = {path.name for path in tmp_path.iterdir()}
    assert {
        "result.json",
        "result.vtu",
        "deflection.png",
        "force_xx.png",
        "mesh.png",
        "von_mises_middle.png",
    } <= names
    file = meshio.read(tmp_path / "result.vtu")
    assert file.cells[0].type == "triangle6"
    tip = np.argmin(np.linalg.norm(file.points - result.probe("tip")["x"], axis=1))
    assert file.point_data["displacement"][tip] == pytest.approx(result.probe("tip")["u"], rel=1e-9)
    # mid-edge nodes move as the solution does, not as the mean of the ends
    ends, middle = result.mesh.edges, result.edge_fields["displacement"]
    mean = result.fields["displacement"][ends].mean(axis=1)
    assert 1e-4 < np.abs(middle - mean).max() < 0.2
    assert result.at(result.mesh.midpoints[:5])["u"] == pytest.approx(middle[:5], abs=1e-6)
    axes = result.plot("deflection").axes[0]
    assert (axes.get_xlabel(), axes.get_zlabel()) == ("x", "z")
    with pytest.raises(ks.InputError, match="the pictures are"):
        result.plot("shear")
    real = builtins.__import__

    def without_pyvista(name, *rest, **more):
        if name == "pyvista":
            raise ImportError("No module named 'pyvista'")
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without_pyvista)
    with pytest.raises(ks.InputError, match=r"pip install kshell\[view\]"):
        result.show()


CONTRARY = [
    ({"element": "morley", "model": "shell"}, "is for plates"),
    ({"element": "koiter", "model": "plate"}, "belongs to model"),
    ({"element": "argyris", "order": 2}, "one order only"),
    ({"element": "argyris", "model": "shell"}, "on a chart only"),
    ({"order": 2, "model": "plate"}, "koiter"),
    ({"solver": "multigrid", "model": "shell"}, "multigrid"),
]


@pytest.mark.parametrize(("options", "words"), CONTRARY)
def test_options_that_contradict_each_other(options, words):
    with pytest.raises(ks.InputError, match=words):
        ks.solve(plate(), **options)


def test_chart_needs_a_flat_mesh_and_places_are_in_space():
    scene = ks.Scene.load(MESHES / "tube.toml")
    with pytest.raises(ks.InputError, match="parameter plane"):
        ks.solve(dataclasses.replace(scene, mesh=MESHES / "scordelis_lo.msh"))
    with pytest.raises(ks.InputError, match="chart"):
        ks.solve(scene, model="plate")
    supports = [*scene.supports, ks.Fixed((0, 1, 1), "z")]
    a = ks.solve(dataclasses.replace(scene, supports=supports))
    assert a.probe("end")["x"][0] == pytest.approx(1.0)
    assert a.mesh.points[:, 2].max() == pytest.approx(1.0)
    assert np.linalg.norm(a.mesh.midpoints[:, :2], axis=1) == pytest.approx(1.0)


CARBON = ks.Orthotropic(E1=140e9, E2=10e9, nu12=0.3, G12=5e9)


def test_material_axes_follow_a_direction_on_the_surface():
    """A tube with fibres along its axis z or around it, pulled along z: the axis counts from the direction given."""
    scene = ks.Scene.load(MESHES / "tube.toml", ["load.0.value=[0, 0, -1]"])
    supports = [ks.Symmetry("cuts"), ks.Symmetry("far")]
    scene = dataclasses.replace(scene, supports=supports, material=CARBON)
    stretch = {}
    for angle in (0.0, 90.0):
        material = dataclasses.replace(CARBON, angle=angle)
        result = ks.solve(dataclasses.replace(scene, material=material, direction=(0, 0, 1)))
        assert not result.warnings
        stretch[angle] = result.probe("end")["u"][2]
    assert stretch[0.0] == pytest.approx(-1 / (0.01 * 140e9), rel=2e-3)
    assert stretch[90.0] == pytest.approx(-1 / (0.01 * 10e9), rel=2e-3)
    assert any("x is nearly normal" in words for words in ks.solve(scene).warnings)
    drawn = ks.solve(dataclasses.replace(scene, direction=(0, 0, 1))).plot("mesh")
    assert "material axis 1: 0 degrees" in [text.get_text() for text in drawn.legends[0].get_texts()]


def test_view_has_curved_triangles():
    from kshell.view import surface_grid

    result = ks.solve(ks.Scene.load(MESHES / "scordelis_lo.toml"))
    grid = surface_grid(result, 10.0)
    assert grid.n_cells == len(result.mesh.triangles)
    assert set(grid.celltypes) == {22}  # quadratic triangles
    assert grid.area == pytest.approx(25 * np.radians(40) * 25, rel=0.05)


@pytest.mark.parametrize(
    ("name", "options"), [("raasch_hook", {}), ("tube", {}), ("tube", {"element": "koiter"})]
)
def test_prescribed_motion_of_all_supports_carries_the_shell_along(name, options):
    scene = ks.Scene.load(MESHES / f"{name}.toml")
    on = {"raasch_hook": ["root", "tip"], "tube": ["end", "far"]}[name]
    shift = [1e-3, -2e-3, 3e-3]
    scene = dataclasses.replace(scene, supports=[ks.Clamped(on, shift)], loads=[])
    result = ks.solve(scene, **options)
    assert result.fields["displacement"] == pytest.approx(
        np.tile(shift, (len(result.mesh.points), 1)), abs=1e-10
    )
    assert result.strain_energy < 1e-16 * result.scene.material.E
    assert not result.warnings


def two_panels(**changes):
    """Two squares apart from each other, each with a group for its left side."""
    a, b = panel((0, 0, 0), (1, 0, 0), (0, 1, 0)), panel((3, 0, 0), (1, 0, 0), (0, 0, 1))
    points, triangles = np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1] + len(a[0])])
    plain = ks.Mesh(points, triangles.astype(np.int32))
    x = points[plain.edges][:, :, 0]
    groups = {n: plain.edges[(np.abs(x - v) < 1e-9).all(axis=1)] for n, v in (("one", 0.0), ("two", 3.0))}
    data = {"mesh": ks.Mesh.from_arrays(points, triangles, groups), "thickness": 0.01, "material": STEEL}
    return ks.Scene(**{**data, "loads": [ks.Pressure(1.0)], **changes})


def test_loose_parts_are_named():
    with pytest.raises(
        ks.InputError, match=r"part of 8 triangles around \(3.5, 0, 0.5\), one of 2 parts.*not held"
    ):
        ks.solve(two_panels(supports=[ks.Clamped("one")]))
    with pytest.raises(ks.InputError, match=r"one of 2 parts.*move along x; it can move along y"):
        ks.solve(two_panels(supports=[ks.Clamped("one"), ks.Fixed("two", "zr")]))
    assert ks.solve(two_panels(supports=[ks.Clamped(["one", "two"])])).balance < 1e-9


def test_orientation_is_repaired_and_said_and_one_sided_strips_are_refused():
    points, triangles = panel((0, 0, 0), (1, 0, 0.2), (0, 1, 0), 3)
    mixed = triangles.copy()
    mixed[::3] = mixed[::3, ::-1]
    shells = [
        ks.Scene(
            mesh=ks.Mesh.from_arrays(points, t), thickness=0.01, material=STEEL,
            supports=[ks.SimplySupported(tuple(p)) for p in points[[0, 3, -1]]],
            loads=[ks.Pressure(1.0)], probes={"p": points[5]},
        )
        for t in (triangles, mixed)
    ]  # fmt: skip
    good, repaired = (ks.solve(scene) for scene in shells)
    assert repaired.probe("p")["u"] == pytest.approx(good.probe("p")["u"], rel=1e-8)
    assert any("6 of 18 triangles reversed" in words for words in repaired.model["reasons"])
    moebius = strip(1)
    with pytest.raises(ks.InputError, match="one-sided"):
        ks.Mesh.from_arrays(moebius.points, moebius.triangles)


def test_plane_chart_with_argyris_is_the_argyris_plate():
    scene = plate(loads=[ks.Pressure("1e3*(1 + x)"), ks.PointForce((0.25, 0.5, 0), (0, 0, 50.0))])
    expected, found = ks.solve(scene), ks.solve(dataclasses.replace(scene, chart=ks.geometry.Plane()))
    assert (expected.model["element"], found.model["element"]) == ("argyris", "argyris")
    assert (expected.model["kind"], found.model["kind"]) == ("plate", "shell")
    for name in ("p", "q"):
        for key in ("u", "rotation", "M", "stress_bottom"):
            size = np.abs(expected.probe(name)[key]).max()
            assert found.probe(name)[key] == pytest.approx(expected.probe(name)[key], abs=1e-6 * size)
    assert found.strain_energy == pytest.approx(expected.strain_energy, rel=1e-8)
    # the plate weights its means at vertices by area
    assert found.fields["moment"] == pytest.approx(
        expected.fields["moment"], abs=0.2 * expected.fields["moment"].max()
    )
