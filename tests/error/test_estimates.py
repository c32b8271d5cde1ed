"""Estimates where nothing is proved: the true error lies within them, and they shrink with it."""

from __future__ import annotations

import dataclasses
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.error.assessment import Interval
from kshell.error.geometry_share import domed, share_of_chart, turn_between, turn_of_triangles
from kshell.error.outlying import outlying
from kshell.error.two_elements import energy_of_difference
from kshell.mesh.mesh import Mesh
from kshell.scene.structure import resolve
from kshell.shell.chart.model import ChartModel
from kshell.shell.koiter.model import KoiterModel
from kshell.verify.cases import large_scenes
from kshell.verify.cases.case import TRUE_SURFACE
from kshell.verify.cases.catalogue import find
from tests.plate.plates import EGG_LOAD, UNIT, disk, egg, ellipse, ellipse_centre, rectangle

MATERIAL = ks.Isotropic(**UNIT)
SUPPORTED_CENTRE, CLAMPED_CENTRE = 0.004062352660675052, 0.00126531908748
PLATES: dict[str, tuple[Any, float, float]] = {
    "supported": (ks.SimplySupported("edge"), SUPPORTED_CENTRE, 1.70251052472e-3 / 2),
    "clamped": (ks.Clamped("edge"), CLAMPED_CENTRE, 3.8912013330e-4 / 2),
}


def square(n: int, support: Any, **given: Any) -> ks.Scene:
    return ks.Scene(
        rectangle(n),
        thickness=1.0,
        material=MATERIAL,
        supports=[support],
        loads=[ks.Pressure(1.0)],
        probes={"centre": (0.5, 0.5, 0.0)},
        solve={"large_deflection": False, **given},
    )


def half(result: ks.Result, probe: str, axis: int) -> float:
    return float(result.error["probes"][probe]["u"]["half_width"][axis])


@pytest.mark.parametrize("name", PLATES)
def test_residuals_of_plates_cover_the_error_and_fall_with_it(name: str) -> None:
    support, centre, energy = PLATES[name]
    widths = []
    for n in (4, 8):
        result = ks.solve(square(n, support))
        width = half(result, "centre", 2)
        assert abs(result.probes["centre"]["u"][2] - centre) <= width
        found = result.error["energy"]
        assert found["lower"] <= energy <= found["upper"]
        assert found["kind"] == result.error["kind"] == "estimated"
        assert result.error["estimate"] == pytest.approx(width / centre, rel=0.05)
        assert result.error["budget"]["discretisation"] == result.error["estimate"]
        assert result.error["budget"]["geometry"] == 0.0
        widths.append(width)
    assert widths[1] < widths[0] / 16


def test_a_probe_inside_a_triangle_and_varying_thickness() -> None:
    """Against the same plate on a finer mesh."""
    values = []
    for n in (6, 24):
        scene = dataclasses.replace(
            square(n, ks.Clamped("edge")), thickness="0.5 + 0.5*x", probes={"a": (0.412, 0.531, 0)}
        )
        values.append(ks.solve(scene))
    true = values[1].probes["a"]["u"][2]
    off = abs(values[0].probes["a"]["u"][2] - true)
    assert 0.0 < off <= half(values[0], "a", 2) < 0.3 * abs(true)


@pytest.mark.parametrize("order", [1, 2])
def test_curved_edges_count_in_the_budget(order: int) -> None:
    """Of a clamped egg, whose shape is a spline; that of an ellipse is known."""
    shares = []
    for rings in (3, 6):
        scene = ks.Scene(
            egg(rings, order),
            thickness=1.0,
            material=MATERIAL,
            supports=[ks.Clamped("edge")],
            loads=[ks.Pressure(EGG_LOAD)],
            probes={"centre": (0, 0, 0)},
        )
        result = ks.solve(scene, large_deflection=False)
        assert abs(result.probes["centre"]["u"][2] - 1.0) <= half(result, "centre", 2)
        shares.append(result.error["budget"]["geometry"])
    assert shares[1] > 0.0
    assert shares[0] / shares[1] > 20.0
    known = ks.solve(dataclasses.replace(scene, mesh=ellipse(3, order)), large_deflection=False)
    assert known.error["budget"]["geometry"] < 1e-13


