"""Parts of one or two triangles: what tells nothing of its error has no interval, all else holds the truth."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.halve import halved
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import bisect_around
from kshell.verify.cases.large_scenes import slit_annulus
from tests.plate.plates import disk, rectangle
from tests.shell.shapes import joined

MATERIAL = ks.Isotropic(E=210e9, nu=0.3)
EXACT = 1e-3  # tolerance of what stands for the truth


def pyramid(sides: int, height: float) -> Mesh:
    angle = 2 * np.pi * np.arange(sides) / sides
    rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=1)
    points = np.concatenate([[[0.0, 0.0, height]], rim])
    after = np.roll(np.arange(1, sides + 1), -1)
    edges = np.stack([np.arange(1, sides + 1), after], axis=1)
    triangles = np.concatenate([np.zeros((sides, 1), dtype=int), edges], axis=1)
    return Mesh.from_arrays(points, triangles, {"rim": edges, "all": triangles})


def quadrilateral() -> Mesh:
    """Two triangles, with two edges at a vertex held."""
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.1, 0.9], [0.0, 1.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    groups = {"rim": np.array([[0, 1], [0, 3]]), "one": triangles[:1], "other": triangles[1:]}
    return Mesh.from_arrays(points, triangles, groups)


def triangle() -> Mesh:
    points, corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.9]]), np.array([[0, 1, 2]])
    return Mesh.from_arrays(points, corners, {"rim": np.array([[0, 1], [1, 2], [0, 2]]), "plate": corners})


def scene(mesh: Mesh, support: Any, probe: Any, **given: Any) -> ks.Scene:
    content: dict[str, Any] = {"thickness": 0.02, "loads": [ks.Pressure(1e4)], "crease": 5.0} | given
    return ks.Scene(mesh, material=MATERIAL, supports=[support], probes={"p": probe}, **content)


def solved(of: ks.Scene, **options: Any) -> ks.Result:
    return ks.solve(of, large_deflection=False, **options)


def holds(result: ks.Result, exact: ks.Result) -> bool:
    """Whether its intervals and those of a better answer have something in common."""
    mine, its = result.error["energy"], exact.error["energy"]
    width = [np.array(r.error["probes"]["p"]["u"]["half_width"]) for r in (result, exact)]
    off = np.abs(np.subtract(result.probe("p")["u"], exact.probe("p")["u"]))
    meets = mine["lower"] <= its["upper"] and its["lower"] <= mine["upper"]
    return bool(meets and (off <= width[0] + width[1] + 1e-12 * off.max()).all())


@pytest.mark.parametrize(("sides", "height"), [(4, 0.8), pytest.param(6, 2.0, marks=pytest.mark.full)])
def test_facets_of_one_triangle(sides: int, height: float) -> None:
    mesh = pyramid(sides, height)
    of = scene(mesh, ks.Clamped("rim"), tuple(mesh.points[mesh.triangles[-1]].mean(axis=0)))
    exact = solved(of, tolerance=EXACT, quantity="p")
    assert exact.error["estimate"] <= EXACT
    assert exact.strain_energy == pytest.approx(
        solved(dataclasses.replace(of, mesh=halved(halved(halved(mesh)))), order=4).strain_energy, rel=1e-2
    )
    for order in (3, 4, 5):
        assert holds(solved(of, order=order), exact)
    for order in (1, 2):
        error = solved(of, order=order).error
        assert error["kind"] == "none"
        assert error["estimate"] is None
        assert "energy" not in error
        assert not error["probes"]
        assert "order 3" in error["why_not"]


def test_a_named_order_that_tells_nothing_is_refined_until_it_does() -> None:
    mesh = pyramid(4, 0.8)
    of = scene(mesh, ks.Clamped("rim"), tuple(mesh.points[mesh.triangles[-1]].mean(axis=0)))
    result = solved(of, order=2, tolerance=0.02, quantity="p")
    assert result.error["estimate"] <= 0.02
    assert result.error["levels"][0]["half_width"] is None
    assert holds(result, solved(of, tolerance=EXACT, quantity="p"))


ELEMENTS = [
    ("morley", None),
    ("argyris", None),
    *[("hhj", p) for p in (1, 2, 3, 5)],
    *[("koiter", p) for p in (1, 2, 3, 4)],
]


@pytest.mark.parametrize("thickness", [0.01, {"one": 0.01, "other": 0.02}], ids=["even", "stepped"])
@pytest.mark.parametrize(
    "support", [ks.Clamped("rim"), ks.SimplySupported("rim")], ids=["clamped", "supported"]
)
def test_plates_of_two_triangles(thickness: Any, support: Any) -> None:
    of = scene(quadrilateral(), support, (0.45, 0.3, 0.0), thickness=thickness, loads=[ks.Pressure(100.0)])
    exact = solved(of, tolerance=EXACT, quantity="p")
    told = 0
    for element, order in ELEMENTS:
        result = solved(of, element=element, **({} if order is None else {"order": order}))
        if result.error["kind"] != "none":
            told += 1
            assert holds(result, exact), (element, order)
    assert told >= 5


def test_nothing_can_move() -> None:
    """One triangle with clamped edges, all of whose numbers are held: it stays, and the interval knows better."""
    of = scene(triangle(), ks.Clamped("rim"), (0.45, 0.3, 0.0), loads=[ks.Pressure(100.0)])
    exact = solved(of, tolerance=EXACT, quantity="p")
    result = solved(of, element="argyris")
    assert result.strain_energy == 0.0
    assert holds(result, exact)
    assert solved(of, element="morley").error["kind"] == "none"
    heavy = dataclasses.replace(of, material=ks.Isotropic(E=210e9, nu=0.3, density=7850.0))
    with pytest.raises(ks.InputError, match="there are only 0 modes"):
        ks.modes(heavy, count=1, element="argyris")


def test_stepped_plates_between_guaranteed_bounds() -> None:
    """Second derivatives jump at a step, in the conforming side of the bounds, too."""
    of = scene(
        quadrilateral(),
        ks.SimplySupported("rim"),
        (0.45, 0.3, 0.0),
        thickness={"one": 0.01, "other": 0.02},
        loads=[ks.Pressure(100.0)],
    )
    result = solved(of, tolerance=1e-3, quantity="p")
    assert result.error["kind"] == "guaranteed"
    assert result.balance < 1e-9
    other = solved(of, element="hhj", order=4, tolerance=1e-4, quantity="p")
    assert holds(result, other)


@pytest.mark.parametrize("degrees", [12.0, 25.0])
def test_shallow_folds_between_flat_parts_are_folds(degrees: float) -> None:
    """Not facets of a curve, over which forces and moments would be averaged and whose shape would be in doubt."""
    turn = np.radians(degrees)
    x = np.array([[0.0, 0.0], [1.0, 0.0], [1.0 + np.cos(turn), np.sin(turn)]])
    points = np.array([[a, y, z] for a, z in x for y in (0.0, 1.0)])
    triangles = np.array([[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]])
    mesh = halved(Mesh.from_arrays(points, triangles, {"held": np.array([[0, 1]]), "all": triangles}))
    of = scene(mesh, ks.Clamped("held"), tuple(points[4]), crease=30.0)
    result = solved(of, tolerance=1e-3, quantity="p")
    assert result.error["estimate"] <= 1e-3
    assert result.error["budget"]["geometry"] == 0.0
    assert holds(solved(of), result)


def test_energy_of_small_triangles_that_move_far() -> None:
    """Toward a free corner the matrix has no digits left for the energy; strains have."""
    of = scene(quadrilateral(), ks.SimplySupported("rim"), (0.45, 0.3, 0.0), loads=[ks.Pressure(100.0)])
    energy = [
        solved(
            dataclasses.replace(of, mesh=bisect_around(quadrilateral(), np.array([2]), times)),
            element="argyris",
            error="off",
        ).strain_energy
        for times in (8, 14)
    ]
    assert energy[1] == pytest.approx(energy[0], rel=1e-7)


def test_lines_curved_inside_are_no_premise_of_a_proof() -> None:
    """Nodes of a line that bends a little are on a curve for the deflections, on chords for the moments."""
    mesh = rectangle(4, 2, a=0.8, b=0.6)
    inside = np.flatnonzero((mesh.points[:, 0] == 0.4) & (mesh.points[:, 1] == 0.3))
    points = mesh.points.copy()
    points[inside, 0] += 0.01
    of = ks.Scene(
        dataclasses.replace(mesh, points=points),
        thickness=0.01,
        material=MATERIAL,
        supports=[ks.Clamped("top"), ks.SimplySupported("left"), ks.Fixed("middle", "r")],
        loads=[ks.Pressure(100.0)],
        probes={"p": (0.7, 0.15, 0.0)},
    )
    result = solved(of, tolerance=1e-2, quantity="p")
    assert result.error["kind"] == "estimated"
    assert result.balance < 1e-9
    assert holds(result, solved(of, model="shell", element="koiter", tolerance=1e-2, quantity="p"))


def test_morley_plates_are_not_graded_beyond_their_digits() -> None:
    """A rotation held along a line that bends is singular: triangles of 1e-12 were no plate any more."""
    mesh = rectangle(2, 3, a=0.9, b=1.4, skew=0.8)
    points = mesh.points.copy()
    points[5, 0] -= 0.03
    of = ks.Scene(
        dataclasses.replace(mesh, points=points),
        thickness=0.01,
        material=MATERIAL,
        supports=[
            ks.SimplySupported(["left", "right", "bottom"]),
            ks.Clamped("top"),
            ks.Fixed("middle", "r"),
        ],
        loads=[ks.Pressure(-50.0)],
        probes={"p": (0.9, 0.5, 0.0)},
    )
    result = solved(of, element="morley", tolerance=0.2, quantity="p")
    assert result.error["estimate"] <= 0.2
    assert result.balance < 1e-6


def folded(cells: int, wide: int) -> Mesh:
    """Three flat parts that meet at 31 degrees, each some cells long and so many wide."""
    turn = np.radians([0.0, 31.0, 62.0])
    corner = np.concatenate([[[0.0, 0.0]], np.cumsum(np.stack([np.cos(turn), np.sin(turn)], axis=1), axis=0)])
    parts = []
    for (x, z), (dx, dz) in zip(corner[:-1], np.diff(corner, axis=0), strict=True):
        flat = rectangle(cells, wide, a=1.0, b=1.0)
        s, t = flat.points[:, 0], flat.points[:, 1]
        parts.append((np.stack([x + s * dx, t, z + s * dz], axis=1), flat.triangles))
    mesh = joined(*parts)
    held = mesh.edges[(mesh.points[mesh.edges][:, :, 0] < 1e-9).all(axis=1)]
    return Mesh.from_arrays(mesh.points, mesh.triangles, {"rim": held, "all": mesh.triangles})


@pytest.mark.parametrize(
    "load", [ks.Pressure(1e4), ks.InitialCurvature((0.01, 0.0, 0.005))], ids=["p", "kappa"]
)
def test_parts_one_triangle_wide(load: Any) -> None:
    """All vertices are on folds and borders: elements of order 1 see nothing of what bends between them."""
    of = scene(folded(3, 1), ks.Clamped("rim"), tuple(folded(3, 1).points[-1]), loads=[load])
    exact = solved(of, tolerance=0.01, quantity="p")
    error = solved(of, order=1).error
    assert error["kind"] == "none"
    assert "one triangle wide" in error["why_not"]
    for order in (2, 3, 4):
        assert holds(solved(of, order=order), exact)
    finer = dataclasses.replace(of, mesh=folded(4, 2))
    assert solved(finer, order=1).error["kind"] == "estimated"
    assert holds(solved(finer, order=1), exact)


@pytest.mark.full
def test_what_stalls_is_named() -> None:
    """A moment at a point has no finite energy: refining goes on around it, and digits are not what is short."""
    mesh = folded(3, 1)
    tip = tuple(mesh.points[-1])
    of = scene(
        mesh, ks.Clamped("rim"), tip, loads=[ks.Pressure(1e3), ks.PointMoment(tip, (100.0, -200.0, 30.0))]
    )
    result = solved(of, tolerance=1e-4, quantity="p")
    assert result.error["estimate"] > 1e-4
    assert "point moment" in result.error["why_not"]
    assert "rounding" not in result.error["why_not"]


@pytest.mark.parametrize("options", [{"element": "morley"}, {"element": "hhj", "order": 1}], ids=str)
@pytest.mark.parametrize("load", [ks.Pressure(100.0), ks.Temperature(gradient=5000.0)], ids=["p", "warm"])
def test_few_constant_moments_tell_nothing(options: dict[str, Any], load: Any) -> None:
    """Of so few triangles half of the intervals missed; not at rest energies are off by as much as moments are."""
    for n in ((2, 1), (2, 2), (2, 3), (4, 2), (5, 4)):
        mesh = rectangle(*n, a=1.4)
        of = dataclasses.replace(
            scene(mesh, ks.Clamped(["left", "bottom"]), (1.1, 0.7, 0.0), loads=[load]),
            material=ks.Isotropic(E=210e9, nu=0.3, expansion=1e-5),
        )
        result = solved(of, **options)
        if len(mesh.triangles) < 13:
            assert result.error["kind"] == "none"
            assert "13 triangles" in result.error["why_not"]
        else:
            assert holds(result, solved(dataclasses.replace(of, mesh=halved(mesh)), element="hhj", order=5))


def test_a_probe_between_vertices_that_are_held() -> None:
    """Constant moments have the plane through its vertices as deflection, which is zero there and not the plate's."""
    mesh = rectangle(6, 2)
    of = scene(mesh, ks.SimplySupported("edge"), (0.05, 0.85, 0.0), loads=[ks.Pressure(100.0)])
    result = solved(of, element="hhj", order=1)
    assert result.probe("p")["u"][2] == 0.0
    assert holds(result, solved(of, element="hhj", order=6))


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("rings", [2, 4, 8])
def test_curved_borders_of_flat_shells_are_chords_or_parabolas(rings: int, order: int) -> None:
    """A clamped disk as a shell: its energy is pi p^2 a^6 / 384 D; a plate follows the circle."""
    of = ks.Scene(
        disk(rings, order),
        thickness=0.01,
        material=MATERIAL,
        supports=[ks.Clamped("edge")],
        loads=[ks.Pressure(100.0)],
        probes={"p": (0.0, 0.0, 0.0)},
    )
    true = np.pi * 100.0**2 / (384 * 210e9 * 0.01**3 / 12 / (1 - 0.3**2))
    result = solved(of, model="shell")
    assert result.error["energy"]["lower"] <= true <= result.error["energy"]["upper"]
    assert result.error["budget"]["geometry"] > 0.0
    assert any("chords" in words for words in result.warnings) == (order == 1)
    assert solved(of, model="plate").strain_energy == pytest.approx(true, rel=1e-9)


def test_slit_flat_shells_have_intervals() -> None:
    """Vertices of both sides of a slit lie at the same places of the border, too."""
    result = solved(slit_annulus(2, 12), model="shell")
    assert result.error["kind"] == "estimated"
    assert result.error["budget"]["geometry"] > 0.0
