"""Load cases one after the other, on one factorisation where the analysis allows it.

A case or combination is the structure under its loads times their factors, `Model.under`, and its prescribed motion as
it is. Combinations are solved like cases: of small deflections that gives the sum of their cases, of large ones the
answer to the loads together, which no sum gives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.clock import Clock
from kshell.analysis.run import Run
from kshell.equilibrium.model import Model
from kshell.errors import InputError, Interrupted, SolveError
from kshell.result.cases import gathered
from kshell.result.result import Result
from kshell.scene.cases import idle_loads
from kshell.scene.structure import resolve

Floats = NDArray[np.float64]
Analyse = Callable[[Model, Run], Result]

# analyses that ask nothing of a model but its answer under other factors of the loads
SHARED = ("static", "path")


def answer_cases(run: Run, analyse: Analyse) -> Result:
    """The results of all cases and combinations, the first at the top.

    Raises
    ------
    InputError
        If the options ask for what cases do not have.
    SolveError, Interrupted
        From the first case without an answer; their `state` holds those before it, too.
    """
    factors = run.scene.case_factors
    _require_possible(run)
    if run.options.analysis == "modes" and not run.options.prestress:
        result = analyse(run.model(), run)
        result.warnings.append(
            "cases: no load acts on modes without prestress, the answer is that of all cases"
        )
        return result
    models = _models(run, factors) if _shares(run) else {}
    found: dict[str, Result] = {}
    for name in factors:
        try:
            found[name] = _case(run, models.pop(name, None), analyse, name, factors[name])
        except (SolveError, Interrupted) as error:
            if isinstance(error.state, Result):
                error.state.scene = run.scene.of_case(name)
                error.state = _together(run, {**found, name: error.state}, factors)
            raise type(error)(f'case "{name}": {error}', error.state) from None
        except InputError as error:
            raise InputError(f'case "{name}": {error}') from None
        found[name].scene = run.scene.of_case(name)
    return _together(run, found, factors)


def _require_possible(run: Run) -> None:
    options = run.options
    if options.analysis == "dynamic":
        raise InputError(
            "a motion has one set of loads: leave the cases out, or take one of them, ks.simulate(scene.of_case(name))"
        )
    if options.tolerance is not None and options.analysis == "static":
        raise InputError(
            f"tolerance = {options.tolerance:g} with load cases: every case would be refined to a mesh of its own, on "
            "which there is no envelope; leave tolerance out, or solve one case alone: a scene file with its loads "
            "and without [[case]], or ks.solve(scene.of_case(name))"
        )


def _shares(run: Run) -> bool:
    """Whether one model serves all cases: not where the shape itself is a buckling mode under the loads."""
    imperfection = run.structure.imperfection
    shaped = imperfection is not None and imperfection.file is None
    return run.options.analysis in SHARED and not shaped


def _models(run: Run, factors: Mapping[str, Floats]) -> dict[str, Model]:
    """One model under the loads of each case, solved for all of them together where each will be solved at all."""
    model = run.model()
    models = {name: model.under(tuple(row.tolist())) for name, row in factors.items()}
    if run.options.analysis == "static" and not run.options.large_asked:
        with suppress(InputError, SolveError), run.clock.stage("solve"):  # the case at fault will say so
            model.solve_ahead(list(models.values()), run.options.solver)
    return models


def _case(run: Run, model: Model | None, analyse: Analyse, name: str, row: Floats) -> Result:
    def tell(words: str) -> None:
        run.tell(f'case "{name}": {words}')

    progress = None if run.progress is None else tell
    folder = None if run.folder is None else run.folder / name.replace("/", "-")
    own = replace(run, clock=Clock(progress), progress=progress, folder=folder)
    if model is not None:
        own = replace(own, factors=tuple(row.tolist()))
        return analyse(model, own)
    scene = run.scene.of_case(name)
    own = replace(own, scene=scene, structure=resolve(scene, run.structure.parameters))
    return analyse(own.model(), own)


def _together(run: Run, found: Mapping[str, Result], factors: Mapping[str, Floats]) -> Result:
    result = gathered(found, {c.name: dict(c.factors) for c in run.scene.combinations if c.name in found})
    result.warnings += [f"load cases: {words}" for words in idle_loads(run.scene.loads, factors)]
    if any(support.moves for support in run.scene.supports):
        result.warnings.append(
            "load cases: the prescribed motion of supports acts in full in every case and in every combination"
        )
    kinds = sorted({f"{r.model['kind']}, {_deflections(r)} deflections" for r in found.values()})
    if len(kinds) > 1:
        result.warnings.append(
            f"load cases: not all are of the same model ({'; '.join(kinds)}): envelopes mix them; model and "
            "large_deflection decide by hand"
        )
    seconds = dict(run.clock.seconds)
    for case in found.values():
        for stage, time in case.solver.get("seconds", {}).items():
            seconds[stage] = seconds.get(stage, 0.0) + time
    result.solver = {**result.solver, "seconds": seconds}
    return result


def _deflections(result: Result) -> str:
    return "large" if result.model["large_deflection"] else "small"
