"""Supports, loads, elastic supports, hinges, temperature: each against an answer known by hand."""

import numpy as np
import pytest

from kshell.equilibrium.linear import solve_linear
from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.shell.initial import StressFree, temperature
from kshell.shell.koiter import loads, matrices
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.initial import initial_strain
from kshell.shell.koiter.reactions import resultant, rotation_axes
from kshell.shell.koiter.recovery import displacement, resultants
from kshell.shell.koiter.supports import Supports
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section
from tests.shell.shapes import Model, cylinder, fold, joined, panel, rectangle, sphere

BEAM = Section.isotropic(12.0, 0.0, 1.0)  # bending stiffness 1 per width
ORDERS = (1, 2, 3, 4)


def cantilever(order, section=BEAM, lift=None):
    model = Model(rectangle(8, 3, 0, 2, 0, 1), order, section, lift)
    model.supports.clamp(model.edges(0, 0.0))
    return model


@pytest.mark.parametrize("order", ORDERS)
def test_end_moment_bends_the_strip_to_a_parabola(order):
    model = cantilever(order)
    answer = model.solve(loads.edge_moment(model.surface, 0.3, model.edges(0, 2.0)))
    tip = answer.x[3 * model.vertex(2.0, 1.0) + 2]
    assert tip == pytest.approx(-0.3 * 2**2 / 2, rel=1e-3 if order == 1 else 1e-9)
    found = resultants(model.koiter, model.koiter.linear_strain(answer.x), [[0.2, 0.3]])
    if order > 1:
        assert np.allclose(found.moment, [0.3, 0, 0], atol=1e-9)  # the top is in tension
        material = 12.0 * np.diag([1, 1, 0.5])
        stress = found.stress(material, 0.5 * material, 0.0)
        assert np.allclose(stress, [0.3 * 6, 0, 0], atol=1e-8)


@pytest.mark.parametrize("order", ORDERS)
def test_reactions_balance_forces_and_moments(order):
    model = Model(rectangle(6, 4, 0, 12, 0, 8), order, Section.isotropic(1e3, 0.3, 0.4), sphere(10.0))
    surface = model.surface
    model.supports.clamp(model.edges(0, 0.0))
    model.supports.simple(model.edges(1, 8.0))
    edge = model.edges(0, 12.0)
    load = (
        loads.pressure(surface, lambda x: 1 + 0.1 * x[:, 0])
        + loads.traction(surface, [0.1, 0.2, -0.3])
        + loads.line_force(surface, [0.0, 1.0, 0.5], edge)
        + loads.edge_moment(surface, 2.0, edge)
        + loads.point_force(surface, model.vertex(6.0, 4.0), [1.0, -2.0, 0.5])
        + loads.point_moment(surface, model.vertex(6.0, 4.0), [3.0, 1.0, -2.0])
    )
    answer = model.solve(load)
    force, moment = resultant(surface, answer.forces)
    applied, turning = resultant(surface, load)
    scale = np.abs(load).sum()
    assert np.abs(force + applied).max() < 1e-9 * scale
    assert np.abs(moment + turning).max() < 1e-8 * scale


@pytest.mark.parametrize("axis", range(3))
def test_point_moment_is_a_couple_of_the_given_size(axis):
    surface = Surface(rectangle(4, 4, 0, 2, 0, 2), 2, sphere(3.0))
    force, moment = resultant(surface, loads.point_moment(surface, 12, np.eye(3)[axis]))
    assert np.allclose(force, 0, atol=1e-12)
    assert np.allclose(moment, np.eye(3)[axis], atol=1e-12)


def test_pressure_on_a_closed_surface_has_no_resultant_and_follows_the_surface():
    rng = np.random.default_rng(0)
    surface = Surface(rectangle(4, 4, 0, 2, 0, 2), 2, sphere(3.0))
    x = 0.1 * rng.normal(size=surface.unknowns)
    step, h = rng.normal(size=len(x)), 1e-6
    _, stiffness = loads.follower_pressure(surface, x, 2.0)
    ahead, behind = (loads.follower_pressure(surface, x + s * h * step, 2.0)[0] for s in (1, -1))
    assert np.allclose((ahead - behind) / (2 * h), stiffness @ step, atol=1e-7)
    at_rest = loads.follower_pressure(surface, np.zeros(len(x)), 2.0)[0]
    assert np.allclose(at_rest, loads.pressure(surface, 2.0), atol=1e-14)


