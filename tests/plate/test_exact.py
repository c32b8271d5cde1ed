"""Solutions that are polynomials of the element are found to rounding, and loads agree with statics."""

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import UNIT, disk, rectangle, solve

ELEMENTS = ("morley", "argyris")
NU = UNIT["nu"]
CORNERS = [ks.Fixed(p, "z") for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]


def deflection(result):
    return result.fields["displacement"][:, 2]


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("mesh", [rectangle(4, wobble=0.2), disk(3)], ids=["square", "disk"])
def test_edge_moments_bend_to_a_sphere(element, mesh):
    """M_n = m all around: w = -m r^2 / (2 (1 + nu)) up to a rigid motion, M_xx = M_yy = m."""
    held = (
        CORNERS
        if len(mesh.groups) > 3
        else [ks.Fixed(p, "z") for p in ((0, 0, 0), (1, 0, 0), (0.5, np.sqrt(0.75), 0))]
    )
    result = solve(mesh, held, [ks.EdgeMoment("edge", 2.0)], element)
    x, y = mesh.points[:, :2].T
    w = deflection(result) + 2.0 * (x**2 + y**2) / (2 * (1 + NU))
    plane = np.stack([np.ones_like(x), x, y], axis=1)
    left = w - plane @ np.linalg.lstsq(plane, w, rcond=None)[0]
    straight_chords = element == "morley" and len(mesh.groups) <= 3
    if not straight_chords:  # on chords the Morley element sees a polygon, whose normals differ
        assert np.abs(left).max() < 1e-10
        assert np.allclose(result.fields["moment"], [2.0, 2.0, 0.0], atol=1e-9)
        assert np.allclose(result.fields["shear"], 0.0, atol=1e-6)
    assert result.balance < 1e-9


@pytest.mark.parametrize("element", ELEMENTS)
def test_twist_by_corner_forces(element):
    """Forces +-P at the corners of a free square: w = -P x y / (2 D (1 - nu)) + rigid, M_xy = P / 2."""
    loads = [
        ks.PointForce((0, 0, 0), (0, 0, 1.0)),
        ks.PointForce((1, 0, 0), (0, 0, -1.0)),
        ks.PointForce((1, 1, 0), (0, 0, 1.0)),
        ks.PointForce((0, 1, 0), (0, 0, -1.0)),
    ]
    result = solve(rectangle(4, wobble=0.15), CORNERS, loads, element)
    x, y = result.mesh.points[:, :2].T
    assert np.allclose(deflection(result), x * y / (2 * (1 - NU)), atol=1e-11)
    assert np.allclose(result.fields["moment"], [0.0, 0.0, -0.5], atol=1e-9)
    assert result.balance < 1e-9


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize(
    "load",
    [
        ks.Temperature(gradient=30.0, expansion=1e-3),
        ks.InitialCurvature((-0.03, -0.03, 0.0)),
    ],
    ids=["temperature", "curvature"],
)
def test_a_free_plate_takes_up_its_curvature_without_moments(element, load):
    """Hotter on top: it bends down at the rim, w_xx = -0.03."""
    result = solve(rectangle(4, wobble=0.2), CORNERS, [load], element)
    x, y = result.mesh.points[:, :2].T
    assert np.allclose(deflection(result), -0.015 * (x * (x - 1) + y * (y - 1)), atol=1e-12)
    assert np.abs(result.fields["moment"]).max() < 1e-10
    assert result.strain_energy == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_clamped_plate_holds_a_temperature_gradient_back(element):
    """w = 0 and M = -D (1 + nu) alpha g everywhere: the hot face is pressed."""
    load = ks.Temperature(gradient=30.0, expansion=1e-3)
    result = solve(rectangle(4), [ks.Clamped("edge")], [load], element)
    moment = -(1 + NU) * 0.03
    assert np.abs(deflection(result)).max() < 1e-13
    assert np.allclose(result.fields["moment"], [moment, moment, 0.0], atol=1e-10)
    assert (result.fields["stress_top"][:, 0] < 0).all()
    assert result.strain_energy == pytest.approx(0.5 * 2 * (1 + NU) * 0.03**2, rel=1e-9)


