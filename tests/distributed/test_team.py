"""Several processes played by threads: what they put together is what one has, and errors are raised by all."""

import threading
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from scipy.sparse.linalg import splu

import kshell as ks
from kshell.analysis.clock import Clock
from kshell.analysis.model_choice import choose_model
from kshell.analysis.models import as_analysed, model_of_team
from kshell.analysis.run import Run
from kshell.distributed.koiter import PartedDiscretisation, part_of, section_of
from kshell.distributed.matrix import Numbering, Reduced, Scattered
from kshell.distributed.partition import halved, partition
from kshell.distributed.team import Team
from kshell.equilibrium.reduction import Reduction
from kshell.scene.structure import resolve
from kshell.shell.koiter.discretisation import KoiterDiscretisation
from kshell.shell.section import Section
from kshell.solvers.repeated import Factor


class Threads:
    """What a team needs of a communicator, among threads."""

    def __init__(self, rank: int, slots: list[Any], barrier: threading.Barrier) -> None:
        self.rank, self.size, self.slots, self.barrier = rank, len(slots), slots, barrier

    def allgather(self, value: Any) -> list[Any]:
        self.slots[self.rank] = value
        self.barrier.wait()
        found = list(self.slots)
        self.barrier.wait()
        return found

    def bcast(self, value: Any) -> Any:
        return self.allgather(value)[0]

    def Allreduce(self, mine: np.ndarray, out: np.ndarray) -> None:
        out[...] = np.sum(self.allgather(mine), axis=0)

    def Allgatherv(self, mine: np.ndarray, out: tuple[np.ndarray, list[int]]) -> None:
        out[0][...] = np.concatenate([part.ravel() for part in self.allgather(mine)])


def played(size: int, work: Callable[[Team], Any]) -> list[Any]:
    """What each of several threads gives, or its error."""
    slots, barrier, found = [None] * size, threading.Barrier(size, timeout=20.0), [None] * size

    def one(rank: int) -> None:
        try:
            found[rank] = work(Team(Threads(rank, slots, barrier)))
        except BaseException as error:
            found[rank] = error

    threads = [threading.Thread(target=one, args=(rank,), daemon=True) for rank in range(size)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30.0)
    return found


def roof(order: int = 2) -> ks.Mesh:
    return ks.geometry.Cylinder(1.0).mesh(4, 5, order, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))


def test_sums_and_joined_rows_are_the_same_on_all() -> None:
    members = [np.array([1, 4]), np.array([0]), np.array([2, 3])]
    whole = np.arange(10.0).reshape(5, 2)

    def work(team: Team) -> tuple[Any, ...]:
        joined = team.join(members, (2,), lambda: whole[members[team.rank]])
        return (
            joined,
            team.number(lambda: team.rank + 0.5),
            team.sum((2,), lambda: np.array([1.0, team.rank])),
        )

    for joined, number, array in played(3, work):
        np.testing.assert_array_equal(joined, whole)
        assert number == 4.5
        assert array.tolist() == [3.0, 3.0]


@pytest.mark.parametrize("failing", [0, 2])
@pytest.mark.parametrize("how", ["sum", "join", "together", "number"])
def test_the_error_of_one_is_raised_by_all(failing: int, how: str) -> None:
    def work(team: Team) -> Any:
        def own() -> np.ndarray:
            if team.rank == failing:
                raise ks.SolveError("no memory here", state=threading.Lock())
            return np.zeros(1)

        if how == "sum":
            return team.sum((1,), own)
        if how == "join":
            return team.join([np.array([k]) for k in range(3)], (), own)
        return team.together(own) if how == "together" else team.number(lambda: own()[0])

    for error in played(3, work):
        assert isinstance(error, ks.SolveError)
        assert str(error) == "no memory here"


def test_what_cannot_be_sent_is_told_in_words() -> None:
    class Odd(Exception):
        def __init__(self, a: int, b: int) -> None:
            super().__init__(f"{a} {b}")

    def work(team: Team) -> Any:
        def own() -> None:
            if team.rank == 1:
                raise Odd(1, 2)

        team.together(own)

    first, second = played(2, work)
    assert isinstance(second, Odd)
    assert "Odd: 1 2" in str(first)


