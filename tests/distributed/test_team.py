"""Several processes played by threads: what they put together is what one has, and errors are raised by all."""

import threading
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import kshell as ks
from kshell.analysis.clock import Clock
from kshell.analysis.model_choice import choose_model
from kshell.analysis.models import as_analysed, model_of_team
from kshell.analysis.run import Run
from kshell.distributed.calls import Shared, on_all
from kshell.distributed.koiter import PartedDiscretisation
from kshell.distributed.leading import Told, answered
from kshell.distributed.matrix import Scattered
from kshell.distributed.numbering import Assembled, Basis, Numbering, reduced
from kshell.distributed.partition import cut_by_places, partition, share_of_first
from kshell.distributed.shares import Share
from kshell.distributed.surface_piece import PartSurface, SurfaceData, SurfacePlaces, section_of
from kshell.distributed.team import Team
from kshell.equilibrium.reduction import Reduction
from kshell.scene.structure import resolve
from kshell.shell.koiter.discretisation import KoiterDiscretisation
from kshell.shell.section import Section
from kshell.solvers.repeated import Factor
from tests.distributed.threads import held, led, played


def roof(order: int = 2) -> ks.Mesh:
    return ks.geometry.Cylinder(1.0).mesh(4, 5, order, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))


class Rows(Shared):
    """Rows that every process gives back as it gets them."""

    def __init__(self, team: Team, of_all: list[np.ndarray], count: int) -> None:
        super().__init__(team)
        self.share = Share(team, of_all, count)

    @on_all
    def there_and_back(self, whole: np.ndarray, times: float) -> np.ndarray:
        mine = self.share.spread(whole)
        assert mine.shape == (len(self.share.mine), 2)
        return self.share.collect(lambda: times * mine)


@pytest.mark.parametrize("run", [played, lambda size, work: [led(size, work)]])
def test_rows_are_spread_and_added_up(run: Callable[..., list[Any]]) -> None:
    rows = [np.array([1, 4]), np.array([0, 1]), np.array([2, 3, 4])]
    whole = np.arange(10.0).reshape(5, 2)

    def work(team: Team) -> Any:
        made = team.calls.run(Rows, team, rows, 5)
        return made.there_and_back(whole, 2.0), made.there_and_back(whole, np.float64(1.0))

    often = np.array([1, 2, 1, 1, 2.0])[:, None]
    for twice, once in run(3, work):
        np.testing.assert_array_equal(twice, 2.0 * often * whole)
        np.testing.assert_array_equal(once, often * whole)


def test_what_the_first_drops_the_others_drop() -> None:
    def work(team: Team) -> list[int]:
        counts = []
        for _ in range(3):
            made = team.calls.run(Rows, team, [np.array([0])] * 2, 1)
            counts.append(int(team.calls.run(kept_by_others, team)))
        del made
        return [*counts, int(team.calls.run(kept_by_others, team))]

    first, *_, last = led(2, work)
    assert first == 2  # the object and the share in it
    assert last == 0


def kept_by_others(team: Team) -> float:
    return team.number(lambda: float(len(team.calls._objects)) if team.rank else 0.0)


def test_others_go_on_after_an_error_that_all_have() -> None:
    def work(team: Team) -> int:
        made = team.calls.run(Rows, team, [np.array([0, 1])] * 2, 2)
        with pytest.raises(ks.SolveError, match="on purpose"):
            team.calls.run(failing_on_the_second, team)
        return len(made.there_and_back(np.zeros((2, 2)), 1.0))

    assert led(2, work) == 2


def failing_on_the_second(team: Team) -> None:
    def own() -> None:
        if team.rank == 1:
            raise ks.SolveError("on purpose")

    team.together(own)


@pytest.mark.parametrize("failing", [0, 2])
@pytest.mark.parametrize("how", ["sum", "deal", "collect", "together", "number"])
def test_the_error_of_one_is_raised_by_all(failing: int, how: str) -> None:
    def work(team: Team) -> Any:
        def own() -> np.ndarray:
            if team.rank == failing:
                raise ks.SolveError("no memory here", state=threading.Lock())
            return np.zeros(1)

        if how == "sum":
            return team.sum((1,), own)
        if how == "deal":
            return team.deal(lambda rank: own()) if failing == 0 else team.together(own)
        if how == "collect":
            return Share(team, [np.array([0])] * 3, 1).collect(own)
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
    by_places = cut_by_places(mesh.points[mesh.triangles].mean(axis=1), [1.0 / parts] * parts)
    for found in (partition(mesh, parts), by_places):
        sizes = np.bincount(found, minlength=parts)
        assert len(sizes) == parts
        assert sizes.min() >= 0.6 * sizes.mean()