@pytest.mark.parametrize("element", ELEMENTS)
def test_cylindrical_bending_by_prescribed_motion(element):
    """Clamped left, w prescribed right with free rotation, nu = 0: a cantilever beam with a tip force."""
    material = ks.Isotropic(E=12.0, nu=0.0)
    supports = [ks.Clamped("left"), ks.Fixed("right", "z", value=0.1)]
    result = solve(rectangle(8), supports, [], element, material=material)
    x = result.mesh.points[:, 0]
    exact = 0.1 * (1.5 * x**2 - 0.5 * x**3)
    assert np.allclose(deflection(result), exact, atol=1e-10 if element == "argyris" else 1e-3)
    assert result.reactions["right"]["force"][2] == pytest.approx(
        0.3, rel=1e-8 if element == "argyris" else 2e-2
    )
    assert result.strain_energy == pytest.approx(0.015, rel=1e-8 if element == "argyris" else 2e-2)


def test_prescribed_values_that_vary_along_edges_are_met_exactly():
    """w = x^4 - y^4 + x y on a distorted square is biharmonic-free-load consistent: q = 24 - 24 = 0."""
    form = "x**4 - y**4 + x*y"

    def normal_moment_free(x, y):
        return x**4 - y**4 + x * y

    mesh = rectangle(5, wobble=0.2)
    result = solve(
        mesh,
        [ks.Fixed("edge", "z", value=form)],
        [
            ks.EdgeMoment("right", f"-(12*x**2 - {NU}*12*y**2)"),
            ks.EdgeMoment("left", f"-(12*x**2 - {NU}*12*y**2)"),
            ks.EdgeMoment("top", f"-(-12*y**2 + {NU}*12*x**2)"),
            ks.EdgeMoment("bottom", f"-(-12*y**2 + {NU}*12*x**2)"),
        ],
    )
    x, y = mesh.points[:, :2].T
    assert np.allclose(deflection(result), normal_moment_free(x, y), atol=1e-10)


SPRING = 7.0


@pytest.mark.parametrize("element", ELEMENTS)
def test_springs_carry_the_load(element):
    """A stiff plate on springs sinks evenly; the reactions are those of statics."""
    for support, area in ((ks.Elastic("plate", SPRING), 1.0), (ks.Elastic("edge", SPRING), 4.0)):
        result = solve(rectangle(4), [support], [ks.Pressure(1.0)], element, thickness=100.0)
        assert np.allclose(deflection(result), 1 / (SPRING * area), rtol=1e-4)
        force = next(iter(result.reactions.values()))["force"]
        assert force[2] == pytest.approx(-1.0, rel=1e-5)  # the plate is 1e6 times as stiff as the springs


def test_rotation_spring_between_supported_and_clamped():
    """An elastic rotation about a supported edge: soft is simply supported, stiff is clamped."""
    mesh = rectangle(6)
    ends = [solve(mesh, [kind("edge")], [ks.Pressure(1.0)]) for kind in (ks.SimplySupported, ks.Clamped)]
    for stiffness, expected in ((1e-6, ends[0]), (1e8, ends[1])):
        supports = [ks.SimplySupported("edge"), ks.Elastic("edge", stiffness, "r")]
        result = solve(mesh, supports, [ks.Pressure(1.0)])
        assert deflection(result).max() == pytest.approx(deflection(expected).max(), rel=1e-4)


LOADS = {
    "pressure": ([ks.Pressure("1 + x")], [1.5, 0.75, -(0.5 + 1 / 3)]),
    "patch": ([ks.Pressure(2.0, on="upper")], [1.0, 0.75, -0.5]),
    "traction": ([ks.Traction((0, 0, "y"))], [0.5, 1 / 3, -0.25]),
    "gravity": ([ks.Gravity((0, 0, -2.0))], [-6.0, -3.0, 3.0]),
    "line": ([ks.LineForce("top", (0, 0, "3*x"))], [1.5, 1.5, -1.0]),
    "line inside": ([ks.LineForce("middle", (0, 0, 1.0))], [1.0, 0.5, -0.5]),
    "point": ([ks.PointForce((1, 1, 0), (0, 0, 4.0))], [4.0, 4.0, -4.0]),
    "moment": ([ks.PointMoment((0.5, 0.5, 0), (1.0, -2.0, 0))], [0.0, 1.0, -2.0]),
    "edge moment": ([ks.EdgeMoment("right", 3.0)], [0.0, 0.0, 3.0]),
    "edge moment above": ([ks.EdgeMoment("top", 3.0)], [0.0, -3.0, 0.0]),
}


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize(("loads", "total"), LOADS.values(), ids=LOADS.keys())
def test_reactions_balance_every_load(element, loads, total):
    """Clamped on the left: one support takes everything."""
    material = ks.Isotropic(**UNIT, density=3.0)
    result = solve(rectangle(4), [ks.Clamped("left")], loads, element, material=material)
    reaction = result.reactions["left"]
    found = [reaction["force"][2], *reaction["moment"][:2]]
    assert np.allclose(found, -np.array(total), atol=1e-8)
    assert result.balance < 1e-8
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-8)


