"""Shell scenes that are wrong or doubtful: each is named, with its place and how to mend it."""

import dataclasses

import numpy as np
import pytest

import kshell as ks
from tests.shell.shapes import panel, strip
from tests.shell.shell_scenes import MESHES, STEEL, cantilever_of_two, plate, two_panels

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
    flat = dataclasses.replace(roof.read_mesh(), midpoints=None)
    faceted = dataclasses.replace(roof, mesh=flat, facets="flat")
    result = ks.solve(faceted)
    assert any(
        "flat triangles" in words and "2.9 degrees" in words and 'facets = "flat"' in words
        for words in result.warnings
    )
    assert result.mesh.midpoints is None
    assert not any(
        "flat triangles" in words for words in ks.solve(dataclasses.replace(roof, mesh=flat)).warnings
    )
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


CONTRARY = [
    ({"element": "morley", "model": "shell"}, "is for plates"),
    ({"element": "argyris", "order": 2}, "one order only"),
    ({"element": "argyris", "model": "shell"}, "on a chart only"),
    ({"element": "hhj", "model": "shell"}, "hhj"),
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


ONLY_SHELLS = {
    "hinge": {"supports": [ks.Clamped("left"), ks.Hinge("right")]},
    "offset": {"offset": 1e-3},
    "direction": {"direction": (0, 1, 0)},
}


@pytest.mark.parametrize("changes", ONLY_SHELLS.values(), ids=ONLY_SHELLS)
def test_what_plates_do_not_have_is_refused_not_ignored(changes):
    with pytest.raises(ks.InputError, match="is for shells"):
        ks.solve(plate(**changes), model="plate")


ONLY_KOITER = {
    "varying over a surface": (
        {
            "supports": [ks.Clamped("end"), ks.Fixed("tube", "z", value=(0, 0, "1e-3*z"))],
            "loads": [ks.Pressure(1.0)],
        },
        "varies over a surface",
    ),
    "rotation of a surface": (
        {"supports": [ks.Clamped("end"), ks.Fixed("tube", "zr")], "loads": [ks.Pressure(1.0)]},
        "hold the rotation on curves",
    ),
}


@pytest.mark.parametrize(("changes", "words"), ONLY_KOITER.values(), ids=ONLY_KOITER)
def test_what_argyris_on_a_chart_does_not_have_is_named_and_koiter_has_it(changes, words):
    scene = ks.Scene.load(MESHES / "tube.toml")
    mesh = scene.read_mesh()
    groups = {name: mesh.edges[group.members] for name, group in mesh.groups.items() if group.dimension == 1}
    groups |= {"tube": mesh.triangles}
    scene = dataclasses.replace(
        scene, mesh=ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups), **changes
    )
    with pytest.raises(ks.InputError, match=words) as caught:
        ks.solve(scene, element="argyris")
    assert "koiter" in str(caught.value)
    assert np.abs(ks.solve(scene, element="koiter").fields["displacement"]).max() > 0
