"""Argyris on charts against Koiter of order 3 on the same surface: supports, springs, loads."""

import dataclasses

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.halve import halved
from tests.shell.shapes import rectangle
from tests.shell.shell_scenes import MESHES

TURNED = ((0.6, 0.0, 0.8), (0.0, 1.0, 0.0), (-0.8, 0.0, 0.6))
HALF = np.sqrt(0.5)
RADIAL = ((HALF, HALF, 0), (-HALF, HALF, 0), (0, 0, 1))
CUTS = [ks.Symmetry("cuts")]
DEAD = [ks.Traction((0, 0.3, -1e-6))]
PULLED = [ks.Traction(("1e-6*x", "2e-6*y", "1e-6*x*y"))]
BENT = [ks.LineForce("end", ("1e-6*x", "2e-6*y", "1e-6*x*y"))]
CLAMPED = [ks.Clamped("far")]

# supports, loads, tolerance
CASES = {
    "spring on a curve": ([*CUTS, ks.Elastic("end", "1e-3*(1 + x)", "xz"), ks.Fixed("far", "z")], BENT, 2e-3),
    "spring on the surface": ([*CUTS, ks.Elastic("tube", "2e-2 + 1e-2*z", "xyz")], BENT, 2e-3),
    "springs at points": (
        [*CLAMPED, ks.Elastic((1, 0, 0), 1e-3, "x"), ks.Elastic((0, 1, 0), 2e-3, "yz")], BENT, 5e-3,
    ),
    "rotation spring": ([*CUTS, ks.Fixed("end", "xy"), ks.Fixed("far", "xyz"), ks.Elastic("far", 1e-3, "r")],
        [ks.Pressure(1e-6)], 2e-3,
    ),
    "point moment": (CLAMPED, [ks.PointMoment((1, 0, 0), (0, 1e-6, 0)), ks.PointMoment((0, 1, 0), (0, 0, 1e-6))], 2e-2),
    "own axes": ([ks.Fixed("far", "xyzr"), ks.Fixed("end", "x", axes=TURNED)], DEAD, 2e-3),
    "own axes at a point": (
        [*CLAMPED, ks.Fixed((HALF, HALF, 0), "x", axes=RADIAL, value=(1e-3 * HALF, 1e-3 * HALF, 0))], [], 5e-3,
    ),
    "motion along a curve": ([*CLAMPED, ks.Fixed("end", "xyz", value=("1e-3*x*y", "1e-3*sin(2*y)", 1e-3))], [], 2e-3),
    "rigid motion": (
        [ks.Fixed(["end", "far"], "xyz", value=("1e-3*y", "-1e-3*x", 1e-3))], [], 1e-6,
    ),
    "surface": ([*CUTS, ks.Fixed("tube", "z")], PULLED, 2e-3),
    "surface in own axes": ([*CLAMPED, ks.Fixed("tube", "z", axes=TURNED)], PULLED, 2e-3),
    "surface moved": ([*CUTS, ks.Fixed("tube", "z", value=(0, 0, 1e-4))], PULLED, 2e-3),
}  # fmt: skip


def tube(n, supports, loads):
    scene = ks.Scene.load(MESHES / "tube.toml")
    mesh = scene.chart.parameter_mesh(n, n, ("cuts", "cuts", "end", "far"), (0, np.pi / 2), (0, 1))
    groups = {
        name: (mesh.edges if g.dimension == 1 else mesh.triangles)[g.members]
        for name, g in mesh.groups.items()
    }
    groups |= {"tube": mesh.triangles}
    mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups)
    probes = {"a": (1, 0, 0), "b": (np.sqrt(0.5), np.sqrt(0.5), 0), "c": (0.8, 0.6, 0.3)}
    return dataclasses.replace(scene, mesh=mesh, thickness=0.1, supports=supports, loads=loads, probes=probes)


