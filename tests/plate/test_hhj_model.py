"""Scenes solved with element = "hhj": fields, reactions, the frame of models, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from kshell.analysis.models import model_of
from kshell.verify.cases.meshes import l_shape as graded
from tests.plate.hhj_cases import MATERIAL, square
from tests.plate.plates import annulus, disk

STRIP = ks.Isotropic(E=12.0, nu=0.0, density=1.0)  # D = 1


def scene(supports, loads, n=4, material=MATERIAL, **more):
    return ks.Scene(mesh=square(n), thickness=1.0, material=material, supports=supports, loads=loads, **more)


def test_a_strip_bends_as_a_beam():
    """Clamped at x = 0, force 1 per length at x = 1: w = x^2 (3 - x) / 6, a cubic that order 3 has."""
    made = scene(
        [ks.Clamped("left")],
        [ks.LineForce("right", (0, 0, 1.0))],
        material=STRIP,
        probes={"p": (0.4, 0.3, 0.0)},
    )
    found = ks.solve(made, element="hhj", order=3, large_deflection=False)
    x = 0.4
    p = found.probe("p")
    assert p["u"][2] == pytest.approx(x**2 * (3 - x) / 6, abs=1e-13)
    assert p["rotation"] == pytest.approx([0, -(x - x**2 / 2), 0], abs=1e-12)
    assert p["M"] == pytest.approx([-(1 - x), 0, 0], abs=1e-11)
    assert p["stress_top"] == pytest.approx([-6 * (1 - x), 0, 0], abs=1e-10)
    assert found.evaluate(np.array([[x, 0.3, 0.0]]))["Q"][0] == pytest.approx([1, 0], abs=1e-10)
    assert found.fields["shear"][:, 0] == pytest.approx(np.ones(25), abs=1e-9)
    assert found.strain_energy == pytest.approx(1 / 6, rel=1e-12)
    assert found.external_work == pytest.approx(1 / 6, rel=1e-12)
    assert found.reactions["left"]["force"] == pytest.approx([0, 0, -1], abs=1e-12)
    assert found.reactions["left"]["moment"] == pytest.approx([-0.5, 1, 0], abs=1e-12)
    assert found.balance < 1e-12
    assert found.model["element"] == "hhj"
    assert found.model["order"] == 3


PLATES = {
    "supported": ([ks.SimplySupported("edge")], [ks.Pressure("1+x")]),
    "springs": ([ks.Elastic("left", 30.0, "zr"), ks.SimplySupported("right")], [ks.Pressure(1.0)]),
    "moments": (
        [ks.SimplySupported("left"), ks.SimplySupported("right")],
        [ks.EdgeMoment("right", 1.0), ks.EdgeMoment("left", 0.5)],
    ),
    "symmetry": (
        [ks.SimplySupported("left"), ks.Symmetry("right"), ks.SimplySupported("top")],
        [ks.Pressure(1.0)],
    ),
}


@pytest.mark.parametrize("name", PLATES)
def test_same_answers_as_argyris(name):
    made = scene(*PLATES[name], n=6, probes={"p": (0.4, 0.3, 0.0)})
    argyris = ks.solve(made, element="argyris", large_deflection=False)
    found = ks.solve(made, element="hhj", order=5, large_deflection=False)
    for quantity, off in (("u", 1e-5), ("rotation", 1e-3), ("M", 1e-2), ("stress_bottom", 1e-2)):
        expected = argyris.probe("p")[quantity]
        assert np.abs(found.probe("p")[quantity] - expected).max() < off * np.abs(expected).max()
    assert found.strain_energy == pytest.approx(argyris.strain_energy, rel=1e-3)
    assert list(found.reactions) == list(argyris.reactions)
    total = sum(np.abs(r["force"]).sum() + np.abs(r["moment"]).sum() for r in argyris.reactions.values())
    for label, reaction in argyris.reactions.items():
        for part in ("force", "moment"):
            assert np.abs(found.reactions[label][part] - reaction[part]).max() < 0.02 * total
    assert found.balance < 1e-11


def test_frame_of_models():
    """Matrix, product, load vectors and prescribed motion belong together; loads and motion scale."""
    supports = [ks.Clamped("left"), ks.Fixed("right", "z", value=(0, 0, "0.1*y"))]
    made = scene(supports, [ks.Pressure(1.0), ks.InitialCurvature((0.1, 0, 0.2))], n=3)
    model = model_of(made, element="hhj", order=4)
    stiffness = model.stiffness().toarray()
    q = np.random.default_rng(0).standard_normal(model.unknowns)
    assert np.abs(model.product()(q) - stiffness @ q).max() < 1e-10 * np.abs(stiffness @ q).max()
    factors, motion = (2.0, -1.0), 0.5
    right = np.array(factors) @ model.load_vectors() + motion * model.motion_vector()
    x = model.under(factors, motion).solve().x
    own = model.expand(np.linalg.solve(stiffness, right))
    held = np.abs(model.expand(np.ones(model.unknowns))) == 0
    assert np.abs((x - own)[~held]).max() < 1e-10 * np.abs(x).max()
    assert x[: len(made.read_mesh().points)].max() == pytest.approx(0.05, rel=1e-12)
    fields = model.motion_fields(x)
    assert fields["displacement"].shape == (16, 3)


def test_auto_takes_high_orders_on_few_triangles():
    supports, loads = [ks.SimplySupported("edge")], [ks.Pressure(1.0)]
    few = ks.solve(scene(supports, loads, n=2), element="hhj", large_deflection=False)
    assert few.model["order"] == 6
    assert ks.solve(scene(supports, loads, n=12), element="hhj", large_deflection=False).model["order"] == 5


@pytest.mark.parametrize("options", [{"element": "koiter", "model": "plate"}, {"model": "plate", "order": 4}])
def test_other_words_for_it(options):
    made = scene([ks.SimplySupported("edge")], [ks.Pressure(1.0)], n=2)
    assert ks.solve(made, large_deflection=False, **options).model["element"] == "hhj"


def test_refusals():
    clamped, load = [ks.Clamped("left")], [ks.Pressure(1.0)]
    made = scene(clamped, load, n=2)
    with pytest.raises(ks.InputError, match="multigrid"):
        ks.solve(made, element="hhj", solver="multigrid")
    with pytest.raises(ks.InputError, match="for plates"):
        ks.solve(made, element="hhj", model="shell")
    with pytest.raises(ks.InputError, match="large_deflection"):
        ks.solve(made, element="hhj", large_deflection=True)
    with pytest.raises(ks.InputError, match="orders up to 6"):
        ks.solve(made, element="koiter", order=7)
    with pytest.raises(ks.InputError, match="surface is held"):
        ks.solve(scene([ks.Clamped("plate")], load, n=2), element="hhj")
    with pytest.raises(ks.InputError, match="no rotation at a point"):
        ks.solve(scene([*clamped, ks.Clamped((1.0, 0.5, 0.0))], load, n=2), element="hhj")
    with pytest.raises(ks.InputError, match="not held"):
        ks.solve(scene([], load, n=2), element="hhj")
    ring = np.arange(1, 7)
    line = np.stack([ring, np.roll(ring, -1)], axis=1)
    inside = ks.Mesh.from_arrays(disk(3).points, disk(3).triangles, {"line": line})
    made = ks.Scene(
        mesh=inside, thickness=1.0, material=MATERIAL, supports=[ks.SimplySupported("line")], loads=load
    )
    with pytest.raises(ks.InputError, match="lies inside the plate"):
        ks.solve(made, element="hhj")
    varying = ks.Scene(mesh=square(2), thickness="1+x", material=MATERIAL, supports=clamped, loads=load)
    with pytest.raises(ks.InputError, match="thickness varies"):
        ks.solve(varying, element="hhj")


@pytest.mark.parametrize("kind", [ks.Clamped, ks.SimplySupported])
def test_disks_are_right_to_rounding(kind):
    """The deflection is a quartic, which order 4 has on the true disk; every triangle but the inner ones has an arc."""
    made = ks.Scene(
        mesh=disk(2),
        thickness=1.0,
        material=MATERIAL,
        supports=[kind("edge")],
        loads=[ks.Pressure(1.0)],
        probes={"centre": (0.0, 0.0, 0.0), "rim": (1.0, 0.0, 0.0)},
    )
    found = ks.solve(made, element="hhj", order=5, large_deflection=False)
    clamped = kind is ks.Clamped
    centre = 1 / 64 if clamped else 5.3 / 1.3 / 64
    assert found.probe("centre")["u"][2] == pytest.approx(centre, rel=1e-11)
    assert found.probe("centre")["M"][0] == pytest.approx((1.3 if clamped else 3.3) / 16, rel=1e-10)
    rim = [-1 / 8, -0.3 / 8, 0] if clamped else [0, 0.7 / 8, 0]
    assert found.probe("rim")["M"] == pytest.approx(rim, abs=1e-8)
    assert found.reactions["edge"]["force"] == pytest.approx([0, 0, -np.pi], abs=1e-10)
    assert found.balance < 1e-11
    assert found.error["budget"]["geometry"] == 0.0


ROUND = {
    "free hole": ([ks.Clamped("outer")], [ks.Pressure("exp(x)*cos(3*y)")]),
    "line force": ([ks.Clamped("outer")], [ks.LineForce("inner", (0, 0, "1+x"))]),
    "edge moments": (
        [ks.SimplySupported("outer")],
        [ks.EdgeMoment("inner", "1+x"), ks.EdgeMoment("outer", 1.0)],
    ),
    "springs": ([ks.Elastic("outer", 30.0, "zr"), ks.Elastic("plate", "20+x", "z")], [ks.Pressure("1+x")]),
    "moved": (
        [ks.SimplySupported("outer"), ks.Fixed("inner", "zr", value=(0, 0, "0.1*x"))],
        [ks.Pressure(1.0)],
    ),
    "turned": ([ks.SimplySupported("outer"), ks.Fixed("inner", "r", rotation="1+x")], []),
    "curvature": ([ks.SimplySupported("outer")], [ks.InitialCurvature((0.1, 0.2, "0.1*x"))]),
}


@pytest.mark.parametrize("name", ROUND)
def test_annuli_as_argyris_has_them(name):
    """All that acts on curved edges; energies of work and strain, and loads and reactions, belong together."""
    supports, loads = ROUND[name]

    def answer(rings, around, **options):
        made = ks.Scene(
            mesh=annulus(rings, around),
            thickness=1.0,
            material=MATERIAL,
            supports=supports,
            loads=loads,
            probes={"p": (0.5, 0.35, 0.0)},
        )
        return ks.solve(made, large_deflection=False, error="off", **options)

    argyris = answer(4, 24, element="argyris")
    found = answer(2, 12, element="hhj", order=6)
    for quantity, off in (("u", 2e-5), ("rotation", 2e-4), ("M", 1e-2)):
        expected = argyris.probe("p")[quantity]
        assert np.abs(found.probe("p")[quantity] - expected).max() < off * np.abs(expected).max()
    assert found.strain_energy == pytest.approx(argyris.strain_energy, rel=2e-5)
    assert found.balance < 1e-10
    if name != "curvature":  # which is stored without work of loads
        assert found.external_work == pytest.approx(found.strain_energy, rel=1e-10)


def test_a_free_curved_edge_turns_without_strain():
    """Held at three points and moved by a plane: cubics, whose slopes along arcs are no polynomials."""
    points = [(1.0, 0.0, 0.0), (-0.5, 3**0.5 / 2, 0.0), (-0.5, -(3**0.5) / 2, 0.0)]
    held = [ks.Fixed(at, "z", value=(0, 0, 0.3 + 0.1 * at[0] - 0.2 * at[1])) for at in points]
    made = ks.Scene(mesh=disk(2), thickness=1.0, material=MATERIAL, supports=held, loads=[])
    found = ks.solve(made, element="hhj", order=3, large_deflection=False)
    x, y = found.mesh.points[:, :2].T
    assert found.fields["displacement"][:, 2] == pytest.approx(0.3 + 0.1 * x - 0.2 * y, abs=1e-12)
    assert np.abs(found.fields["moment"]).max() < 1e-11


def test_a_ring_from_a_file():
    """meshes/annulus.toml by this element, beside the scene as it stands."""
    scene = ks.Scene.load(Path(__file__).parents[2] / "meshes" / "annulus.toml")
    found = ks.solve(scene, element="hhj", order=5, large_deflection=False, error="off")
    known = ks.solve(scene, element="argyris", large_deflection=False, error="off")
    assert found.strain_energy == pytest.approx(known.strain_energy, rel=1e-5)
    assert found.balance < 1e-9


def test_high_orders_on_graded_meshes_resolve_a_corner():
    """Twice the energy of the clamped L: orders 10 and 12 on unlike meshes, and orders 8 and 10 on the way to them."""

    def twice(cells, layers, order):
        made = ks.Scene(
            mesh=graded(cells, layers),
            thickness=1.0,
            material=MATERIAL,
            supports=[ks.Clamped("edge")],
            loads=[ks.Pressure(1.0)],
        )
        return (
            2 * ks.solve(made, element="hhj", order=order, large_deflection=False, error="off").strain_energy
        )

    known = 5.59151574e-5
    assert twice(6, 10, 8) == pytest.approx(known, rel=1e-6)
    assert twice(6, 12, 10) == pytest.approx(known, rel=6e-8)
    assert twice(8, 24, 12) == pytest.approx(known, rel=3e-9)
