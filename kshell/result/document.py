"""What result.json says of a result: numbers, text, lists and dicts only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from kshell.errors import SolveError
from kshell.scene.writing import scene_words
from kshell.version import __version__

if TYPE_CHECKING:
    from kshell.result.result import Result


def document(result: Result) -> dict[str, Any]:
    """The content of result.json.

    Raises
    ------
    SolveError
        If a value is NaN or infinite; the message says which.
    """
    given = result.input or ({} if result.scene is None else scene_words(result.scene))
    content = {
        "kshell": __version__,
        "title": result.title,
        **({"units": result.units} if result.units else {}),
        "analysis": result.analysis,
        "model": result.model,
        "mesh": {
            "vertices": len(result.mesh.points),
            "triangles": len(result.mesh.triangles),
            "unknowns": result.unknowns,
        },
        "probes": {name: {**values, "frame": result.frame} for name, values in result.probes.items()},
        **({"sheets": result.sheets} if result.sheets else {}),
        **({"nodal_values": result.nodal_values} if result.nodal_values else {}),
        "extremes": result.extremes,
        **({"input": given} if given else {}),
        "strain_energy": result.strain_energy,
        **({"energies": result.energies} if result.energies else {}),
        "external_work": result.external_work,
        "reactions": result.reactions,
        "balance": result.balance,
        "eigen": result.eigen,
        **({"modal": result.modal} if result.modal else {}),
        **({"response": result.response} if result.response else {}),
        "path": result.path,
        **({"critical": result.critical} if result.critical else {}),
        **({"history": result.history} if result.history else {}),
        "error": result.error,
        "solver": result.solver,
        "warnings": result.warnings,
    }
    if result.lines:
        content["lines"] = result.lines
    if result.cases:
        content |= {"case": result.case, "cases": {n: _of_case(result, n) for n in result.cases}}
        content["envelope"] = result.envelope.to_dict()
    return {key: _plain(value, key) for key, value in content.items()}


def _of_case(result: Result, name: str) -> dict[str, Any]:
    """What result.json says of one load case: all but what all cases have in common."""
    common = ("kshell", "title", "units", "mesh", "input")
    own = {key: value for key, value in document(result.cases[name]).items() if key not in common}
    added = result.combinations.get(name)
    return own if added is None else {"combination": added, **own}


def _plain(value: Any, where: str) -> Any:
    """The value made of dicts, lists, text and finite Python numbers."""
    if isinstance(value, Mapping):
        return {str(key): _plain(part, f"{where}.{key}") for key, part in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist(), where)
    if isinstance(value, list | tuple):
        return [_plain(part, f"{where}[{number}]") for number, part in enumerate(value)]
    if isinstance(value, float) and not np.isfinite(value):
        raise SolveError(
            f"the result is not usable: {where} is {value}. Nothing is written; "
            "look at the magnitudes of stiffness, thickness and loads"
        )
    return value