def roof(n: int, order: int) -> ks.Scene:
    """A quarter of the Scordelis-Lo roof on its chart."""
    angle = np.radians(40.0)
    chart = ks.geometry.Chart.from_expressions("25*sin(u)", "v", "25*cos(u)")
    mesh = ks.geometry.Plane().parameter_mesh(
        n, n, ("crown", "free", "middle", "wall"), u_range=(0, angle), v_range=(0, 25)
    )
    return ks.Scene(
        mesh,
        chart=chart,
        thickness=0.25,
        material=ks.Isotropic(E=4.32e8, nu=0.0),
        supports=[ks.Symmetry(["middle", "crown"]), ks.Fixed("wall", "xz")],
        loads=[ks.Traction((0, 0, -90.0))],
        probes={"edge": (25 * np.sin(angle), 0, 25 * np.cos(angle))},
        solve={"large_deflection": False, "element": "koiter", "order": order},
    )


@pytest.mark.parametrize(("order", "n"), [(2, 6), (3, 4)])
def test_averages_of_shells_cover_the_error(order: int, n: int) -> None:
    """-0.300592457: Koiter elements of order 3 on graded meshes, and spectral solutions in the README's list."""
    result = ks.solve(roof(n, order))
    off = abs(result.probes["edge"]["u"][2] + 0.300592457)
    width = half(result, "edge", 2)
    assert off <= width <= 60 * off
    assert result.error["budget"]["geometry"] > 0.0
    assert "averages" in result.error["why_not"]
    expected = result.error["probes"]["edge"]["u"]["expected"]
    assert np.all(np.abs(expected) <= np.abs(result.error["probes"]["edge"]["u"]["half_width"]))


def test_averages_are_cut_where_the_section_jumps() -> None:
    """A strip pulled in its plane, half of it twice as thick: N is constant, and so is what it should be."""
    mesh = rectangle(4, 2, a=2.0)
    right = mesh.points[mesh.triangles].mean(axis=1)[:, 0] > 1.0
    groups = {
        "left": mesh.edges[mesh.groups["left"].members],
        "right": mesh.edges[mesh.groups["right"].members],
    }
    groups |= {"thin": mesh.triangles[~right], "thick": mesh.triangles[right]}
    halves = ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups)
    scene = ks.Scene(
        halves,
        thickness={"thin": 0.1, "thick": 0.2},
        material=ks.Isotropic(E=1.0, nu=0.0),
        supports=[ks.Clamped("left")],
        loads=[ks.EdgeMoment("right", 1e-4)],
        probes={"tip": (2.0, 0.0, 0.0)},
        solve={"model": "shell", "large_deflection": False, "order": 2},
    )
    result = ks.solve(scene)
    u = result.probes["tip"]["u"]
    assert abs(u[2]) > 0.0
    assert half(result, "tip", 2) < 1e-6 * abs(u[2])


def test_large_deflections_by_the_dual_of_the_tangent() -> None:
    """A cantilever that its end load bends to 6.7 of its length of 10; true: 32 cells of order 3, known to 1e-8."""
    true = np.array([-3.28954366, 0.0, 6.69988901])
    for n, order in ((8, 2), (4, 3)):
        scene = dataclasses.replace(large_scenes.cantilever(), mesh=large_scenes.rectangle(10.0, 1.0, n, 1))
        result = ks.solve(scene, element="koiter", order=order)
        assert result.model["large_deflection"]
        widths = np.array([half(result, "tip", axis) for axis in range(3)])
        off = np.abs(result.probes["tip"]["u"] - true)
        assert (off <= widths).all()
        assert (widths <= 1e-3 * np.linalg.norm(true)).all()


def test_slender_triangles_have_estimates_where_they_have_a_solution() -> None:
    """A strip whose factor leaves the duals of its free corners 3e-8 off in energy."""
    case = find("cantilever.tip_corner.nu0.3.ba0.2")
    scene = dataclasses.replace(case.build(4, 1), probes={"a": (1.0, 0.0, 0.0), "b": (1.0, 0.2, 0.0)})
    result = ks.solve(scene, element="argyris", large_deflection=False)
    for name, quantity in (("a", "w_load"), ("b", "w_other")):
        known = case.references[quantity]
        off = abs(result.probes[name]["u"][2] - known.value)
        assert off <= half(result, name, 2) + known.uncertainty * known.scale


def test_off_leaves_the_error_alone() -> None:
    result = ks.solve(square(4, ks.Clamped("edge")), error="off")
    assert result.error["kind"] == "none"
    assert result.error["estimate"] is None
    assert result.error["budget"]["discretisation"] is None
    with pytest.raises(ks.InputError, match="error"):
        ks.solve(square(4, ks.Clamped("edge")), error="on")


def test_the_first_three_probes_at_most() -> None:
    scene = dataclasses.replace(
        square(4, ks.Clamped("edge")), probes={name: (0.5, 0.25 * k, 0) for k, name in enumerate("abcde", 1)}
    )
    assert list(ks.solve(scene).error["probes"]) == ["a", "b", "c"]