def test_prescribed_motion_and_its_reaction():
    """A propped tip: 3 EI w / L^3."""
    model = cantilever(2)
    tip = model.surface.nodes_of_edges(model.edges(0, 2.0))
    model.supports.translation(tip, "z", [0, 0, 0.01])
    answer = model.solve(np.zeros(model.surface.unknowns))
    force, _ = resultant(model.surface, answer.forces, tip)
    assert force[2] == pytest.approx(3 * 0.01 / 2**3, rel=2e-3)


def test_inclined_directions_leave_the_tangential_motion():
    """A square that slides on an inclined plane: a force along it needs no support, one across it does."""
    surface = Surface(rectangle(2, 2, 0, 1, 0, 1), 1)
    supports = Supports(surface)
    slope = np.array([1.0, 0.0, 1.0]) / np.sqrt(2)
    supports.along(np.arange(9), slope)
    basis = supports.reduction().basis
    along, across = np.zeros((2, surface.unknowns))
    along[:27], across[:27] = np.tile([1.0, 0, -1.0], 9), np.tile(slope, 9)
    assert np.abs(basis.T @ across).max() < 1e-15
    assert np.linalg.norm(basis.T @ along) == pytest.approx(np.linalg.norm(along))


def test_contradicting_supports_are_refused():
    surface = Surface(rectangle(2, 2, 0, 1, 0, 1), 1)
    supports = Supports(surface)
    supports.translation([4], "z")
    supports.translation([4], "z", [0, 0, 1.0])
    with pytest.raises(InputError, match=r"\(0.5, 0.5, 0\)"):
        supports.reduction()


def test_symmetry_needs_a_plane_and_a_right_angle():
    model = Model(rectangle(4, 4, 0, 2, 0, 2), 2, BEAM, sphere(3.0))
    with pytest.raises(InputError, match="one plane"):
        model.supports.symmetry(np.concatenate([model.edges(0, 0.0), model.edges(1, 2.0)]))
    with pytest.raises(InputError, match="right angle"):
        model.supports.symmetry(model.edges(1, 2.0))  # a circle of latitude


def test_half_a_plate_with_symmetry_is_half_of_the_plate():
    section = Section.isotropic(1.0, 0.3, 0.1)
    whole = Model(rectangle(8, 8, -1, 1, -1, 1), 2, section)
    whole.supports.clamp(whole.mesh.boundary_edges)
    half = Model(rectangle(4, 8, 0, 1, -1, 1), 2, section)
    half.supports.clamp(np.setdiff1d(half.mesh.boundary_edges, half.edges(0, 0.0)))
    half.supports.symmetry(half.edges(0, 0.0))
    w = [m.solve(loads.pressure(m.surface, 1.0)).x[3 * m.vertex(0.0, 0.0) + 2] for m in (whole, half)]
    assert w[1] == pytest.approx(w[0], rel=1e-10)


def test_elastic_supports():
    """A stiff panel on springs of every kind sinks by force over stiffness."""
    model = Model(rectangle(2, 2, 0, 2, 0, 1), 2, Section.isotropic(1e6, 0.3, 1.0))
    surface = model.surface
    model.supports.translation(np.arange(surface.node_count), "xy")
    model.supports.rotation(np.arange(len(model.mesh.edges)))
    z = np.diag([0.0, 0.0, 1.0])
    springs = (
        matrices.foundation(surface, 3.0, z)  # 6 in all
        + matrices.line_springs(surface, lambda x: 2.0 * x[:, 0], z, model.edges(1, 0.0))  # 4
        + matrices.point_springs(surface, [0, 0, 5.0], [model.vertex(1.0, 0.5)])
    )
    answer = model.solve(loads.traction(surface, [0, 0, -1.0]), springs)
    w = surface.split(answer.x)[0][:, 2]
    assert w.mean() == pytest.approx(-2.0 / 15.0, rel=2e-2)


def test_rotation_springs_between_hinge_and_clamp():
    """A cantilever with a spring k instead of the clamp: w = P L^3 / 3 EI + P L^2 / k."""
    model = Model(rectangle(8, 2, 0, 2, 0, 1), 2, BEAM)
    edge = model.edges(0, 0.0)
    model.supports.simple(edge)
    springs = matrices.rotation_springs(model.surface, 4.0, edge)
    load = loads.line_force(model.surface, [0, 0, 1.0], model.edges(0, 2.0))
    tip = model.solve(load, springs).x[3 * model.vertex(2.0, 1.0) + 2]
    assert tip == pytest.approx(8 / 3 + 4 / 4.0, rel=1e-4)