def test_files_are_read_by_one() -> None:
    read: list[int] = []

    def work(team: Team) -> Any:
        return team.once(lambda: read.append(team.rank) or "content")

    assert played(3, work) == ["content"] * 3
    assert read == [0]


@pytest.mark.parametrize("parts", [1, 2, 3, 7])
def test_parts_are_of_equal_size(parts: int) -> None:
    mesh = roof()
    for found in (partition(mesh, parts), halved(mesh.points[mesh.triangles].mean(axis=1), parts)):
        sizes = np.bincount(found, minlength=parts)
        assert len(sizes) == parts
        assert sizes.min() >= 0.6 * sizes.mean()


def test_more_parts_than_triangles_are_refused() -> None:
    assert len(np.unique(partition(roof(), 40))) == 40
    with pytest.raises(ks.InputError, match="50 processes for 40 triangles"):
        partition(roof(), 50)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("size", [2, 3])
def test_the_energy_of_the_parts_is_that_of_the_whole(order: int, size: int) -> None:
    mesh = roof(1 if order == 1 else 2)
    rng = np.random.default_rng(0)
    thickness = rng.uniform(0.01, 0.02, len(mesh.triangles))
    section = Section.isotropic(1.0, 0.3, thickness)
    given = (mesh, order, None, np.zeros(0, dtype=np.int64))
    whole = KoiterDiscretisation(*given).energy(section)
    x = 1e-2 * rng.standard_normal(whole.unknowns)
    finite = whole.energy(x, 2)
    linear = whole.linear_stiffness()

    def work(team: Team) -> tuple[Any, ...]:
        energy = PartedDiscretisation(team, *given).energy(section)
        own = energy.energy(x, 2)
        strain = energy.linear_strain(x)
        stiffness = energy.linear_stiffness()
        return (
            own.value,
            own.gradient,
            own.hessian @ x,
            strain,
            energy.stress(strain),
            energy.linear_forces(energy.stress(strain)),
            stiffness @ x,
            stiffness.diagonal(),
            energy.strain(x),
            energy.extrapolated_stress(own.linear, x),
        )

    strain = whole.linear_strain(x)
    stress = whole.stress(strain)
    expected = (
        finite.value,
        finite.gradient,
        finite.hessian @ x,
        strain,
        stress,
        whole.linear_forces(stress),
        linear @ x,
        linear.diagonal(),
        whole.strain(x),
        whole.extrapolated_stress(finite.linear, x),
    )
    for found in played(size, work):
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max())


@pytest.mark.parametrize("half", [True, False])
def test_entries_of_the_parts_add_up_in_the_new_numbers(half: bool) -> None:
    mesh = roof()
    section = Section.isotropic(1.0, 0.3, 0.01)
    given = (mesh, 2, None, np.zeros(0, dtype=np.int64))
    whole = KoiterDiscretisation(*given).energy(section)
    basis = np.eye(whole.unknowns)[:, 5:]
    basis[0, 3] = 0.5  # an unknown that follows another
    import scipy.sparse as sp

    basis = sp.csc_matrix(basis)
    springs = sp.diags(np.linspace(0.0, 1.0, whole.unknowns), format="csr")

    reduction = Reduction(basis, np.zeros(whole.unknowns), np.zeros(0, dtype=np.int64))

    def work(team: Team) -> tuple[Any, ...]:
        energy = PartedDiscretisation(team, *given).energy(section)
        matrix = energy.linear_stiffness().plus(springs, 2.0)
        assert isinstance(matrix, Scattered)
        numbering = Numbering(team, basis, energy.owner)
        parts = Reduced(numbering, reduction, half)._rows_by_process(matrix.local)
        return numbering, [part[rank] for part in team.communicator.allgather(parts) for rank in [team.rank]]

    found = played(3, work)
    order = found[0][0].order
    rows = [sum(part.toarray() for part in parts if part is not None) for _, parts in found]
    expected = (basis.T @ (whole.linear_stiffness() + 2.0 * springs) @ basis).toarray()[np.ix_(order, order)]
    expected = np.triu(expected) if half else expected
    np.testing.assert_allclose(np.concatenate(rows), expected, atol=1e-13 * np.abs(expected).max())
    assert sorted(np.concatenate([numbering.own for numbering, _ in found])) == list(range(len(order)))