def test_a_moment_turns_the_plate_about_its_axis():
    """A positive moment about x lifts the side of larger y (right-hand rule)."""
    result = solve(rectangle(4), [ks.Clamped("bottom")], [ks.PointMoment((0.5, 1, 0), (1.0, 0, 0))])
    at = result.at([[0.5, 1.0, 0.0]])
    assert at["rotation"][0, 0] > 0
    assert at["u"][0, 2] > 0


def test_variable_thickness_beam():
    """A cantilever whose thickness falls as t = (1 + x)^(-1/3)...: D = 1 / (1 + x), w'' = (1 + x) (1 - x) P."""
    material = ks.Isotropic(E=12.0, nu=0.0)
    tip = [ks.LineForce("right", (0, 0, 1.0))]
    result = solve(rectangle(6, 2), [ks.Clamped("left")], tip, material=material, thickness="(1 + x)**(-1/3)")
    x = result.mesh.points[:, 0]
    assert np.allclose(deflection(result), x**2 / 2 - x**4 / 12, atol=2e-6)
    assert np.allclose(result.fields["moment"][:, 0], -(1 - x), atol=2e-3)


def test_thickness_by_group():
    """Two beams side by side, eight times as stiff with double thickness."""
    material = ks.Isotropic(E=12.0, nu=0.0)
    mesh = rectangle(4, 4)
    tip = [ks.LineForce("right", (0, 0, 1.0))]
    even = solve(mesh, [ks.Clamped("left")], tip, material=material, thickness={"lower": 2.0, "upper": 2.0})
    thin = solve(mesh, [ks.Clamped("left")], tip, material=material)
    assert np.allclose(deflection(even), deflection(thin) / 8, atol=1e-12)


def test_hotter_than_needed_warnings_and_in_plane_loads():
    result = solve(rectangle(4), [ks.Clamped("left")], [ks.Temperature(mean=5.0, expansion=1e-5)])
    assert any("does not bend" in warning for warning in result.warnings)
    with pytest.raises(ks.InputError, match="in the plane"):
        solve(rectangle(4), [ks.Clamped("left")], [ks.Traction((1.0, 0, 0))])
    with pytest.raises(ks.InputError, match="about z"):
        solve(rectangle(4), [ks.Clamped("left")], [ks.PointMoment((1, 1, 0), (0, 0, 1.0))])
    with pytest.raises(ks.InputError, match="no density"):
        solve(rectangle(4), [ks.Clamped("left")], [ks.Gravity((0, 0, -9.81))])
    with pytest.raises(ks.InputError, match="inside the plate"):
        solve(rectangle(4), [ks.Clamped("left")], [ks.EdgeMoment("middle", 1.0)])
    with pytest.raises(ks.InputError, match="follower"):
        solve(rectangle(4), [ks.Clamped("left")], [ks.Pressure(1.0, follower=True)])


def test_moments_on_an_edge_inside_do_not_depend_on_the_numbering():
    """They are the mean of those of both triangles, whichever of them is found."""
    mesh = rectangle(3)
    edge = {"edge": mesh.edges[mesh.boundary_edges]}
    inside = mesh.points[mesh.edges[mesh.edge_counts > 1]].mean(axis=1)
    orders = (mesh.triangles, mesh.triangles[::-1])
    meshes = [ks.Mesh.from_arrays(mesh.points, triangles, groups=edge) for triangles in orders]
    values = [solve(m, [ks.Clamped("edge")], [ks.Pressure("1 + x + 3*y")]).at(inside) for m in meshes]
    for name in ("M", "Q", "stress_top"):
        assert np.abs(values[0][name] - values[1][name]).max() < 1e-9 * np.abs(values[0][name]).max()