@pytest.mark.parametrize("name", PLATES)
@pytest.mark.parametrize(
    ("element", "order", "n"), [("morley", None, 16), ("hhj", 1, 16), ("hhj", 2, 8), ("hhj", 4, 4)]
)
def test_averages_of_moments_cover_the_error(name: str, element: str, order: int | None, n: int) -> None:
    """Of Morley plates sharply; both intervals fall as the mesh is refined."""
    support, centre, energy = PLATES[name]
    widths = []
    for cells in (n // 2, n):
        scene = dataclasses.replace(square(cells, support), probes={"a": (0.5, 0.5, 0)})
        result = ks.solve(scene, element=element, **({} if order is None else {"order": order}))
        off, width = abs(result.probes["a"]["u"][2] - centre), half(result, "a", 2)
        assert off <= width
        found = result.error["energy"]
        assert found["lower"] <= energy <= found["upper"]
        assert found["kind"] == result.error["kind"] == "estimated"
        assert result.error["budget"]["geometry"] == 0.0
        widths.append(width)
        if element == "morley":
            assert width < 5.0 * off
    assert widths[1] < 0.4 * widths[0]


def disk_centre(a: float) -> float:
    """Deflection in the middle of a clamped disk of radius 1 under the pressure exp(a x), for D = 1.

    Of the pressure only the mean over circles counts, I_0(a r), a series in r^2; the influence function of the centre
    is (1 - r^2 + 2 r^2 log r) / (16 pi).
    """
    k = np.arange(30)
    terms = np.cumprod(np.concatenate([[1.0], (0.5 * a / k[1:]) ** 2]))
    moments = 1.0 / (2 * k + 2) - 1.0 / (2 * k + 4) - 2.0 / (2 * k + 4) ** 2
    return float((terms * moments).sum() / 8.0)


def test_averages_of_moments_on_curved_edges() -> None:
    """Orders 2 to 8 on one disk of 24 triangles, the outer ones with arcs: intervals fall with the errors, to 1e-11."""
    true, widths = disk_centre(3.0), []
    for order in (2, 4, 6, 8):
        scene = ks.Scene(
            disk(2),
            thickness=1.0,
            material=MATERIAL,
            supports=[ks.Clamped("edge")],
            loads=[ks.Pressure("exp(3*x)")],
            probes={"centre": (0, 0, 0)},
        )
        result = ks.solve(scene, element="hhj", order=order, large_deflection=False)
        off = abs(result.probes["centre"]["u"][2] / true - 1.0)
        widths.append(half(result, "centre", 2) / true)
        assert off <= widths[-1] <= 1e4 * off
        assert result.error["budget"]["geometry"] == 0.0
    assert all(fine < 0.3 * coarse for coarse, fine in pairwise(widths))
    assert widths[-1] < 1e-6


def test_morley_duals_at_places_inside_triangles_and_jumps_of_stiffness() -> None:
    """A strip in two thicknesses, bent by couples: moments are constant, so that nothing is off but by rounding."""
    mesh = rectangle(6, 2, a=2.0)
    right = mesh.points[mesh.triangles].mean(axis=1)[:, 0] > 1.0
    groups = {
        "left": mesh.edges[mesh.groups["left"].members],
        "right": mesh.edges[mesh.groups["right"].members],
    }
    groups |= {"thin": mesh.triangles[~right], "thick": mesh.triangles[right]}
    scene = ks.Scene(
        ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups),
        thickness={"thin": 0.1, "thick": 0.2},
        material=ks.Isotropic(E=1.0, nu=0.0),
        supports=[ks.Clamped("left")],
        loads=[ks.EdgeMoment("right", 1e-4)],
        probes={"a": (1.71, 0.31, 0.0)},
    )
    for element in ("morley", "hhj"):
        result = ks.solve(scene, model="plate", element=element, large_deflection=False)
        u = result.probes["a"]["u"][2]
        assert abs(u) > 0.0
        assert half(result, "a", 2) < 1e-5 * abs(u)


def test_shells_on_charts_against_koiter_elements() -> None:
    """-0.300592457 as above: what both elements differ by is more than the error."""
    result = ks.solve(roof(4, 3), element="argyris", order="auto")
    assert result.model["element"] == "argyris"
    off = np.abs(result.probes["edge"]["u"][2] + 0.300592457)
    assert off <= half(result, "edge", 2) < 0.01
    assert "difference" in result.error["why_not"]
    assert result.error["kind"] == "estimated"
    large = ks.solve(roof(2, 3), element="argyris", order="auto", large_deflection=True)
    assert large.error["kind"] == "none"
    assert "koiter" in large.error["why_not"]