def test_a_part_keeps_what_its_section_says_of_its_triangles() -> None:
    mesh = roof()
    direction = np.random.default_rng(1).standard_normal((len(mesh.triangles), 3))
    thickness = np.linspace(0.01, 0.02, len(mesh.triangles))
    q = np.diag([1.0, 2.0, 0.5])
    section = Section.from_plane_stress(q, thickness, direction=direction)
    mine = np.array([3, 17, 5])
    part = section_of(section, mine)
    np.testing.assert_array_equal(part.direction, direction[mine])
    np.testing.assert_array_equal(part.bending, section.bending[mine])
    surface = KoiterDiscretisation(mesh, 2, None, np.zeros(0, dtype=np.int64)).surface
    np.testing.assert_allclose(part_of(surface, mine).area_elements, surface.area_elements[mine], rtol=1e-14)


def test_what_remembers_its_past_is_refused() -> None:
    from kshell.material.inelastic import Inelastic

    given = (roof(1), 1, None, np.zeros(0, dtype=np.int64))

    def work(team: Team) -> Any:
        inelastic = Inelastic(relaxation=((np.array([0.5]), 1.0),))
        return PartedDiscretisation(team, *given).energy(Section.isotropic(1.0, 0.3, 0.01), inelastic)

    for error in played(2, work):
        assert isinstance(error, ks.InputError)
        assert "relax" in str(error)


class Gathered:
    """What `PetscFactoriser` does, by scipy: every process puts the whole matrix together."""

    def __init__(self, team: Team, reduction: Reduction, owner: np.ndarray, symmetric: bool = True) -> None:
        self.team, self.reduction = team, reduction

    def factorise(self, matrix: Scattered, definite: bool = True, last: bool = False) -> Factor:
        whole = self.reduction.reduce(sum(self.team.communicator.allgather(matrix.local)).tocsr())
        lu = splu(whole.tocsc())
        return Factor(lu.solve, lambda: int(np.sum(np.linalg.eigvalsh(whole.toarray()) < 0)), False)

    factors = factorise


def scene() -> ks.Scene:
    return ks.Scene(
        mesh=roof(),
        thickness=0.01,
        material=ks.Isotropic(E=1e4, nu=0.3, density=1.0),
        supports=[ks.Clamped("a"), ks.Elastic("c", 2.0, "xyz")],
        loads=[ks.Pressure(1e-3), ks.LineForce("b", (0, 0, 1e-3))],
        probes={"p": (0.5, 0.9, 0.4)},
    )


@pytest.mark.parametrize("analysis", ["static", "modes"])
def test_a_whole_analysis_finds_what_one_process_does(analysis: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kshell.distributed.factor.PetscFactoriser", Gathered)
    monkeypatch.setattr("kshell.distributed.linear.PetscFactoriser", Gathered)
    one = scene()
    options = one.solve.updated(analysis=analysis, count=3 if analysis == "modes" else None)
    alone = ks.solve(one, analysis=analysis, **({"count": 3} if analysis == "modes" else {}))

    def work(team: Team) -> ks.Result:
        structure = as_analysed(resolve(one, one.read_mesh()), choice, options)
        run = Run(one, structure, options, Clock(None))
        analyse = import_module(f"kshell.analysis.{analysis}").analyse
        result: ks.Result = analyse(model_of_team(team, structure, choice), run)
        return result

    choice = choose_model(resolve(one, one.read_mesh()), options)
    for found in played(2, work):
        assert isinstance(found, ks.Result), found
        if analysis == "static":
            np.testing.assert_allclose(found.probes["p"]["u"], alone.probes["p"]["u"], rtol=1e-8, atol=1e-18)
            assert found.model["large_deflection"] == alone.model["large_deflection"]
            assert found.error["estimate"] == pytest.approx(alone.error["estimate"], rel=1e-4)
        else:
            values = [entry["value"] for entry in alone.eigen]
            assert [entry["value"] for entry in found.eigen] == pytest.approx(values, rel=1e-8)
            assert [entry["kind"] for entry in found.eigen] == [entry["kind"] for entry in alone.eigen]
