"""Shells answer alike in all units and directions: only lengths and axes change, stresses do not."""

import numpy as np
import pytest

import kshell as ks
from tests.shell.moved import TURNS, moved
from tests.shell.shell_scenes import MESHES

SCENES = (
    "scordelis_lo", "pinched_cylinder", "hemisphere", "hemisphere_hole", "raasch_hook", "twisted_beam",
    "twisted_beam_thin", "hypar", "hypar_thin", "pressurised_sphere", "tube", "box_girder", "sphere_edge",
)  # fmt: skip
SCALES = (1e-9, 1e-6, 1e5, 1e9)


def _alike(name, scale, turn, tolerance=2e-9):
    scene = ks.Scene.load(MESHES / f"{name}.toml")
    here = ks.solve(scene, large_deflection=False)
    there = ks.solve(moved(scene, scale, turn), large_deflection=False)
    assert (here.model["element"], here.model["order"]) == (there.model["element"], there.model["order"])
    assert len(here.warnings) == len(there.warnings)
    for probe, values in here.probes.items():
        u = turn.T @ there.probes[probe]["u"] / scale
        assert u == pytest.approx(values["u"], rel=tolerance, abs=tolerance * np.abs(values["u"]).max())
    assert there.strain_energy / scale**3 == pytest.approx(here.strain_energy, rel=tolerance)
    largest = [result.extremes["von_mises"]["value"] for result in (here, there)]
    assert largest[1] == pytest.approx(largest[0], rel=tolerance)
    assert there.balance < 1e-8


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(("scale", "turn"), [(1e-9, "a milliradian"), (1e9, "any")])
def test_units_and_turns(name, scale, turn):
    _alike(name, scale, TURNS[turn])


@pytest.mark.full
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("turn", TURNS)
def test_units_with_turns(name, scale, turn):
    _alike(name, scale, TURNS[turn])


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("order", [1, 3])
def test_what_holds_a_shell_has_no_unit(scale, order):
    """Clamped along one line it is held; supported there it turns about it, which is said."""
    hook = moved(ks.Scene.load(MESHES / "raasch_hook.toml"), scale)
    ks.solve(hook, order=order, large_deflection=False)
    turning = moved(ks.Scene.load(MESHES / "raasch_hook.toml", ["support.0.kind=simply_supported"]), scale)
    with pytest.raises(ks.InputError, match=r"can move as a rigid body freely: it can turn about the axis"):
        ks.solve(turning, order=order, large_deflection=False)


@pytest.mark.parametrize("turn", TURNS)
def test_symmetry_is_what_it_holds(turn):
    """A plane of symmetry through a straight line on a curved surface, against the freedoms that it holds."""
    q = TURNS[turn]
    scene = ks.Scene.load(MESHES / "pinched_cylinder.toml")
    normals = {"middle": "y", "side": "x", "top": "x"}
    mesh = scene.read_mesh()
    for name in normals:  # the plane of each
        x = mesh.points[mesh.edges[mesh.groups[name].members]].reshape(-1, 3)
        normals[name] = "xyz"[int(np.argmin(np.abs(x).max(axis=0)))]
    held = [ks.Fixed(name, letter + "r") for name, letter in normals.items()]
    others = [support for support in scene.supports if support.kind != "symmetry"]
    by_freedoms = ks.solve(
        ks.Scene(
            mesh=mesh, thickness=scene.thickness, material=scene.material, supports=[*held, *others],
            loads=scene.loads, probes=scene.probes,
        ),
        large_deflection=False,
    )  # fmt: skip
    turned = ks.solve(moved(scene, 1.0, q), large_deflection=False)
    assert q.T @ turned.probe("force")["u"] == pytest.approx(
        by_freedoms.probe("force")["u"], rel=1e-9, abs=1e-14
    )