@pytest.mark.parametrize("n", [2, 4, 8])
def test_shells_on_charts_where_both_elements_are_off_alike(n: int) -> None:
    """A thin twisted beam: both tips are off by 0.9 % on 8 triangles, and differ from one another by 0.06 %."""
    case = find("shell.twisted_beam.across.thin")
    scene = dataclasses.replace(case.build(n, TRUE_SURFACE), probes={"tip": case.quantities["u_tip"].point})
    result = ks.solve(scene, element="argyris", order="auto", large_deflection=False)
    known, direction = case.references["u_tip"], np.array(case.quantities["u_tip"].direction)
    off = abs(result.probes["tip"]["u"] @ direction - known.value)
    width = result.error["probes"]["tip"]["u"]["half_width"] @ np.abs(direction)
    assert off <= width + known.uncertainty * known.scale
    assert width <= 5.0 * off


def test_the_energy_of_a_difference_from_nothing_is_that_of_the_whole() -> None:
    """Of a roof whose layers are not alike: both ways to write |d|^2, in strains and in moments, are the energy."""
    layers = [ks.Layer(ks.Isotropic(E=4.32e8 * part, nu=0.2), 0.1) for part in (1.0, 0.1)]
    scene = dataclasses.replace(roof(2, 3), thickness=None, material=None, layers=layers)
    structure = resolve(scene, scene.mesh)
    model, other = ChartModel(structure), KoiterModel(structure, 3)
    solved = model.solve()
    none = np.zeros((len(scene.mesh.triangles), other.problem.energy.strains))
    stored = 0.5 * energy_of_difference(model, solved, other.problem.energy, none, none).sum()
    assert stored == pytest.approx(model.recover(solved).strain_energy, rel=1e-9)


@pytest.mark.parametrize("stacked", [[0.0, 90.0], [30.0]])
def test_shells_on_charts_whose_strains_are_exact(stacked: list[float]) -> None:
    """A sheet pulled evenly, which bends as its layers are not alike: both elements have the exact strains."""
    sheet = ks.Orthotropic(E1=10.0, E2=1.0, nu12=0.3, G12=0.5)
    scene = ks.Scene(
        ks.geometry.Plane().parameter_mesh(2, 2, ("west", "east", "south", "north")),
        chart=ks.geometry.Chart.from_expressions("u", "v", "0*u"),
        layers=[ks.Layer(dataclasses.replace(sheet, angle=angle), 0.05) for angle in stacked],
        supports=[
            ks.Fixed((0.0, 0.0, 0.0), "xyz"),
            ks.Fixed((1.0, 0.0, 0.0), "yz"),
            ks.Fixed((0.0, 1.0, 0.0), "z"),
        ],
        loads=[ks.LineForce("east", (0.01, 0.0, 0.0)), ks.LineForce("west", (-0.01, 0.0, 0.0))],
        probes={"corner": (1.0, 1.0, 0.0)},
    )
    result = ks.solve(scene, model="shell", element="argyris", order="auto", large_deflection=False)
    assert np.linalg.norm(result.probes["corner"]["u"]) > 1e-4
    assert result.error["kind"] == "estimated"
    assert result.error["estimate"] < 1e-6


def test_turns_of_triangles() -> None:
    """Of a cylinder in n cells over its circumference: 2 pi / n in quadratic triangles, and between facets."""
    n = 24
    curved = ks.geometry.Cylinder(3.0).mesh(n, 2, order=2)
    assert turn_of_triangles(curved).max() == pytest.approx(2 * np.pi / n, rel=0.02)
    flat = ks.geometry.Cylinder(3.0).mesh(n, 2, order=1)
    assert not turn_of_triangles(flat).any()
    between = turn_between(flat, np.zeros(len(flat.triangles), dtype=np.int64))
    assert between.max() == pytest.approx(2 * np.pi / n, rel=1e-9)


def test_domes_are_known_from_saddles_and_tubes() -> None:
    """What cubic interpolants of a chart miss matters more on a dome that carries by membrane forces."""
    dome, tube, saddle = (
        domed(surface.mesh(6, 6, order=2, **ranges))
        for surface, ranges in (
            (ks.geometry.Sphere(2.0), {"u_range": (0.5, 1.5), "v_range": (0.0, 1.0)}),
            (ks.geometry.Cylinder(2.0), {"u_range": (0.0, 1.0), "v_range": (0.0, 1.0)}),
            (ks.geometry.Hypar(), {"u_range": (-0.5, 0.5), "v_range": (-0.5, 0.5)}),
        )
    )
    assert dome.min() > 0.3  # of triangles that are long along a meridian
    assert np.median(dome) > 0.9
    assert tube.max() < 1e-6
    assert saddle.max() == 0.0
    turn, kinds = np.full(3, 0.1), np.array([1.0, 0.0, 0.0])
    cubic, quartic = (share_of_chart(order, turn, kinds, kinds, 0.01) for order in (3, 4))
    assert cubic[0] > 20 * cubic[1] > 0.0
    assert (cubic > 20 * quartic).all()
    assert (quartic > 0.0).all()


