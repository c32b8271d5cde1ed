"""Which pictures a result has, and the values that each shows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.result.result import Result
from kshell.result.vtu import at_nodes
from kshell.values.units import labelled

Floats = NDArray[np.float64]

SIZE = -1  # instead of a column: the length of the vector

# picture: (field, column, label of the colour bar)
FIELDS: dict[str, tuple[str, int, str]] = {
    "deflection": ("displacement", 2, "deflection w"),
    "moment_xx": ("moment", 0, "bending moment M_xx per length"),
    "moment_yy": ("moment", 1, "bending moment M_yy per length"),
    "moment_xy": ("moment", 2, "twisting moment M_xy per length"),
    "von_mises_top": ("von_mises_top", 0, "von Mises stress at the top (z = +t/2)"),
}
PICTURES = (*FIELDS, "mesh")
# powers of force and length in the unit of a field
POWERS = {
    "displacement": (0, 1),
    "moment": (1, 0),
    "membrane_force": (1, -1),
    "von_mises_top": (1, -2),
    "von_mises_middle": (1, -2),
    "von_mises_bottom": (1, -2),
}
# analyses whose fields are shapes of motion
MODAL = ("modes", "buckling")

# of shells, in addition or instead
SHELL_FIELDS: dict[str, tuple[str, int, str]] = {
    **FIELDS,
    "deflection": ("displacement", SIZE, "length of the displacement"),
    "force_xx": ("membrane_force", 0, "membrane force N_xx per length"),
    "force_yy": ("membrane_force", 1, "membrane force N_yy per length"),
    "force_xy": ("membrane_force", 2, "membrane force N_xy per length"),
    "von_mises_top": ("von_mises_top", 0, "von Mises stress at the top (side of the normal)"),
    "von_mises_middle": ("von_mises_middle", 0, "von Mises stress in the middle"),
    "von_mises_bottom": ("von_mises_bottom", 0, "von Mises stress at the bottom"),
}


def pictures(result: Result) -> tuple[str, ...]:
    """The names of the pictures that a result has; of a refined one its error on the mesh, and how it fell."""
    along = ("reactions",) if any(len(values["s"]) for values in result.along_supports.values()) else ()
    refined = ("error", "convergence") if result.last_mesh is not None else ()
    return (*_of_analysis(result), *along, *refined)


def _of_analysis(result: Result) -> tuple[str, ...]:
    """The pictures that the analysis of a result has."""
    if result.response:
        return ("response", "mesh")
    if result.analysis in MODAL:
        return ("modes", *(f"mode_{number}" for number in range(1, len(result.eigen) + 1)), "mesh")
    motion = ("history", "film") if result.history else ()
    if result.model.get("kind") != "shell":
        shown = (name for name, (values, _, _) in FIELDS.items() if values in result.fields)
        return (*shown, *motion, "mesh")
    path = ("load_deflection",) if result.path and result.probes else ()
    shown = (name for name, (values, _, _) in SHELL_FIELDS.items() if values in result.fields)
    return (*shown, *path, *motion, "mesh")


def picture_values(result: Result, what: str) -> tuple[Floats, str]:
    """Values at the nodes of the rows of fields, and words for the colour bar."""
    name, column, label = (SHELL_FIELDS if result.model.get("kind") == "shell" else FIELDS)[what]
    if name not in result.fields:
        raise InputError(f'no picture "{what}": the result has no field "{name}"')
    values = result.fields[name].reshape(len(result.points), -1)
    values = at_nodes(result.rows, name, values, result.fields, result.edge_fields)
    if result.analysis not in MODAL:  # shapes have no size
        label = labelled(label, result.units, *POWERS[name])
    return (np.linalg.norm(values, axis=1) if column == SIZE else values[:, column]), label
