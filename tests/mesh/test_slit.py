"""Meshes cut open along curves: vertices, lips, groups, and what is computed on them."""

import numpy as np
import pytest

import kshell as ks
from kshell.verify.cases import large_scenes


def square(n=6, cuts=()):
    """A unit square with alternating diagonals; cuts are (axis, place, low, high) of groups c0, c1, ..."""
    mesh = large_scenes.rectangle(1.0, 1.0, n, n)
    groups = {name: mesh.edges[group.members] for name, group in mesh.groups.items() if group.dimension == 1}
    ends = mesh.points[mesh.edges]
    for number, (axis, place, low, high) in enumerate(cuts):
        along = ends[:, :, 1 - axis]
        on = (np.abs(ends[:, :, axis] - place) < 1e-9).all(axis=1)
        on &= (along > low - 1e-9).all(axis=1) & (along < high + 1e-9).all(axis=1)
        groups[f"c{number}"] = mesh.edges[on]
    return ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups)


def euler(mesh):
    return len(mesh.points) - len(mesh.edges) + len(mesh.triangles)


INNER, ACROSS, TO_EDGE = (0, 0.5, 1 / 6, 5 / 6), (1, 0.5, 1 / 6, 5 / 6), (0, 0.5, 0.5, 1.0)


@pytest.mark.parametrize(
    ("cuts", "vertices", "number"),
    [
        ([INNER], 49 + 3, 0),  # two tips: one vertex each
        ([INNER, ACROSS], 49 + 7, 0),  # at the crossing four fans
        ([TO_EDGE], 49 + 3, 1),  # one tip, one end on the boundary
        ([(0, 0.5, 0.0, 1.0)], 49 + 7, 2),  # two pieces
    ],
)
def test_tips_crossings_and_ends(cuts, vertices, number):
    mesh = square(cuts=cuts)
    names = [f"c{k}" for k in range(len(cuts))]
    cut = ks.slit(mesh, names)
    assert len(cut.points) == vertices
    assert euler(cut) == number
    assert np.array_equal(cut.points[: len(mesh.points)], mesh.points)
    assert cut.areas == pytest.approx(mesh.areas)
    for name in names:
        plus, minus, both = (cut.groups[name + sign].members for sign in ("+", "-", ""))
        assert len(plus) == len(minus) == len(mesh.groups[name].members)
        assert set(plus) | set(minus) == set(both)
        assert (cut.edge_counts[both] == 1).all()
    outside = sum(len(cut.groups[name].members) for name in ("x0", "x1", "y0", "y1"))
    assert outside == 4 * 6


def test_nodes_of_order_two_are_copied():
    mesh = square(cuts=[(0, 0.5, 0.0, 1.0)])
    middle = mesh.points[mesh.edges].mean(axis=1) + [0, 0, 0.01]
    curved = ks.Mesh.from_arrays(
        mesh.points, mesh.triangles, {"c0": mesh.edges[mesh.groups["c0"].members]}, middle
    )
    cut = ks.slit(curved, "c0")
    assert cut.midpoints == pytest.approx(cut.points[cut.edges].mean(axis=1) + [0, 0, 0.01])


def test_what_is_no_cut_is_refused():
    mesh = square(cuts=[INNER])
    for on, words in (("x0", "boundary"), ("c9", "c9"), ("nothing", "nothing")):
        with pytest.raises(ks.InputError, match=words):
            ks.slit(mesh, on)
    with pytest.raises(ks.InputError, match="group of curves"):
        ks.Scene(mesh=mesh, thickness=0.01, material=ks.Isotropic(E=1e9, nu=0.3), cuts=[3])


def plate(mesh, **changes):
    given = {
        "mesh": mesh,
        "thickness": 0.01,
        "material": ks.Isotropic(E=1e9, nu=0.3, density=1000),
        "supports": [ks.Clamped(["x0", "x1"])],
        "loads": [ks.Pressure(100.0)],
        "probes": {"side": (0.25, 0.5, 0)},
    }
    return ks.Scene(**{**given, **changes})


@pytest.mark.parametrize("options", [{}, {"model": "shell"}, {"element": "hhj", "order": 3}])
def test_a_plate_cut_in_two_is_two_cantilevers(options):
    """Every model bends each half by itself."""
    mesh = square(cuts=[(0, 0.5, 0.0, 1.0)])
    half = large_scenes.rectangle(0.5, 1.0, 3, 6)
    found = ks.solve(plate(mesh, cuts="c0"), large_deflection=False, **options).probe("side")["u"]
    alone = ks.solve(plate(half, supports=[ks.Clamped("x0")]), large_deflection=False, **options)
    assert found == pytest.approx(alone.probe("side")["u"], rel=2e-2, abs=1e-12)
    whole = ks.solve(plate(mesh), large_deflection=False, **options).probe("side")["u"]
    assert found[2] > 1.9 * whole[2]


def test_cut_in_scene_files_and_other_analyses(tmp_path):
    from kshell.mesh import write_msh

    mesh = square(cuts=[INNER])
    write_msh(mesh, tmp_path / "m.msh")
    (tmp_path / "s.toml").write_text(
        'mesh = "m.msh"\nthickness = 0.01\n[material]\nE = 1e9\nnu = 0.3\ndensity = 1000\n'
        '[[support]]\non = ["x0", "x1"]\nkind = "clamped"\n[[cut]]\non = "c0"\n',
        encoding="utf-8",
    )
    scene = ks.Scene.load(tmp_path / "s.toml")
    assert len(scene.read_mesh().points) == 52
    first = ks.modes(scene, count=1).eigen[0]["value"]
    whole = ks.modes(plate(mesh, loads=[]), count=1).eigen[0]["value"]
    assert 0 < first < 0.95 * whole
    (tmp_path / "t.toml").write_text(
        (tmp_path / "s.toml").read_text(encoding="utf-8") + "at_time = 0.2\n", encoding="utf-8"
    )
    with pytest.raises(ks.InputError, match="at_time"):
        ks.Scene.load(tmp_path / "t.toml")