def test_a_share_of_a_displacement_is_the_size_of_a_vector() -> None:
    """Of no more than itself, whichever way it points; what does not move stays."""
    value, half_width = np.array([1.0, 2.0, 2.0]), np.array([0.03, 0.04, 0.0])
    interval = Interval(value, half_width, half_width, "estimated").widened(0.1)
    assert interval.half_width == pytest.approx([0.33, 0.34, 0.0])
    assert interval.relative == pytest.approx(0.05 / 3.0 + 0.1)
    assert interval.widened(0.2).relative == pytest.approx(0.05 / 3.0 + 0.3)
    assert Interval(value, 0.0 * value, 0.0 * value, "estimated").widened(0.1).relative == 0.0


def superellipse(rings: int, power: float) -> Mesh:
    """A disk drawn to |x|^p + |y|^p = 1, whose edge is nearly straight at four places, and nearly a corner at four."""
    mesh = disk(rings)
    points = mesh.points.copy()
    r = np.linalg.norm(points, axis=1)
    unit = points[r > 0.0] / r[r > 0.0, None]
    points[r > 0.0] /= (np.abs(unit) ** power).sum(axis=1)[:, None] ** (1.0 / power)
    return Mesh(points, mesh.triangles, None, mesh.groups)


@pytest.mark.parametrize(
    ("support", "true"), [(ks.Clamped, 0.01977012299), (ks.SimplySupported, 0.0729347916)]
)
@pytest.mark.parametrize("rings", [2, 3, 4])
def test_rough_curves_by_few_nodes(rings: int, support: Any, true: float) -> None:
    """Goursat's w = Re(conj(z) phi + chi) + r^4 / 64 with polynomials of degree 46, 1e-11 off on the curve."""
    scene = ks.Scene(
        superellipse(rings, 4.0),
        thickness=1.0,
        material=MATERIAL,
        supports=[support("edge")],
        loads=[ks.Pressure(1.0)],
        probes={"centre": (0, 0, 0)},
    )
    result = ks.solve(scene, large_deflection=False, element="hhj", order=6)
    assert abs(result.probes["centre"]["u"][2] - true) <= half(result, "centre", 2)


@pytest.mark.parametrize("rings", [3, 6])
@pytest.mark.parametrize("moved", [1e-2, 1e-3, 1e-5])
def test_a_node_that_lies_off_is_no_shape_that_is_known(rings: int, moved: float) -> None:
    """The interval holds the ellipse without it, and knows the shape to what the node moves, or what few nodes tell."""
    mesh = ellipse(rings)
    points = mesh.points.copy()
    node = int(mesh.edges[mesh.groups["edge"].members][2, 0])
    points[node] *= 1.0 + moved
    scene = ks.Scene(
        Mesh(points, mesh.triangles, None, mesh.groups),
        thickness=1.0,
        material=MATERIAL,
        supports=[ks.Clamped("edge")],
        loads=[ks.Pressure(1.0)],
        probes={"centre": (0, 0, 0)},
    )
    result = ks.solve(scene, large_deflection=False, element="hhj", order=6)
    off, share = result.probes["centre"]["u"][2] - ellipse_centre(), result.error["budget"]["geometry"]
    assert abs(off) <= half(result, "centre", 2)
    assert 0.01 * moved < share < 2.0 * moved + (0.01 if rings == 3 else 1e-4)  # of the spline itself


def test_outlying_nodes_stand_out_alone() -> None:
    t = np.linspace(0.0, 2.0 * np.pi, 25)
    curve = np.stack([np.cos(t) + 0.1 * np.cos(2.0 * t), 0.7 * np.sin(t)], axis=1)
    assert outlying(t, curve, True).max() < 1e-5
    for closed, node in ((True, 7), (True, 0), (False, 9)):
        nodes = curve.copy()
        nodes[node] += 1e-3 * curve[node]
        if closed:
            nodes[-1] = nodes[0]
        found = outlying(t, nodes, closed)
        assert int(np.argmax(found)) == node
        assert 2e-4 < found[node] < 1e-3