@pytest.mark.parametrize("name", CASES)
def test_argyris_agrees_with_koiter(name):
    supports, loads, tolerance = CASES[name]
    scene = tube(8, supports, loads)
    found = [
        ks.solve(scene, large_deflection=False, **options)
        for options in ({"element": "argyris"}, {"element": "koiter", "order": 3})
    ]
    u = [np.concatenate([r.probe(p)["u"] for p in "abc"]) for r in found]
    np.testing.assert_allclose(u[0], u[1], atol=tolerance * np.abs(u[1]).max())
    energy = [r.strain_energy for r in found]
    if name == "rigid motion":
        scale = 0.1 * 1e-6
        assert max(energy) < 1e-9 * scale
        return
    assert energy[0] == pytest.approx(energy[1], rel=max(5 * tolerance, 1e-2))
    assert found[0].balance < 1e-7
    assert found[0].external_work == pytest.approx(energy[0], rel=1e-6)
    assert found[0].reactions.keys() == found[1].reactions.keys()
    if name.startswith("surface"):
        return  # which of two supports carries what both hold is a matter of words
    for label, mine in found[0].reactions.items():
        other = found[1].reactions[label]
        size = max(np.abs([r["force"], r["moment"]]).max() for r in found[1].reactions.values())
        np.testing.assert_allclose(mine["force"], other["force"], atol=3e-2 * size)
        np.testing.assert_allclose(mine["moment"], other["moment"], atol=3e-2 * size)


def test_springs_alone_carry_a_rigid_shell():
    """A load along z on soft springs of stiffness k: u = F / (k area), whatever the shell."""
    scene = tube(4, [ks.Elastic("tube", 1e-9, "xyz")], [ks.Traction((0, 0, 2e-9))])
    for element in ("argyris", "koiter"):
        u = ks.solve(scene, element=element, large_deflection=False).fields["displacement"]
        np.testing.assert_allclose(u, np.broadcast_to([0, 0, 2.0], u.shape), atol=1e-5)


def test_auto_keeps_argyris_for_what_it_has_now():
    supports, loads, _ = CASES["spring on the surface"]
    result = ks.solve(
        tube(4, supports, [*loads, ks.Temperature(mean=1.0, expansion=1e-5)]), large_deflection=False
    )
    assert result.model["element"] == "argyris"


def test_moments_on_coarse_charts_balance_as_turns_are_followed():
    """Two triangles do not follow a turn of a cone: the warning says so, and finer ones do."""
    balance = []
    for n in (1, 2, 4):
        mesh = rectangle(n, n, 0.0, 1.0, 0.2, 0.8)
        held = mesh.edges[(np.abs(mesh.points[mesh.edges][:, :, 0]) < 1e-9).all(axis=1)]
        mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"held": held, "all": mesh.triangles})
        scene = ks.Scene(
            mesh, chart=ks.geometry.Cone(), thickness=0.003, material=ks.Isotropic(E=2e11, nu=0.3),
            supports=[ks.Clamped("held")], loads=[ks.Pressure(1e4)],
        )  # fmt: skip
        result = ks.solve(scene, large_deflection=False, element="argyris")
        balance.append(result.balance)
        said = [words for words in result.warnings if words.startswith("loads and reactions differ")]
        assert len(said) == (result.balance > 1e-6)
        assert all("follow a turn of the chart" in words and "koiter" in words for words in said)
    assert balance[0] > 1e-6
    assert balance[2] < 1e-3 * balance[0]


@pytest.mark.full
def test_small_components_of_probes_on_charts():
    """A tip that moves along x and y, and little along z: the interval of z knows how far x and y are off."""
    a = 0.6257
    mesh = rectangle(5, 3, 0.0, a, 0.0, 1.0)
    held = mesh.edges[(np.abs(mesh.points[mesh.edges][:, :, 0]) < 1e-9).all(axis=1)]
    mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"held": held, "all": mesh.triangles})
    scene = ks.Scene(
        mesh, chart=ks.geometry.Cylinder(1.0), thickness=0.003, material=ks.Isotropic(E=2e11, nu=0.0),
        supports=[ks.Clamped("held")], loads=[ks.Pressure("1e4*(1+x+z*y)")],
        probes={"p": (np.cos(a), np.sin(a), 0.5)},
    )  # fmt: skip
    result = ks.solve(scene, large_deflection=False, element="argyris")
    finer = dataclasses.replace(scene, mesh=halved(halved(mesh)))
    exact = ks.solve(finer, large_deflection=False, element="koiter", order=5)
    width = [np.array(r.error["probes"]["p"]["u"]["half_width"]) for r in (result, exact)]
    off = np.abs(np.subtract(result.probe("p")["u"], exact.probe("p")["u"]))
    assert (off <= width[0] + width[1]).all()
    assert width[0].max() < 1e-4 * np.abs(result.probe("p")["u"]).max()
