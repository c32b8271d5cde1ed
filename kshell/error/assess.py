"""The estimate that a model has: the one place that knows which."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from kshell.equilibrium.model import Model, Solved
from kshell.error.assessment import Assessment
from kshell.result.result import Result

if TYPE_CHECKING:
    from kshell.equilibrium.problem import State

DUALS = 3  # dual solutions at most, where no tolerance asks for more


def assess(
    model: Model,
    answer: Solved | State,
    result: Result,
    duals: int = DUALS,
    names: Sequence[str] | None = None,
    marks: bool = False,
) -> Assessment:
    """How far a result may be from the exact one of its model.

    Parameters
    ----------
    model : Model
    answer : Solved or State
        Of small deflections, or the end of large ones.
    result : Result
        Of that answer.
    duals : int
        How many dual solutions may be made.
    names : sequence of str, optional
        Probes; all if absent.
    marks : bool
        Whether triangles are to be marked for refinement where that is work of its own.
    """
    wanted = list(model.structure.probes) if names is None else list(names)
    out = _assessed(model, answer, result, duals, wanted, marks)
    if out.probes:
        out.resting(abs(float(result.extremes["deflection"]["value"])))
    return out


def _assessed(
    model: Model, answer: Solved | State, result: Result, duals: int, wanted: list[str], marks: bool
) -> Assessment:
    """By the estimate of the model."""
    rest: Any = answer
    of: Any = model
    if (model.kind, model.element) == ("shell", "koiter"):
        from kshell.error import shells

        if not isinstance(answer, Solved):
            return shells.assess_state(of, answer, result, duals, wanted)
        return shells.assess_small(of, rest.x, result, duals, wanted)
    if (model.kind, model.element) == ("plate", "argyris"):
        from kshell.error.plates import assess_residual

        return assess_residual(of, rest.x, result, duals, wanted)
    if model.kind == "plate":
        from kshell.error.plate_averages import assess_averages

        return assess_averages(of, rest, result, duals, wanted)
    if not isinstance(answer, Solved):
        return Assessment(
            why_not='no estimate of large deflections of Argyris shells: element = "koiter" has one'
        )
    from kshell.error.two_elements import assess_difference

    return assess_difference(of, rest, result, wanted, marks)