@pytest.mark.parametrize("parts", [3, 4, 40])
def test_the_first_has_fewer_triangles_as_it_has_the_whole(parts: int) -> None:
    mesh = ks.geometry.Cylinder(1.0).mesh(12, 12, 1, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))
    sizes = np.bincount(partition(mesh, parts, share_of_first(parts)), minlength=parts)
    assert sizes.min() >= 1
    assert sizes[0] < 0.9 * sizes[1:].mean()
    assert share_of_first(2) == 0.5
    assert share_of_first(parts) >= 0.1 / parts


def test_more_parts_than_triangles_are_refused() -> None:
    assert len(np.unique(partition(roof(), 40))) == 40
    with pytest.raises(ks.InputError, match="50 processes for 40 triangles"):
        partition(roof(), 50)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("run", [lambda work: played(2, work), lambda work: [led(3, work)]])
def test_the_energy_of_the_parts_is_that_of_the_whole(order: int, run: Callable[..., list[Any]]) -> None:
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
    for found in run(work):
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
    basis = sp.csc_matrix(basis)
    springs = sp.diags(np.linspace(0.0, 1.0, whole.unknowns), format="csr")

    reduction = Reduction(basis, np.zeros(whole.unknowns), np.zeros(0, dtype=np.int64))

    class Check(Shared):
        """The rows of each process, put together by the first."""

        def __init__(self, team: Team, reduction: Reduction, share: Share) -> None:
            super().__init__(team)
            basis = Basis(team, reduction, share)
            self.numbering = Numbering(team, basis.free.owner)
            self.assembled = Assembled(basis, self.numbering, half)

    def work(team: Team) -> tuple[Any, ...]:
        energy = PartedDiscretisation(team, *given).energy(section)
        matrix = energy.linear_stiffness().plus(springs, 2.0)
        assert isinstance(matrix, Scattered)
        check = Check(team, reduction, matrix.share)
        rows = check.assembled.own_rows(matrix.terms, reduction.reduce(matrix.known))
        return check.numbering, rows

    found = played(3, work)
    order = found[0][0].order
    expected = (basis.T @ (whole.linear_stiffness() + 2.0 * springs) @ basis).toarray()[np.ix_(order, order)]
    expected = np.triu(expected) if half else expected
    rows = np.concatenate([part.toarray() for _, part in found])
    np.testing.assert_allclose(rows, expected, atol=1e-13 * np.abs(expected).max())
    assert sorted(np.concatenate([numbering.own.mine for numbering, _ in found])) == list(range(len(order)))
    assert all(part.has_sorted_indices for _, part in found)


def test_no_process_but_the_first_has_more_than_its_part() -> None:
    mesh = ks.geometry.Cylinder(1.0).mesh(10, 10, 2, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))
    section = Section.isotropic(1.0, 0.3, np.linspace(0.01, 0.02, len(mesh.triangles)))

    def work(team: Team) -> Any:
        energy = PartedDiscretisation(team, mesh, 2, None, np.zeros(0, dtype=np.int64)).energy(section)
        x = np.zeros(energy.unknowns)
        reduction = Reduction(sp.identity(len(x), format="csc")[:, 30:], x, np.zeros(0, dtype=np.int64))
        stiffness = energy.linear_stiffness()
        kept = stiffness, reduced(stiffness, reduction), energy.energy(x, 2, energy.rest)
        energy.linear_forces(energy.stress(energy.linear_strain(x)))
        return team.calls.run(held, team), kept

    whole, part = led(1, work)[0], led(4, work)[0]
    assert part <= 0.4 * whole  # a quarter, and the unknowns on borders


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


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_a_part_of_a_surface_is_as_in_the_whole(order: int) -> None:
    hinges = np.array([7, 12])
    whole = KoiterDiscretisation(roof(1 if order == 1 else 2), order, None, hinges).surface
    mine = np.array([3, 5, 16, 17, 18])
    places = SurfacePlaces.of(whole, mine)
    part = PartSurface(SurfaceData.of(whole, places))
    np.testing.assert_array_equal(places.unknowns[part.triangle_unknowns], whole.triangle_unknowns[mine])
    np.testing.assert_array_equal(places.rotations[part.triangle_rotations], whole.triangle_rotations[mine])
    np.testing.assert_allclose(part.area_elements, whole.area_elements[mine], rtol=1e-13)
    np.testing.assert_allclose(part.edge_tangents, whole.edge_tangents[:, mine], rtol=0, atol=1e-13)
    assert part.unknowns == len(places.unknowns)