def test_hinge_between_sheets_carries_no_moment():
    """Two spans, clamped outside, hinged in the middle, under a line force on the hinge."""
    mesh = rectangle(8, 2, 0, 2, 0, 1)
    middle = np.flatnonzero(np.all(np.abs(mesh.points[mesh.edges][:, :, 0] - 1.0) < 1e-9, axis=1))
    deflection = []
    for hinges in ((), middle):
        surface = Surface(mesh, 2, hinges=hinges)
        koiter = Koiter(surface, BEAM)
        supports = Supports(surface)
        on = mesh.points[mesh.edges].mean(axis=1)[:, 0]
        supports.clamp(np.flatnonzero((on < 1e-9) | (on > 2 - 1e-9)))
        load = loads.line_force(surface, [0, 0, 1.0], middle)
        x = solve_linear(koiter, load, supports.reduction()).x
        deflection.append(surface.split(x)[0][np.argmin(np.abs(mesh.points - [1, 0.5, 0]).sum(1)), 2])
    assert deflection[0] == pytest.approx(8 / 192, rel=2e-3)  # P L^3 / 192 EI
    assert deflection[1] == pytest.approx(0.5 / 3, rel=2e-3)  # two cantilevers with P / 2


@pytest.mark.parametrize("order", ORDERS)
def test_free_expansion_leaves_no_stress(order):
    surface = Surface(rectangle(3, 3, 0, 1, 0, 1), order, cylinder(0.7))
    koiter = Koiter(surface, Section.isotropic(1e3, 0.3, 0.1))
    initial = initial_strain(koiter, temperature(10.0, 0.0, 1e-3))
    blocked = np.abs(koiter.stress(initial)).max()
    supports = Supports(surface)
    for node, axes in ((0, "xyz"), (3, "xz"), (12, "z")):
        supports.translation([node], axes)
    answer = solve_linear(koiter, np.zeros(surface.unknowns), supports.reduction(), None, initial)
    assert np.abs(answer.stress).max() < 1e-8 * blocked
    length = np.linalg.norm(surface.nodes[15] - surface.nodes[0])
    u = surface.split(answer.x)[0]
    stretched = (u[15] - u[0]) @ (surface.nodes[15] - surface.nodes[0]) / length
    assert stretched == pytest.approx(1e-2 * length, rel=1e-9)


def test_temperature_gradient_and_initial_curvature_bend_alike():
    tips = []
    for strain in (
        lambda k: initial_strain(k, StressFree(curvature=[0.02, 0.02, 0.0])),
        lambda k: initial_strain(k, temperature(0.0, 20.0, 1e-3)),
    ):
        model = cantilever(2, Section.isotropic(12.0, 0.0, 1.0))
        load = np.zeros(model.surface.unknowns)
        answer = solve_linear(model.koiter, load, model.reduction(), None, strain(model.koiter))
        tips.append(answer.x[3 * model.vertex(2.0, 0.5) + 2])
    assert tips[0] == pytest.approx(tips[1], rel=1e-9)
    # the top is longer, so the tip goes down by kappa L^2 / 2, but for the clamp that keeps the edge straight
    assert tips[0] == pytest.approx(-0.02 * 2**2 / 2, rel=5e-2)


def test_a_free_structure_is_reported():
    model = Model(rectangle(3, 3, 0, 1, 0, 1), 2, BEAM)
    model.supports.translation([0], "xyz")
    with pytest.raises(InputError, match="free"):
        model.solve(loads.traction(model.surface, [0, 0, 1.0]))


@pytest.mark.parametrize("order", ORDERS)
def test_mass_is_that_of_the_surface(order):
    surface = Surface(rectangle(6, 2, 0, np.pi / 2, 0, 1), order, cylinder(1.0))
    x = np.zeros(surface.unknowns)
    x[0 : surface.rotation_start : 3] = 1.0
    mass = matrices.mass(surface, 2.0)
    assert x @ mass @ x == pytest.approx(np.pi, rel=1e-2 if order == 1 else 1e-4)
    assert mass[surface.rotation_start :].nnz == 0


