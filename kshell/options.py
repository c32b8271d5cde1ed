"""How to solve: the keys of [solve] in a scene file and the options of `kshell.solve`."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from kshell.validation import described


def _linear(value: Any) -> Any:
    if value is True:
        raise ValueError(
            'must be "auto" or false: this version computes small deflections only, right while they '
            "stay well below the thickness"
        )
    if value is not False and value != "auto":
        raise ValueError('must be "auto" or false')
    return value


@described("[solve]")
class SolveOptions:
    """Options of a solve.

    Attributes
    ----------
    analysis : "static"
        Deflection under loads.
    model : "auto", "plate" or "shell"
        The Kirchhoff plate in bending, or the Koiter shell: bending and stretching together.
    element : "auto", "morley", "argyris" or "koiter"
        Morley: quadratic plates, cheap. Argyris: of degree five, plates and charts, accurate where the solution
        is smooth. Koiter: shells on any surface, and flat ones.
    order : "auto", 1, 2 or 3
        Of the Koiter element.
    large_deflection : "auto" or False
        Only small deflections are computed.
    solver : "auto", "direct" or "multigrid"
        How the linear system is solved.
    """

    analysis: Literal["static"] = "static"
    model: Literal["auto", "plate", "shell"] = "auto"
    element: Literal["auto", "morley", "argyris", "koiter"] = "auto"
    order: Literal["auto", 1, 2, 3] = "auto"
    large_deflection: Annotated[Any, BeforeValidator(_linear)] = "auto"
    solver: Literal["auto", "direct", "multigrid"] = "auto"

    def updated(self, **changes: Any) -> SolveOptions:
        """These options with some changed.

        Raises
        ------
        InputError
            If an option does not exist or has a value that does not.
        """
        return SolveOptions(**{**asdict(self), **changes})
