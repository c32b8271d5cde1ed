"""Second derivatives that jump across lines inside a plate: steps of thickness, free curvature, held lines."""

import warnings

import numpy as np
import pytest

import kshell as ks
from kshell.elements import ElementArgyris
from kshell.mesh.mesh import Group, Mesh
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from tests.plate.plates import UNIT, disk, rectangle, solve
from tests.plate.test_system import full_matrix

NU = UNIT["nu"]


def halves(nx, ny=None, a=1.0, b=1.0, wobble=0.0):
    """A rectangle with groups A (left half) and B; its inner vertices moved, but for those on the middle line."""
    mesh = rectangle(nx, ny, a, b)
    points = mesh.points.copy()
    x, y = points[:, 0] / a, points[:, 1] / b
    inside = (abs(x - 0.5) < 0.499) & (abs(y - 0.5) < 0.499) & (abs(x - 0.5) > 1e-9)
    steps = np.array([a / nx, b / (ny or nx), 0.0])
    points[inside] += wobble * steps * np.random.default_rng(3).uniform(-1, 1, (inside.sum(), 3))
    centre = points[mesh.triangles].mean(axis=1) / np.array([a, b, 1.0])
    groups = {name: mesh.edges[group.members] for name, group in mesh.groups.items() if group.dimension == 1}
    groups |= {"A": mesh.triangles[centre[:, 0] < 0.5], "B": mesh.triangles[centre[:, 0] > 0.5]}
    groups["above"] = mesh.triangles[centre[:, 1] > 0.5]
    return Mesh.from_arrays(points, mesh.triangles, groups)


def stepped_disk(rings, order=2):
    """A disk of radius 1 with surface groups in, out and curve group ring at the radius 1/2."""
    mesh = disk(rings, order)
    radius = np.linalg.norm(mesh.points[:, :2], axis=1)
    inner = (radius[mesh.triangles] < 0.5 + 1e-9).all(axis=1)
    on = (abs(radius[mesh.edges] - 0.5) < 1e-9).all(axis=1)
    middle = mesh.midpoints
    if middle is not None:
        middle = middle.copy()
        middle[on] *= 0.5 / np.linalg.norm(middle[on], axis=1)[:, None]
    groups = {**mesh.groups, "in": Group(2, np.flatnonzero(inner)), "out": Group(2, np.flatnonzero(~inner))}
    return Mesh(mesh.points, mesh.triangles, middle, groups | {"ring": Group(1, np.flatnonzero(on))})


@pytest.mark.parametrize(("cells", "wobble"), [((4, 1), 0.0), ((8, 2), 0.2), ((16, 4), 0.2)])
def test_cantilever_strip_with_a_step(cells, wobble):
    """M = -(2 - x) on both sides of the step by statics; tip (1/3) / 1 + (7/3) / 8."""
    mesh = halves(*cells, 2.0, 0.5, wobble)
    probes = {"tip": (2, 0.25, 0), "A": (1 - 1e-9, 0.25, 0), "B": (1 + 1e-9, 0.25, 0)}
    result = solve(
        mesh,
        [ks.Clamped("left")],
        [ks.LineForce("right", (0, 0, 1.0))],
        thickness={"A": 2.0, "B": 1.0},
        material=ks.Isotropic(E=12.0, nu=0.0),
        probes=probes,
    )
    assert result.probes["tip"]["u"][2] == pytest.approx(1 / 3 + 7 / 24, rel=1e-8)
    for side in "AB":
        assert result.probes[side]["M"] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-8)
    assert result.probes["A"]["stress_top"][0] == pytest.approx(-6 / 4, abs=1e-8)
    assert result.probes["B"]["stress_top"][0] == pytest.approx(-6.0, abs=1e-8)
    assert result.extremes["von_mises"]["value"] == pytest.approx(6.0, rel=1e-8)
    assert result.balance < 1e-9
    assert result.unknowns == (68 if cells == (4, 1) else result.unknowns)