def test_orthotropic_axes_turn_with_the_angle():
    """A strip whose stiff direction is turned by 90 degrees bends as one that is laid across."""
    stiff = np.diag([12.0, 1.2, 3.0])
    tips = []
    for angle, direction in ((0.0, [0, 1, 0]), (np.pi / 2, None)):
        model = cantilever(2, Section.from_plane_stress(stiff, 1.0, angle=angle, direction=direction))
        load = loads.line_force(model.surface, [0, 0, 1.0], model.edges(0, 2.0))
        tips.append(model.solve(load).x[3 * model.vertex(2.0, 0.5) + 2])
    assert tips[0] == pytest.approx(tips[1], rel=1e-9)
    assert tips[0] == pytest.approx(8 / 3 / 0.1, rel=1e-3)


def test_offset_couples_stretching_and_bending():
    """A strip pulled along its surface, its material above: M = N z, w'' = -M / D at the free end."""
    section = Section.from_plane_stress(np.diag([12.0, 12.0, 6.0]), 1.0, offset=0.5)
    model = cantilever(2, section)
    answer = model.solve(loads.line_force(model.surface, [1.0, 0, 0], model.edges(0, 2.0)))
    found = resultants(model.koiter, model.koiter.linear_strain(answer.x), [[1 / 3, 1 / 3]])
    assert np.allclose(found.membrane_force, [1, 0, 0], atol=1e-9)
    assert np.allclose(found.moment, 0, atol=1e-9)  # the force acts at the surface: no moment about it
    # about the middle of the material the moment is -N z, so the strip bends up by N z L^2 / 2
    assert answer.x[3 * model.vertex(2.0, 0.5) + 2] == pytest.approx(0.5 * 2**2 / 2, rel=1e-9)


def test_section_refuses_what_has_no_stiffness():
    with pytest.raises(InputError, match="thickness"):
        Section.isotropic(1.0, 0.3, [0.1, -0.1])
    with pytest.raises(InputError, match="positive stiffness"):
        Section.from_stiffness(np.eye(3), np.eye(3), coupling=2 * np.eye(3))
    with pytest.raises(InputError, match="normal to the surface"):
        _ = Koiter(
            Surface(rectangle(1, 1, 0, 1, 0, 1), 1),
            Section.from_plane_stress(np.eye(3), 1.0, direction=[0, 0, 1]),
        ).stiffness


def test_displacement_and_rotation_of_a_rigid_motion():
    surface = Surface(fold(), 2)
    omega = np.array([0.1, -0.2, 0.3])
    x = np.zeros(surface.unknowns)
    x[: surface.rotation_start] = np.cross(omega, surface.nodes).ravel()
    _, rotation = displacement(surface, x, [[0.2, 0.2]], np.arange(len(surface.mesh.triangles)))
    assert np.allclose(rotation, omega, atol=1e-13)
    x[surface.rotation_start :] = rotation_axes(surface) @ omega
    assert np.abs(Koiter(surface, BEAM).linear_strain(x)).max() < 1e-12


def test_degenerate_triangles_are_refused():
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], float)
    with pytest.raises(InputError, match="degenerate"):
        Surface(Mesh(points, np.array([[0, 1, 2], [0, 1, 3]], dtype=np.int32)), 2)


def test_t_junction_shares_the_moment_by_stiffness():
    """A moment at the joint of three equal clamped panels: a third each."""
    mesh = joined(
        panel((0, 0, 0), (1, 0, 0), (0, 0.5, 0), 6), panel((0, 0, 0), (-1, 0, 0), (0, 0.5, 0), 6),
        panel((0, 0, 0), (0, 0, 1), (0, 0.5, 0), 6),
    )  # fmt: skip
    surface = Surface(mesh, 2)
    koiter, supports = Koiter(surface, Section.isotropic(12.0, 0.0, 1e-2)), Supports(surface)
    middle = mesh.points[mesh.edges].mean(axis=1)
    ends = np.flatnonzero((np.abs(middle[:, 0]) > 1 - 1e-9) | (middle[:, 2] > 1 - 1e-9))
    supports.clamp(ends)
    joint = np.flatnonzero(mesh.edge_counts == 3)
    supports.translation(surface.nodes_of_edges(joint), "xyz")
    x = solve_linear(koiter, loads.edge_moment(surface, 3e-6, joint), supports.reduction()).x
    # each panel resists with 4 EI / L per width, EI = 1e-6
    turn = np.abs(x[surface.rotations_of_edges(joint)])
    assert np.allclose(turn, 3 / (3 * 4.0), rtol=2e-3)
