"""What the environment says of several processes, and what they are refused."""

import sys

import pytest

import kshell as ks
from kshell.distributed import team
from kshell.distributed.launch import Launch, launched
from kshell.distributed.refuse import require_parted


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, None),
        ({"PMI_SIZE": "1", "PMI_RANK": "0"}, None),
        ({"PMI_SIZE": "4", "PMI_RANK": "3"}, Launch(3, 4)),
        ({"OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_RANK": "0"}, Launch(0, 2)),
        ({"PMI_SIZE": "many", "PMI_RANK": "0"}, None),
        ({"PMI_SIZE": "4"}, None),
    ],
)
def test_processes_are_found_in_the_environment(environment: dict[str, str], expected: Launch | None) -> None:
    assert launched(environment) == expected


def scene(**more: object) -> ks.Scene:
    mesh = ks.geometry.Cylinder(1.0).mesh(2, 2, 2, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Clamped("a")],
        loads=[ks.Pressure(1e-9)],
        **more,
    )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"analysis": "buckling"}, 'analysis = "buckling"'),
        ({"analysis": "dynamic", "time": 1.0}, 'analysis = "dynamic"'),
        ({"tolerance": 0.01}, "tolerance"),
        ({"analysis": "path", "branch": 1}, "branch"),
        ({"analysis": "modes", "prestress": True}, "prestress"),
        ({"element": "hhj"}, "hhj"),
    ],
)
def test_what_is_not_divided_is_refused(options: dict[str, object], words: str) -> None:
    one = scene()
    with pytest.raises(ks.InputError, match=words):
        require_parted(one, one.solve.updated(**options))


def test_statics_and_paths_are_taken() -> None:
    one = scene()
    require_parted(one, one.solve)
    require_parted(one, one.solve.updated(analysis="path"))
    with pytest.raises(ks.InputError, match="resume"):
        require_parted(one, one.solve.updated(analysis="path"), resume=True)


def test_without_petsc_there_is_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    find = team.importlib.util.find_spec
    monkeypatch.setattr(team.importlib.util, "find_spec", lambda n: None if n == "petsc4py" else find(n))
    team.world.cache_clear()
    with pytest.raises(ks.InputError, match=r"solver = petsc needs .*petsc4py.*kshell\[distributed\]"):
        ks.solve(scene(), solver="petsc")
    monkeypatch.setenv("PMI_SIZE", "3")
    monkeypatch.setenv("PMI_RANK", "1")
    with pytest.raises(ks.InputError, match=r"mpiexec started 3 processes, which need"):
        ks.solve(scene())


def test_nothing_of_mpi_is_loaded_alone() -> None:
    ks.solve(scene())
    assert "petsc4py" not in sys.modules
