"""Supports as unknowns, sparse assembly, and rigid motions."""

import numpy as np
import pytest
import scipy.sparse as sp

import kshell as ks
from kshell.analysis.models import model_of
from kshell.elements import ElementArgyris, ElementMorley
from kshell.mesh.mesh import Mesh
from kshell.plate.pattern import Pattern
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from tests.plate.plates import UNIT, disk, rectangle, solve

ELEMENTS = {"morley": ElementMorley, "argyris": ElementArgyris}
STEEL = ks.Isotropic(**UNIT)

SUPPORTS = {
    "clamped": [ks.Clamped("edge")],
    "hard": [ks.SimplySupported("edge")],
    "changes along an edge": [ks.Clamped(["left", "bottom"]), ks.SimplySupported("right")],
    "line inside and a point": [ks.SimplySupported("middle"), ks.Fixed((0, 0, 0), "z")],
    "symmetry": [ks.Symmetry("left"), ks.Symmetry("bottom"), ks.Clamped("right")],
    "springs": [ks.Elastic("plate", 3.0), ks.Elastic("left", 2.0, "zr"), ks.Elastic((1, 1, 0), 5.0)],
    "moved": [ks.Clamped("left", value=(0, 0, 0.1)), ks.Fixed("right", "z", value="0.2*y - 0.05")],
}


def problem(mesh, supports, element, loads=(), thickness=1.0):
    scene = ks.Scene(mesh=mesh, thickness=thickness, material=STEEL, supports=supports, loads=list(loads))
    return PlateProblem(resolve(scene, mesh), ELEMENTS[element]())


def full_matrix(p):
    """K on all physical degrees of freedom, assembled the plain way."""
    out = sp.csr_matrix((p.layout.count, p.layout.count))
    for form in p.forms:
        for positions, triangles in form.blocks():
            blocks = form.matrices(positions, p.element.transformation(p.domain.affine(triangles)))
            dofs = p.layout.triangle_dofs(triangles)
            n = dofs.shape[1]
            where = (np.repeat(dofs, n, axis=1).ravel(), np.tile(dofs, (1, n)).ravel())
            out = out + sp.csr_matrix((blocks.ravel(), where), shape=out.shape)
    return out


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("supports", SUPPORTS.values(), ids=SUPPORTS.keys())
def test_matrix_in_the_unknowns_is_the_reduced_one(element, supports):
    p = problem(rectangle(4, skew=0.3, wobble=0.15), supports, element, [ks.Pressure("1 + x*y")])
    k, t, g = full_matrix(p), p.reduction.matrix(), p.reduction.particular
    expected = (t.T @ k @ t).toarray()
    found = p.assembled.matrix
    assert found.has_canonical_format or not (np.diff(found.indices) == 0).any()
    scale = np.abs(expected).max()
    assert np.abs(found.toarray() - expected).max() < 1e-12 * scale
    assert np.allclose(p.assembled.fixed_load, -(t.T @ (k @ g)), atol=1e-9 * scale)
    assert p.assembled.fixed_energy == pytest.approx(g @ (k @ g), abs=1e-9 * scale)
    q = np.random.default_rng(0).normal(size=p.reduction.count)
    assert np.allclose(p.reduction.expand(q), t @ q + g, atol=1e-9 * np.abs(t @ q).max())
    loads = np.random.default_rng(1).normal(size=(t.shape[0], 2))
    assert p.reduction.gathered(loads) == pytest.approx(t.T @ loads, abs=1e-12 * np.abs(t.T @ loads).max())


@pytest.mark.parametrize("supports", [[ks.Clamped("edge")], [ks.SimplySupported("edge")]])
def test_curved_edges_in_the_unknowns(supports):
    p = problem(disk(3), supports, "argyris", [ks.Pressure(1.0)])
    k, t = full_matrix(p), p.reduction.matrix()
    expected = (t.T @ k @ t).toarray()
    assert np.abs(p.assembled.matrix.toarray() - expected).max() < 1e-12 * np.abs(expected).max()


def test_pattern_holds_no_entry_twice_and_is_32_bit():
    p = problem(rectangle(5), SUPPORTS["hard"], "argyris")
    pattern = Pattern(p.reduction)
    assert pattern.indices.dtype == np.int32
    for row in range(p.reduction.count):
        columns = pattern.indices[pattern.indptr[row] : pattern.indptr[row + 1]]
        assert (np.diff(columns) > 0).all()


@pytest.mark.parametrize(("shift", "scale"), [(1e3, 1.0), (0.0, 1e-3), (0.0, 1e3)])
def test_the_answer_does_not_depend_on_place_or_scale(shift, scale):
    plain = solve(rectangle(8), [ks.SimplySupported("edge")], [ks.Pressure(1.0)])
    mesh = rectangle(8)
    points = mesh.points[:, :2] * scale + shift
    groups = {"edge": mesh.edges[mesh.groups["edge"].members]}
    moved = ks.Mesh.from_arrays(points, mesh.triangles, groups)
    other = solve(moved, [ks.SimplySupported("edge")], [ks.Pressure(1.0)])
    w, v = plain.fields["displacement"][:, 2], other.fields["displacement"][:, 2] / scale**4
    assert np.abs(v - w).max() < 1e-9 * np.abs(w).max()