def test_a_probe_on_a_step_says_whose_values_it_has():
    result = solve(
        halves(4, 1, 2.0, 0.5),
        [ks.Clamped("left")],
        [ks.LineForce("right", (0, 0, 1.0))],
        thickness={"A": 2.0, "B": 1.0},
        material=ks.Isotropic(E=12.0, nu=0.0),
        probes={"step": (1, 0.2, 0), "beside": (1.1, 0.2, 0)},
    )
    assert result.probes["step"]["stress_top"][0] == pytest.approx(-6.0, abs=1e-8)
    (words,) = result.warnings
    assert words.startswith("probe step")
    assert 'those on "B", where the stress is largest' in words
    assert result.sheets["step"]["A"]["stress_top"][0] == pytest.approx(-1.5, abs=1e-8)


def levy(x, y, stiffness, terms=60):
    """Square of two halves of stiffness D = stiffness[k], simply supported, pressure 1: Levy's series.

    Half k has its own x from the middle line outwards; w, w_x, M_xx and V_x go on across the line.
    """
    total = 0.0
    for m in range(1, 2 * terms, 2):
        a = m * np.pi
        load = 4 / a  # of sin(a y)

        def basis(s, n, a=a):  # n-th derivative of exp(-a s), a s exp(-a s), and the same from the far edge
            e, f = np.exp(-a * s), np.exp(-a * (0.5 - s))
            r = a * (0.5 - s)
            return a**n * np.array([(-1) ** n * e, (-1) ** n * (a * s - n) * e, f, (r - n) * f])

        particular = [load / (d * a**4) for d in stiffness]
        rows, right = np.zeros((8, 8)), np.zeros(8)
        for k in range(2):
            own = slice(4 * k, 4 * k + 4)
            rows[k, own], right[k] = basis(0.5, 0), -particular[k]
            rows[2 + k, own] = basis(0.5, 2) / a**2
            sign = 1.0 if k else -1.0  # half 0 runs to the left
            rows[4, own], right[4] = sign * basis(0.0, 0), right[4] - sign * particular[k]
            rows[5, own] = basis(0.0, 1) / a
            moment = stiffness[k] * (basis(0.0, 2) - NU * a**2 * basis(0.0, 0)) / a**2
            rows[6, own], right[6] = sign * moment, right[6] + sign * stiffness[k] * NU * particular[k]
            rows[7, own] = stiffness[k] * (basis(0.0, 3) - (2 - NU) * a**2 * basis(0.0, 1)) / a**3
        c = np.linalg.solve(rows, right)
        k = int(x > 0.5)
        total += (c[4 * k : 4 * k + 4] @ basis(abs(x - 0.5), 0) + particular[k]) * np.sin(a * y)
    return total


def test_a_supported_edge_that_meets_the_step():
    assert levy(0.5, 0.5, (1.0, 1.0)) == pytest.approx(0.00406235265, rel=1e-8)
    probes = {"a": (0.25, 0.5, 0), "c": (0.5, 0.5, 0), "b": (0.75, 0.5, 0)}
    result = solve(
        halves(8, wobble=0.1),
        [ks.SimplySupported("edge")],
        [ks.Pressure(1.0)],
        thickness={"A": 1.0, "B": 0.5},
        probes=probes,
    )
    for name, (x, y, _) in probes.items():
        assert result.probes[name]["u"][2] == pytest.approx(levy(x, y, (1.0, 0.125)), rel=5e-7)


def test_free_curvature_of_a_part_leaves_no_moments():
    """Two parts that overlap crosswise take up curvatures that fit: w = -F(x) - G(y), M = 0 beside both lines."""
    corners = [ks.Fixed(p, "z") for p in ((0, 0, 0), (0, 1, 0), (1, 0, 0))]
    loads = [ks.InitialCurvature((-1.0, 0, 0), "B"), ks.InitialCurvature((0, -2.0, 0), "above")]
    mesh = halves(4)
    result = solve(mesh, corners, loads)
    x, y = result.points[:, :2].T
    fx, gy = np.maximum(x - 0.5, 0) ** 2 / 2, np.maximum(y - 0.5, 0) ** 2
    expected = -fx - gy + x / 8 + y / 4
    assert np.allclose(result.fields["displacement"][:, 2], expected, atol=1e-12)
    assert np.abs(result.fields["moment"]).max() < 1e-9
    assert result.strain_energy == pytest.approx(0.0, abs=1e-11)


