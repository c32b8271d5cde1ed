"""Mass and geometric stiffness of plates: integrals of polynomials, frequencies and buckling loads in closed form."""

import numpy as np
import pytest

import kshell as ks
from kshell.elements import ElementArgyris, ElementMorley
from kshell.plate.assembly import assemble
from kshell.plate.inertia import Mass, Membrane
from kshell.plate.pattern import Pattern
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from kshell.solvers.critical import CriticalPencil, factors
from kshell.solvers.eigen import smallest
from kshell.solvers.pencil import Pencil
from tests.plate.plates import UNIT, disk, rectangle

ELEMENTS = {"argyris": ElementArgyris, "morley": ElementMorley}
SIDES = ["left", "right", "bottom", "top"]


def problem(mesh, element, supports, thickness=1.0):
    material = ks.Isotropic(**UNIT, density=1.0)
    scene = ks.Scene(
        mesh=mesh, thickness=thickness, material=material, supports=supports, loads=[ks.Pressure(1.0)]
    )
    return PlateProblem(resolve(scene, mesh), ELEMENTS[element]())


def matrix(plate, form):
    return assemble([form], [], plate.domain, plate.reduction, Pattern(plate.reduction)).matrix


def mass(plate):
    return matrix(plate, Mass(plate.domain, plate.element, plate.section))


def uniform(xx, yy, xy, size=1.0):
    force = size * np.array([[xx, xy], [xy, yy]])
    return lambda triangles, xi: np.broadcast_to(force, (*xi.shape[:2], 2, 2))


@pytest.mark.parametrize(("element", "n", "room"), [("argyris", 8, 2e-6), ("morley", 24, 4e-2)])
def test_frequencies_of_a_supported_square(element, n, room):
    plate = problem(rectangle(n), element, [ks.SimplySupported(SIDES)])
    found = smallest(Pencil(plate.assembled.matrix, mass(plate), np.zeros((plate.reduction.count, 0))), 4)
    exact = np.pi**4 * np.array([4.0, 25.0, 25.0, 64.0])
    assert found.values == pytest.approx(exact, rel=room)
    if element == "argyris":
        assert np.all(found.values >= exact * (1 - 1e-10))  # Rayleigh and Ritz


def test_frequency_of_a_clamped_disk_on_its_true_edge():
    plate = problem(disk(4, order=2), "argyris", [ks.Clamped("edge")])
    found = smallest(Pencil(plate.assembled.matrix, mass(plate), np.zeros((plate.reduction.count, 0))), 3)
    assert np.sqrt(found.values) == pytest.approx([10.21582623, 21.26039769, 21.26039769], rel=2e-5)


@pytest.mark.parametrize("element", ["argyris", "morley"])
@pytest.mark.parametrize("thickness", [2.0, "1 + x/2"])
def test_mass_of_a_rigid_motion(element, thickness):
    """w = 1 everywhere: the mass matrix gives the mass of the plate, density 1."""
    plate = problem(rectangle(3, 4, wobble=0.2), element, [ks.Elastic("plate", 1.0)], thickness)
    w = np.zeros(plate.layout.count)
    w[: plate.layout.per_vertex * plate.layout.vertex_count : plate.layout.per_vertex] = 1.0
    q = w / plate.layout.scale  # no conditions: the unknowns are the scaled degrees of freedom
    assert plate.reduction.expand(q) == pytest.approx(w)
    expected = 2.0 if thickness == 2.0 else 1.25
    assert q @ (mass(plate) @ q) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("element", ["argyris", "morley"])
@pytest.mark.parametrize("degree", [0, 1])
def test_membrane_forces_on_a_tilted_plate(element, degree):
    """w = x: the integral of N_xx, here 1 + x or its mean in each triangle."""
    plate = problem(rectangle(3, 4, wobble=0.2), element, [ks.Elastic("plate", 1.0)])
    corners = plate.mesh.points[plate.mesh.triangles][:, :, :2]

    def force(triangles, xi):
        shape = np.stack([1 - xi[..., 0] - xi[..., 1], xi[..., 0], xi[..., 1]], axis=-1)
        x = (shape @ corners[triangles])[..., 0]
        out = np.zeros((*x.shape, 2, 2))
        out[..., 0, 0] = 1 + x
        return out

    step, count = plate.layout.per_vertex, plate.layout.vertex_count
    w = np.zeros(plate.layout.count)
    w[: step * count : step] = plate.mesh.points[:, 0]
    if step > 1:
        w[1 : step * count : step] = 1.0
    along = np.diff(plate.domain.points[plate.mesh.edges], axis=1)[:, 0]
    w[step * count :] = along[:, 1] / plate.mesh.edge_lengths  # n_x of the normal of each edge
    g = matrix(plate, Membrane(plate.domain, plate.element, force, degree))
    q = w / plate.layout.scale
    assert q @ (g @ q) == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize(
    ("force", "exact"),
    [
        (uniform(-1, 0, 0, np.pi**2), [4.0, 6.25]),
        (uniform(-1, -1, 0, np.pi**2), [2.0, 5.0]),
        (uniform(0, 0, 1, np.pi**2), [9.324520262, -9.324520262]),
        (uniform(1, 1, 0, np.pi**2), [-2.0, -5.0]),
    ],
)
def test_buckling_of_a_supported_square(force, exact):
    plate = problem(rectangle(10), "argyris", [ks.SimplySupported(SIDES)])
    g = matrix(plate, Membrane(plate.domain, plate.element, force, 0))
    found = factors(CriticalPencil(plate.assembled.matrix, g), 2)
    assert found.values == pytest.approx(exact, rel=5e-6)
    assert found.checked