def test_a_section_that_varies_inside_triangles_is_dealt_at_their_points() -> None:
    def varying(triangles: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, ...]:
        thick = (0.01 + 0.001 * triangles[:, None] + 0.01 * points[..., 2])[..., None, None]
        return thick * np.eye(3), 0.0 * thick * np.eye(3), thick**3 / 12 * np.eye(3)

    mesh = roof()
    section = replace(Section.isotropic(1.0, 0.3, np.full(len(mesh.triangles), 0.01)), varying=varying)
    given = (mesh, 2, None, np.zeros(0, dtype=np.int64))
    whole = KoiterDiscretisation(*given).energy(section)
    x = np.random.default_rng(0).standard_normal(whole.unknowns)
    found = led(3, lambda team: PartedDiscretisation(team, *given).energy(section).linear_stiffness() @ x)
    expected = whole.linear_stiffness() @ x
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


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
    """What `PetscFactoriser` does, by scipy: the first process puts the whole matrix together."""

    def __init__(self, team: Team, reduction: Reduction, share: Share, symmetric: bool = True) -> None:
        self.team, self.reduction = team, reduction

    def factorise(self, matrix: Scattered, definite: bool = True, last: bool = False) -> Factor:
        whole = self.reduction.reduce(matrix.whole())
        lu = splu(whole.tocsc())
        return Factor(lu.solve, lambda: int(np.sum(np.linalg.eigvalsh(whole.toarray()) < 0)), False)

    factors = factorise

    def near_rest(self, evaluate: object, springs: object = None) -> None:
        return None


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
    choice = choose_model(resolve(one, one.read_mesh()), options)
    read: list[int] = []

    def work(team: Team) -> ks.Result:
        def analysed() -> ks.Result:
            read.append(team.rank)
            structure = as_analysed(resolve(one, one.read_mesh()), choice, options)
            run = Run(one, structure, options, Clock(None))
            analyse = import_module(f"kshell.analysis.{analysis}").analyse
            result: ks.Result = analyse(model_of_team(team, structure, choice), run)
            return result

        return answered(team, analysed)

    first, other = played(2, work)
    assert read == [0]
    assert isinstance(other, Told), other
    assert not len(other.mesh.points)
    for found in (first, other):
        assert isinstance(found, ks.Result), found
        assert found.solver["processes"] == 2
        if analysis == "static":
            np.testing.assert_allclose(found.probes["p"]["u"], alone.probes["p"]["u"], rtol=1e-8, atol=1e-18)
            assert found.model["large_deflection"] == alone.model["large_deflection"]
            assert found.error["estimate"] == pytest.approx(alone.error["estimate"], rel=1e-4)
        else:
            values = [entry["value"] for entry in alone.eigen]
            assert [entry["value"] for entry in found.eigen] == pytest.approx(values, rel=1e-8)
            assert [entry["kind"] for entry in found.eigen] == [entry["kind"] for entry in alone.eigen]


def test_an_error_of_the_first_reaches_the_others_with_its_last_state() -> None:
    alone = ks.solve(scene(), large_deflection=False)

    def fails() -> ks.Result:
        raise ks.SolveError("no equilibrium", state=alone)

    first, other = played(2, lambda team: answered(team, fails))
    for error in (first, other):
        assert isinstance(error, ks.SolveError)
        assert str(error) == "no equilibrium"
    assert first.state is alone
    assert isinstance(other.state, Told)
    assert other.state.probes["p"]["u"].tolist() == alone.probes["p"]["u"].tolist()


def test_parts_of_the_file_are_those_of_the_processes() -> None:
    mesh = roof()
    given = np.arange(len(mesh.triangles)) % 3
    divided = replace(mesh, parts=given)
    np.testing.assert_array_equal(partition(divided, 3, share_of_first(3)), given)
    other = partition(divided, 4)
    np.testing.assert_array_equal(other, partition(mesh, 4))
    empty = replace(mesh, parts=np.minimum(given, 1))  # the last one has nothing
    np.testing.assert_array_equal(partition(empty, 3), partition(mesh, 3))