def test_heated_outer_half_of_a_strip():
    """Free to bend along the strip only: no moments, w = 1/2 downwards."""
    load = ks.InitialCurvature((-1.0, 0, 0), "B")
    result = solve(
        halves(8, 2, 2.0, 0.5), [ks.Clamped("left")], [load], material=ks.Isotropic(E=12.0, nu=0.0)
    )
    assert np.abs(result.fields["moment"]).max() < 1e-8
    assert result.fields["displacement"][:, 2].min() == pytest.approx(-0.5, rel=1e-8)


@pytest.mark.parametrize("support", [ks.Clamped("middle"), ks.Clamped("B")], ids=["line", "half"])
def test_a_clamped_line_keeps_one_side_from_the_other(support):
    """Supported on three sides, clamped on the fourth, 1/2 x 1; the other half at rest."""
    mesh = halves(8)
    supports = [ks.SimplySupported("edge"), support]
    probes = {"left": (0.25, 0.5, 0), "right": (0.75, 0.5, 0)}
    result = solve(mesh, supports, [ks.Pressure(1.0, "A")], probes=probes)
    assert result.probes["left"]["u"][2] == pytest.approx(3.0490730e-4, rel=1e-6)
    assert np.abs(result.fields["displacement"][result.points[:, 0] > 0.5]).max() < 1e-15
    assert result.balance < 1e-10


def test_a_line_that_holds_the_rotation_only():
    """The loads on both halves are mirrored: the middle line is one of symmetry and the support does nothing."""
    probes = {"a": (0.25, 0.5, 0), "b": (0.75, 0.5, 0)}
    mesh = halves(8)
    held = solve(
        mesh, [ks.SimplySupported("edge"), ks.Fixed("middle", "r")], [ks.Pressure(1.0)], probes=probes
    )
    plain = solve(mesh, [ks.SimplySupported("edge")], [ks.Pressure(1.0)], probes=probes)
    for name in probes:
        assert held.probes[name]["u"][2] == pytest.approx(plain.probes[name]["u"][2], rel=1e-6)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("clamped", [True, False], ids=["clamped", "supported"])
def test_stepped_disk(order, clamped):
    """Thickness 2 inside r = 1/2, 1 outside; the step is followed on its arc."""
    centre, moment = round_step(clamped)
    result = solve(
        stepped_disk(8, order),
        [ks.Clamped("edge") if clamped else ks.SimplySupported("edge")],
        [ks.Pressure(1.0)],
        thickness={"in": 2.0, "out": 1.0},
        probes={"centre": (0, 0, 0), "in": (0.5 - 1e-9, 0, 0), "out": (0.5 + 1e-9, 0, 0)},
    )
    assert centre == pytest.approx(0.006394570299536777 if clamped else 0.0242393923, rel=1e-8)
    assert result.probes["centre"]["u"][2] == pytest.approx(centre, rel=5e-8)
    for side in ("in", "out"):
        assert result.probes[side]["M"][0] == pytest.approx(moment, rel=1.5e-3)
    assert result.balance < 1e-9


def round_step(clamped):
    """w(0) and M_r at the step of a disk with D = 8 inside r = 1/2 and 1 outside, pressure 1.

    w = a + b r^2 + r^4 / 64 D inside, a + b r^2 + c ln r + r^4 / 64 D outside (the shear force is r / 2 in both).
    """
    inner, outer, r = 8.0, 1.0, 0.5

    def rows(r):  # w, w', M_r over D of 1, r^2, ln r
        moment = [0.0, 2 + 2 * NU, (NU - 1) / r**2]
        return np.array([[1.0, r**2, np.log(r)], [0.0, 2 * r, 1 / r], moment])

    def particular(r, d):
        return np.array([r**4 / 64, r**3 / 16, (3 + NU) * r**2 / 16]) / d

    scale = np.array([[1.0], [1.0], [1.0]])
    stiff = [scale * np.array([[1.0], [1.0], [d]]) for d in (inner, outer)]
    a, right = np.zeros((5, 5)), np.zeros(5)
    a[:3, :2], a[:3, 2:] = (stiff[0] * rows(r))[:, :2], -stiff[1] * rows(r)
    right[:3] = (stiff[1][:, 0] * particular(r, outer)) - stiff[0][:, 0] * particular(r, inner)
    held = [0, 1] if clamped else [0, 2]
    a[3:, 2:], right[3:] = rows(1.0)[held], -particular(1.0, outer)[held]
    c = np.linalg.solve(a, right)
    moment = inner * (rows(r)[2, :2] @ c[:2] + particular(r, inner)[2])
    return c[0], -moment


