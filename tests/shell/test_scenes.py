"""Shells from scene files and gmsh meshes: the references of shipped scenes, and answers known otherwise."""

import dataclasses
import json

import numpy as np
import pytest

import kshell as ks
from kshell.cli.commands import run
from tests.scene.fabricated import square_mesh
from tests.shell import revolution
from tests.shell.shapes import joined, panel
from tests.shell.shell_scenes import MESHES, STEEL, cantilever_of_two, plate

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
    ("hypar", [], "tip", 2, -9.31454e-5, 1e-5),
    ("hypar", ["thickness=0.001"], "tip", 2, -6.39719e-3, 3e-4),
    ("hypar_thin", [], "tip", 2, -6.39719e-3, 3e-4),
    ("twisted_beam_thin", [], "tip", 0, 1.2928e-3, 1e-4),
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


EDGES = [
    ("tube", "end", revolution.tube, 1.0, "argyris", 1e-4),
    ("tube", "end", revolution.tube, 1.0, "koiter", 2e-2),
    ("sphere_edge", "rim", revolution.sphere, np.pi / 3, "argyris", 1e-4),
    ("sphere_edge", "rim", revolution.sphere, np.pi / 3, "koiter", 2e-2),
]


@pytest.mark.parametrize(("name", "probe", "meridian", "length", "element", "tolerance"), EDGES)
def test_edge_solutions(name, probe, meridian, length, element, tolerance):
    """Force and moment along the edge of a tube and of a sphere, against an independent solution of one dimension."""
    exact = revolution.edge_flexibility(meridian, length, 0.01)
    assert exact[0, 0] == pytest.approx({"tube": 2571.96514, "sphere_edge": 2570.42063}[name], rel=1e-8)
    for column, load in enumerate(([], ["load.0.kind=edge_moment", "load.0.value=1e-6"])):
        scene = ks.Scene.load(MESHES / f"{name}.toml", [*load, f"solve.element={element}"])
        found = ks.solve(scene).probe(probe)
        assert abs(found["u"][0]) == pytest.approx(1e-6 * abs(exact[0, column]), rel=tolerance)
        assert abs(found["rotation"][1]) == pytest.approx(1e-6 * abs(exact[1, column]), rel=tolerance)


def test_sphere_under_pressure_from_the_command_line(tmp_path):
    assert run(["solve", str(MESHES / "pressurised_sphere.toml"), "--json", str(tmp_path / "r.json")]) == 0
    document = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    probe = document["probes"]["middle"]
    assert np.linalg.norm(probe["u"]) == pytest.approx(35e-4 * (1 - 1e-4 / 12), rel=1e-3)
    assert probe["N"] == pytest.approx([5e-5, 5e-5, 0.0], abs=2e-7)
    assert "tangent plane" in probe["frame"]
    # the cut carries the pressure on a quarter disc in each direction
    assert document["reactions"]["cuts"]["force"] == pytest.approx([-1e-4 * np.pi / 4] * 3, rel=1e-4)
    assert document["energies"]["membrane"] > 1e3 * document["energies"]["bending"]
    assert document["model"] == {
        "kind": "shell", "large_deflection": False, "element": "koiter", "order": 3,
        "reasons": document["model"]["reasons"],
    }  # fmt: skip


def test_every_order_on_the_command_line(tmp_path, capsys):
    for order, error in (("1", 6e-3), ("2", 2e-3), ("3", 5e-4)):
        out = tmp_path / f"{order}.json"
        assert run(["solve", str(MESHES / "raasch_hook.toml"), "--order", order, "--json", str(out)]) == 0
        assert json.loads(out.read_text(encoding="utf-8"))["probes"]["tip"]["u"][1] == pytest.approx(
            4.558, rel=error
        )
    assert run(["check", str(MESHES / "raasch_hook.toml")]) == 0
    assert "koiter" in capsys.readouterr().out


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
        assert found.probe("tip")["u"][2] == pytest.approx(1e-3 / 64, rel=2e-4)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
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
        "along": ks.solve(plate(loads=[ks.LineForce("right", (1.0, 0, 0))])),
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


def test_hinge_releases_the_rotation():
    """Beyond the hinge the second strip only follows: the first is a cantilever with its tip force."""
    result = ks.solve(cantilever_of_two())
    stiffness = 210e9 * 0.01**3 / 12
    assert result.probe("joint")["u"][2] == pytest.approx(-10.0 / (3 * stiffness), rel=1e-6)
    assert result.reactions["c"]["force"] == pytest.approx([0, 0, 0], abs=1e-6)


def test_symmetric_half_of_the_girder_is_half_of_the_whole():
    """Reactions: the end carries the load, the plane of symmetry only bending."""
    result = ks.solve(ks.Scene.load(MESHES / "box_girder.toml"))
    assert result.reactions["end"]["force"] == pytest.approx([0, 0, 20000.0], abs=1e-3)
    assert result.reactions["middle"]["moment"][1] == pytest.approx(-40000.0, rel=1e-6)  # 20000 times 2
    assert result.cell_fields["thickness"].min() == 0.01
    assert result.cell_fields["thickness"].max() == 0.02


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


def test_plane_chart_with_argyris_is_the_argyris_plate():
    scene = plate(
        loads=[ks.Pressure("1e3*(1 + x)"), ks.PointForce((0.25, 0.5, 0), (0, 0, 50.0))],
        probes={
            "p": (0.53, 0.48, 0.0),
            "q": (0.81, 0.3, 0.0),
        },  # inside triangles: on edges a plate takes the mean
    )
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
