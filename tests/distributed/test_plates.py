"""Plates in pieces: what the triangles of several processes give together is what the whole plate has."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.distributed.plate import Divided, PartedPlateProblem
from kshell.distributed.team import Team
from kshell.elements import ElementArgyris, ElementMorley
from kshell.mesh.mesh import Group, Mesh
from kshell.plate.assembly import Assembled, assemble
from kshell.plate.pattern import Pattern
from kshell.plate.problem import ELEMENTS, PlateProblem
from kshell.plate.product import strain_product
from kshell.scene.structure import Structure, resolve
from tests.distributed.threads import held, led, played
from tests.plate.plates import disk, rectangle

STEEL = ks.Isotropic(E=1e4, nu=0.3, density=2.0)


def structure(mesh: Mesh, supports: list[Any], loads: list[Any] | None = None, **more: Any) -> Structure:
    given = {"thickness": 0.1, "material": STEEL, **more}
    scene = ks.Scene(mesh=mesh, supports=supports, loads=loads or [ks.Pressure(1.0)], **given)
    return resolve(scene, mesh)


def held_square() -> Structure:
    """All kinds of forms: an area on springs, an elastic edge, a point spring, a prescribed motion, masses."""
    mesh = rectangle(6, 5)
    centres = mesh.points[mesh.triangles].mean(axis=1)
    half = Group(2, np.flatnonzero(centres[:, 0] < 0.5))
    mesh = Mesh(mesh.points, mesh.triangles, None, {**mesh.groups, "half": half})
    supports = [
        ks.Clamped("left"),
        ks.Fixed("right", "z", value=(0, 0, "1e-2*y")),
        ks.Elastic("top", "1 + x", "z"),
        ks.Elastic("half", "2 + x", "z"),
        ks.Elastic((0.5, 0.4), 3.0, "z"),
    ]
    return structure(mesh, supports, masses=[ks.Mass("half", 0.3), ks.Mass((0.5, 0.4), 0.1)])


def bent_disk() -> Structure:
    """Curved edges that are held and turned, and a thickness that varies inside triangles."""
    return structure(disk(4, 2), [ks.Fixed("edge", "zr", value=(0, 0, 1e-3))], thickness="0.1 + 0.02*x")


def stepped_disk() -> Structure:
    """A curved line at which second derivatives jump, on a supported disk."""
    mesh = disk(4, 2)
    radius = np.linalg.norm(mesh.points[:, :2], axis=1)
    inner = (radius[mesh.triangles] < 0.5 + 1e-9).all(axis=1)
    on = (abs(radius[mesh.edges] - 0.5) < 1e-9).all(axis=1)
    middle = np.array(mesh.midpoints)
    middle[on] *= 0.5 / np.linalg.norm(middle[on], axis=1)[:, None]
    groups = {**mesh.groups, "in": Group(2, np.flatnonzero(inner)), "out": Group(2, np.flatnonzero(~inner))}
    found = Mesh(mesh.points, mesh.triangles, middle, groups)
    return structure(found, [ks.SimplySupported("edge")], thickness={"in": 0.1, "out": 0.05})


CASES: dict[str, Callable[[], Structure]] = {
    "square": held_square,
    "disk": bent_disk,
    "stepped": stepped_disk,
}


def answers(found: Assembled, mass: Any, product: Callable[[np.ndarray], np.ndarray]) -> dict[str, Any]:
    """What an analysis asks of a plate."""
    q = np.random.default_rng(0).standard_normal((len(found.load), 2))
    return {
        "matrix": found.matrix @ q,
        "diagonal": found.matrix.diagonal(),
        "mass": mass @ q,
        "product": product(q),
        "load": found.load,
        "fixed load": found.fixed_load,
        "fixed energy": found.fixed_energy,
    }


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("run", [lambda work: [led(3, work)], lambda work: played(2, work)])
def test_the_parts_of_a_plate_are_those_of_the_whole(
    run: Callable[..., Any], case: str, element: str
) -> None:
    given = CASES[case]()
    whole = PlateProblem(given, ELEMENTS[element]())
    pattern = Pattern(whole.reduction)
    inertia = assemble(whole.inertia, [], whole.domain, whole.reduction, pattern).matrix
    expected = answers(whole.assembled, inertia, strain_product(whole))

    def work(team: Team) -> dict[str, Any]:
        problem = PartedPlateProblem(team, given, ELEMENTS[element]())
        mass = Divided(team, problem, problem.inertia).matrix()
        # not by the cached property, which two threads cannot be in at once before Python 3.12
        return answers(problem._assemble(), mass, problem.stiffness.product)

    for found in run(work):
        assert isinstance(found, dict), found
        for name, values in expected.items():
            scale = np.abs(values).max()
            np.testing.assert_allclose(found[name], values, rtol=0, atol=1e-11 * scale, err_msg=name)


@pytest.mark.parametrize("element", [ElementMorley, ElementArgyris])
def test_no_process_but_the_first_has_more_than_its_part_of_a_plate(element: Any) -> None:
    given = structure(rectangle(30, 30), [ks.Clamped("left")])

    def work(team: Team) -> Any:
        problem = PartedPlateProblem(team, given, element())
        kept = problem.assembled.matrix
        problem.stiffness.product(np.zeros(problem.reduction.count))
        return team.calls.run(held, team), kept

    whole, part = led(1, work)[0], led(4, work)[0]
    assert part <= 0.4 * whole  # a third, as the first has few, and the unknowns on borders