def test_points_between_chord_and_arc_belong_to_the_side_of_the_arc():
    """A turn by half a chord from a vertex: the arc lies 0.004 outside its chord."""
    angle = np.pi / 24
    probe = 0.499 * np.array([np.cos(angle), np.sin(angle), 0])
    result = solve(
        stepped_disk(8),
        [ks.Clamped("edge")],
        [ks.Pressure(1.0)],
        thickness={"in": 2.0, "out": 1.0},
        probes={"p": probe},
    )
    p = result.probes["p"]
    assert p["stress_top"] == pytest.approx(6 * p["M"] / 4, rel=1e-9)


def test_lines_that_end_inside_are_no_worse_than_with_cubic_koiter_elements_and_said():
    mesh = rectangle(8)
    x = mesh.points[mesh.edges]
    on = (abs(x[:, :, 1] - 0.5) < 1e-9).all(axis=1) & (abs(x[:, :, 0] - 0.5).max(axis=1) < 0.25 + 1e-9)
    groups = {name: mesh.edges[group.members] for name, group in mesh.groups.items() if group.dimension == 1}
    mesh = Mesh.from_arrays(mesh.points, mesh.triangles, groups | {"wall": mesh.edges[on]})
    energy = 6.8451e-5  # extrapolated from both elements and 32 cells
    for support in (ks.Fixed("wall", "z"), ks.Clamped("wall")):
        supports = [ks.SimplySupported("edge"), support]
        result = solve(mesh, supports, [ks.Pressure(1.0)])
        assert any("end or turn inside the plate at 2 vertices" in words for words in result.warnings)
        scene = ks.Scene(
            mesh=mesh,
            thickness=1.0,
            material=ks.Isotropic(**UNIT),
            supports=supports,
            loads=[ks.Pressure(1.0)],
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            other = ks.solve(scene, model="shell", order=3, large_deflection=False)
        assert abs(result.strain_energy - energy) < abs(other.strain_energy - energy)


SCENES = {
    "step": (halves(4, wobble=0.1), [ks.SimplySupported("edge")], {"A": 1.0, "B": 0.5}),
    "clamped line": (halves(4, wobble=0.1), [ks.Clamped("middle"), ks.Fixed((0, 0, 0), "z")], 1.0),
    "step on a circle": (
        stepped_disk(4),
        [ks.Clamped("edge"), ks.Fixed((0, 0, 0), "z")],
        {"in": 2.0, "out": 1.0},
    ),
    "clamped circle": (stepped_disk(4), [ks.Clamped("ring")], 1.0),
    "line with kinks": (rectangle(4, wobble=0.15), [ks.Clamped("middle"), ks.SimplySupported("left")], 1.0),
}


@pytest.mark.parametrize(("mesh", "supports", "thickness"), SCENES.values(), ids=SCENES.keys())
def test_matrix_in_the_unknowns_is_the_reduced_one(mesh, supports, thickness):
    scene = ks.Scene(
        mesh=mesh,
        thickness=thickness,
        material=ks.Isotropic(**UNIT),
        supports=supports,
        loads=[ks.Pressure("1 + x*y")],
    )
    p = PlateProblem(resolve(scene, mesh), ElementArgyris())
    k, t = full_matrix(p), p.reduction.matrix()
    expected = (t.T @ k @ t).toarray()
    found = p.assembled.matrix
    assert found.shape[0] == p.reduction.count == p.reduction.sizes.sum()
    assert np.abs(found.toarray() - expected).max() < 1e-12 * np.abs(expected).max()
    q = np.random.default_rng(0).normal(size=p.reduction.count)
    assert np.allclose(p.reduction.expand(q), t @ q, atol=1e-9 * np.abs(t @ q).max())
    loads = np.random.default_rng(1).normal(size=(t.shape[0], 2))
    assert p.reduction.gathered(loads) == pytest.approx(t.T @ loads, abs=1e-12 * np.abs(t.T @ loads).max())


@pytest.mark.parametrize("name", ["step", "clamped line", "step on a circle"])
def test_multigrid_finds_the_same(name):
    mesh, supports, thickness = {
        "step": (halves(16), *SCENES["step"][1:]),
        "clamped line": (halves(16), *SCENES["clamped line"][1:]),
        "step on a circle": (stepped_disk(12), *SCENES["step on a circle"][1:]),
    }[name]
    scene = ks.Scene(
        mesh=mesh,
        thickness=thickness,
        material=ks.Isotropic(**UNIT),
        supports=supports,
        loads=[ks.Pressure(1.0)],
        solve={"large_deflection": False, "element": "argyris"},
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        direct, multigrid = (ks.solve(scene, solver=solver) for solver in ("direct", "multigrid"))
    assert multigrid.solver["iterations"] <= 25
    w = direct.fields["displacement"][:, 2]
    assert np.abs(multigrid.fields["displacement"][:, 2] - w).max() < 1e-6 * np.abs(w).max()


@pytest.mark.parametrize("load", [ks.LineForce("ring", (0, 0, 1.0)), ks.Pressure(1.0, "in")])
@pytest.mark.parametrize("order", [1, 2])
def test_loads_on_circles_inside_act_on_the_circle(load, order):
    """All round a force of pi, or pi / 4; w(0) by hand for the ring: r^2 ln r inside the circle of the load."""
    result = solve(stepped_disk(8, order), [ks.SimplySupported("edge")], [load])
    total = np.pi if load.kind == "line_force" else np.pi / 4
    assert result.reactions["edge"]["force"][2] == pytest.approx(-total, rel=3e-8)
    w = result.fields["displacement"][0, 2]
    r = 0.5
    # a ring force P = 2 pi r: w(0) = P / (8 pi) ((3 + nu) / (2 (1 + nu)) (1 - r^2) + r^2 ln r)
    ring = 2 * np.pi * r / (8 * np.pi) * ((3 + NU) / (2 * (1 + NU)) * (1 - r**2) + r**2 * np.log(r))
    # pressure inside r: the integral of rings over their radii
    s, weight = np.polynomial.legendre.leggauss(30)
    at = r * (s + 1) / 2
    rings = 2 * np.pi * at / (8 * np.pi) * ((3 + NU) / (2 * (1 + NU)) * (1 - at**2) + at**2 * np.log(at))
    assert w == pytest.approx(ring if load.kind == "line_force" else (rings * weight).sum() * r / 2, rel=1e-6)


def test_a_column_takes_the_load_of_a_flat_slab():
    """A panel between lines of symmetry: they carry no force, though they hold the corner of the column, too."""
    sides = ("left", "bottom", "right", "top")
    supports = [*(ks.Symmetry(side) for side in sides), ks.Fixed((0, 0, 0), "z")]
    result = solve(rectangle(4), supports, [ks.Pressure(1.0)])
    assert result.reactions["(0, 0)"]["force"][2] == pytest.approx(-1.0, rel=1e-9)
    for side in sides:
        assert result.reactions[side]["force"][2] == pytest.approx(0.0, abs=1e-10)
    # the moment of the load about the far edges
    assert result.reactions["left"]["moment"][1] + result.reactions["right"]["moment"][1] == pytest.approx(
        0.5
    )


def test_morley_with_a_line_force_inside_does_not_depend_on_numbering():
    mesh = rectangle(6, wobble=0.2)
    found = []
    for seed in range(3):
        random = np.random.default_rng(seed)
        order, triangles = random.permutation(len(mesh.points)), random.permutation(len(mesh.triangles))
        new = np.argsort(order)
        groups = {name: new[mesh.edges[mesh.groups[name].members]] for name in ("edge", "middle")}
        other = Mesh.from_arrays(mesh.points[order], new[mesh.triangles][triangles], groups)
        supports = [ks.SimplySupported("edge"), ks.Elastic("middle", 5.0, "zr")]
        result = solve(other, supports, [ks.LineForce("middle", (0, 0, 1.0))], "morley")
        found.append(result.fields["displacement"][new, 2])
    assert np.ptp(found, axis=0).max() < 1e-12 * np.abs(found).max()
