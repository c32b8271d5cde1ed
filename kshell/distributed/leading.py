"""One analysis by a team: the first process runs it, the others do their part, and all leave with a result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NoReturn, cast

import numpy as np

from kshell.distributed.factor import NAME
from kshell.distributed.saving import save_pieces
from kshell.distributed.team import Team, sendable
from kshell.errors import Interrupted, SolveError
from kshell.mesh.mesh import Mesh
from kshell.result.result import Result
from kshell.result.rows import Rows
from kshell.solvers.memory import peak_bytes


def _asked_of_first(self: Result, *given: Any, **more: Any) -> NoReturn:
    """Stands for what needs mesh and fields."""
    raise SolveError(
        "the first process alone has mesh and fields of a result: ask there, where mpi4py.MPI.COMM_WORLD.rank is 0; "
        "probes, reactions and extremes are known to all"
    )


@dataclass(kw_only=True, repr=False)
class Told(Result):
    """What processes other than the first have of a result: everything but mesh and fields, which are the first's.

    Its `save` writes the piece that the first process gives this one. What only fields tell is refused.
    """

    at = cut = plot = show = report = _asked_of_first

    def save(
        self, folder: Any, plots: bool = False, report: bool = False, tables: bool = False, xdmf: bool = False
    ) -> list[str]:
        assert self.writer is not None
        return self.writer(self, folder, dict)


def answered(team: Team, work: Callable[[], Result]) -> Result:
    """The result of an analysis that the first process runs.

    Parameters
    ----------
    team : Team
    work : function
        The analysis.

    Returns
    -------
    Result
        `Told` on other processes.

    Raises
    ------
    InputError, SolveError, Interrupted
        As the analysis, on all processes.
    """
    calls = team.calls
    if team.rank:
        error, result = calls.follow()
        if error is not None:
            _with_writer(team, getattr(error, "state", None))
            raise error
        _with_writer(team, result)
        return cast(Result, result)
    calls.lead()
    try:
        result = _finished(team, work())
    except BaseException as error:
        _lasting(team, getattr(error, "state", None))
        told = _told_error(error)
        calls.end(lambda rank: (told, None))
        raise
    calls.end(lambda rank: (None, told_of(result)))
    return result


def _finished(team: Team, result: Result) -> Result:
    """A result with what it took, which needs the others no more but to be written."""
    memory = team.calls.run(largest_memory, team)
    _lasting(team, result)
    for one in _with_cases(result):
        one.solver["peak_memory_mb"] = memory
    return result


def _with_cases(result: Result) -> list[Result]:
    return [*{id(one): one for one in (result, *result.cases.values())}.values()]


def largest_memory(team: Team) -> float:
    """Megabytes of the process that took most."""
    return team.largest(peak_bytes() / 1e6)


def _lasting(team: Team, result: Any) -> None:
    """Find what still needs all processes, and let the result be written by them."""
    if isinstance(result, Result):
        for one in _with_cases(result):
            one.series = [(factor, partial(_known, make())) for factor, make in one.series]
            one.solver["processes"] = team.size
            if one.solver.get("name") == "direct":
                one.solver["name"] = NAME
        _with_writer(team, result)


def _with_writer(team: Team, result: Any) -> None:
    if isinstance(result, Result):
        result.writer = partial(save_pieces, team)


def _known(result: Result) -> Result:
    return result


def told_of(result: Result) -> Told:
    """What other processes get of a result."""
    none = Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))
    given: dict[str, Any] = {name: getattr(result, name) for name in Told.__dataclass_fields__}
    nothing: dict[str, Any] = {"fields": {}, "cell_fields": {}, "edge_fields": {}, "series": [], "lines": {}}
    nothing |= dict.fromkeys(("evaluate", "sampled", "scene", "last_mesh", "writer"))
    cases = {name: told_of(case) for name, case in result.cases.items()}
    given |= {**nothing, "extremes": dict(result.extremes), "cases": cases}
    return Told(**{**given, "mesh": none, "rows": Rows.of_vertices(none)})


def _told_error(error: BaseException) -> BaseException:
    found = sendable(error)
    state = getattr(error, "state", None)
    if isinstance(found, SolveError | Interrupted) and isinstance(state, Result):
        found.state = told_of(state)
    return found