@pytest.mark.parametrize("angle", [0.3, 1.1])
@pytest.mark.parametrize("element", ELEMENTS)
def test_the_answer_turns_with_the_plate(angle, element):
    """Oblique edges: the same plate, turned."""
    mesh = rectangle(6, wobble=0.1)
    c, s = np.cos(angle), np.sin(angle)
    turned = mesh.points[:, :2] @ np.array([[c, s], [-s, c]])
    groups = {name: mesh.edges[mesh.groups[name].members] for name in ("left", "bottom", "right")}
    moved = ks.Mesh.from_arrays(turned, mesh.triangles, groups)
    supports = [ks.Clamped("left"), ks.SimplySupported("bottom"), ks.Symmetry("right")]
    a = solve(mesh, supports, [ks.Pressure(1.0)], element)
    b = solve(moved, supports, [ks.Pressure(1.0)], element)
    assert np.allclose(a.fields["displacement"], b.fields["displacement"], atol=1e-12)
    invariant = a.fields["principal_moments"] - b.fields["principal_moments"]
    assert np.abs(invariant).max() < 1e-9


LOOSE = {
    "no supports": ([], "not held"),
    "one point": ([ks.Fixed((0.5, 0.5, 0), "z")], r"single point.*\(0.5, 0.5\)"),
    "a line": ([ks.SimplySupported("left")], r"turn about the line through \(0.*along \(-?0, -?1\)"),
    "two points": (
        [ks.Fixed((0, 0, 0), "z"), ks.Fixed((1, 1, 0), "z")],
        "turn about the line through .* along .*0.707",
    ),
    "symmetry only": ([ks.Symmetry("left"), ks.Symmetry("bottom")], "can move along z"),
    "rotation springs only": (
        [ks.Elastic("left", 1.0, "r"), ks.Elastic("top", 1.0, "r")],
        "can move along z",
    ),
}


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize(("supports", "words"), LOOSE.values(), ids=LOOSE.keys())
def test_a_free_rigid_motion_is_named(element, supports, words):
    with pytest.raises(ks.InputError, match=words):
        solve(rectangle(4), supports, [ks.Pressure(1.0)], element)


def test_three_points_hold_a_plate():
    points = [ks.Fixed(p, "z") for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]
    result = solve(rectangle(4), points, [ks.Pressure(1.0)])
    assert result.balance < 1e-9


def test_the_loose_one_of_two_pieces_is_named():
    a = rectangle(2)
    points = np.concatenate([a.points, a.points + [3.0, 0, 0]])
    triangles = np.concatenate([a.triangles, a.triangles + len(a.points)])
    mesh = ks.Mesh.from_arrays(points, triangles, {"left": a.edges[a.groups["left"].members]})
    with pytest.raises(ks.InputError, match=r"around \(3.5, 0.5\), one of 2 pieces"):
        solve(mesh, [ks.Clamped("left")], [ks.Pressure(1.0)])


def test_conflicting_values_are_refused_with_the_place():
    supports = [ks.Clamped("left", value=(0, 0, 0.1)), ks.Clamped("bottom")]
    with pytest.raises(ks.InputError, match=r"different values at \(0, 0\)"):
        solve(rectangle(4), supports, [])


def test_a_curved_line_of_symmetry_is_refused():
    with pytest.raises(ks.InputError, match="not straight"):
        solve(disk(3), [ks.Symmetry("edge")], [ks.Pressure(1.0)])


@pytest.mark.parametrize("support", [ks.Clamped((0.5, 0.5, 0)), ks.Elastic((0.5, 0.5, 0), 1.0, "r")])
def test_morley_has_no_rotation_at_a_point_and_says_so(support):
    with pytest.raises(ks.InputError, match="no rotation at a point"):
        solve(rectangle(4), [ks.Clamped("left"), support], [], "morley")


def test_options_choose_the_element():
    held = [ks.Clamped("left")]
    scene = ks.Scene(mesh=rectangle(4), thickness=1.0, material=STEEL, supports=held)
    assert model_of(scene).element == "argyris"
    assert model_of(scene, element="morley").element == "morley"


def test_lines_of_symmetry_of_one_group_may_meet_at_a_corner():
    mesh = rectangle(6)
    ends = [mesh.edges[mesh.groups[name].members] for name in ("left", "bottom")]
    both = ks.Mesh.from_arrays(
        mesh.points,
        mesh.triangles,
        {"sym": np.concatenate(ends), "far": mesh.edges[mesh.groups["right"].members]},
    )
    a = solve(both, [ks.Symmetry("sym"), ks.Clamped("far")], [ks.Pressure(1.0)])
    b = solve(mesh, [ks.Symmetry(["left", "bottom"]), ks.Clamped("right")], [ks.Pressure(1.0)])
    assert np.array_equal(a.fields["displacement"], b.fields["displacement"])


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_plate_held_everywhere_does_not_move(element):
    result = solve(rectangle(2), [ks.Clamped("plate")], [ks.Pressure(1.0)], element)
    assert not result.fields["displacement"].any()
    assert result.reactions["plate"]["force"][2] == pytest.approx(-1.0)


@pytest.mark.parametrize("order", [1, 2])
def test_a_mesh_made_clockwise_is_turned_over(order):
    up = disk(3, order)
    down = ks.Mesh(up.points, up.triangles[:, [0, 2, 1]], up.midpoints, up.groups)
    scene = ks.Scene(
        mesh=down, thickness=1.0, material=STEEL, supports=[ks.Clamped("edge")], loads=[ks.Pressure(1.0)]
    )
    result = ks.solve(scene)
    assert result.fields["displacement"][:, 2].max() == pytest.approx(1 / 64, rel=1e-4)
    assert any("reversed" in reason for reason in result.model["reasons"])


@pytest.mark.parametrize("gap", [1e-3, 1e-5, 1e-7])
def test_poissons_ratio_near_minus_one_is_warned_of_with_a_number_that_holds(gap):
    """The simply supported disk bends as softly as it can; its deflection is known."""
    nu = -1 + gap
    material = ks.Isotropic(E=12 * (1 - nu**2), nu=nu)
    result = solve(disk(4), [ks.SimplySupported("edge")], [ks.Pressure(1.0)], material=material)
    error = abs(result.at((0, 0, 0))["u"][0, 2] / ((5 + nu) / (1 + nu) / 64) - 1)
    said = [words for words in result.warnings if "nearly singular" in words]
    if gap > 1e-4:
        assert not said
        assert error < 1e-6
        return
    assert f"{2 / gap:.1e} times" in said[0]
    off = float(said[0].split("off by ")[1].split(" ")[0])
    assert error < off


def test_harmless_materials_are_not_warned_of():
    """Nearly incompressible, a stiff fibre in a soft matrix, and a laminate of it."""
    fibre = ks.Orthotropic(E1=140e9, E2=1e9, nu12=0.3, G12=0.5e9)
    layers = [ks.Layer(fibre, 0.1, angle) for angle in (0, 90, 90, 0)]
    loads, held = [ks.Pressure(1.0)], [ks.SimplySupported("edge")]
    for section in (
        {"material": ks.Isotropic(E=1.0, nu=0.4999999)},
        {"material": fibre},
        {"layers": layers},
    ):
        assert solve(rectangle(2), held, loads, **section).warnings == []


def test_a_nearly_singular_laminate_is_warned_of():
    nothing = ks.Orthotropic(E1=1e9, E2=1e3, nu12=0.0, G12=1e3)
    layers = [ks.Layer(nothing, 0.1, 0.0)] * 2
    words = solve(rectangle(2), [ks.SimplySupported("edge")], [ks.Pressure(1.0)], layers=layers).warnings
    assert len(words) == 1
    assert "1.0e+06 times" in words[0]


def test_slopes_at_several_curved_edges_of_a_triangle_are_found_together():
    """A clamped disk of two triangles, two sides of each an arc: rows . d = s, and reactions of s alone."""
    angle = 0.25 * np.pi * np.arange(8)
    points = np.append(np.stack([np.cos(angle), np.sin(angle)], axis=1), [[0.0, 0.0]], axis=0)
    cells = np.array([[0, 2, 4, 1, 3, 8], [0, 4, 6, 8, 5, 7]])
    mesh = Mesh.from_arrays(points, cells, {"edge": np.array([[0, 2], [2, 4], [4, 6], [6, 0]])})
    p = problem(mesh, [ks.Clamped("edge")], "argyris")
    slaves, random = p.reduction.slaves, np.random.default_rng(0)
    assert sorted(slaves.triangles.tolist()) == [0, 0, 1, 1]
    dofs = p.layout.triangle_dofs(slaves.triangles)
    d = random.normal(size=(p.layout.count, 3))
    s, matrix = d[slaves.slots], slaves.matrix()
    expected = matrix @ d
    loads = random.normal(size=d.shape)
    assert slaves.gathered(loads) == pytest.approx(matrix.T @ loads, abs=1e-12 * np.abs(loads).max())
    slaves.fill(d)
    assert d == pytest.approx(expected, abs=1e-12 * np.abs(d).max())
    assert (slaves.rows[:, None] @ d[dofs])[:, 0] == pytest.approx(s, abs=1e-12 * np.abs(d).max())
    moments, residual = random.normal(size=len(slaves.edges)), np.zeros(p.layout.count)
    np.add.at(residual, dofs, moments[:, None] * slaves.rows)
    size = np.abs(residual).max()
    assert slaves.released(residual) == pytest.approx(moments, rel=1e-10)
    assert np.abs(residual).max() < 1e-12 * size
