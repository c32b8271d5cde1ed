"""Which pictures a result has, and the values that each shows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.tensors import principal
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
    "shear": ("shear", SIZE, "size of the shear force Q per length"),
}
PICTURES = (*FIELDS, "mesh")


class Tensor(NamedTuple):
    """A tensor drawn by its principal values: names in the fields and of `Result.at`, words, unit, words for signs."""

    field: str
    at_points: str
    label: str
    powers: tuple[int, int]
    signs: tuple[str, str] = ("tension", "compression")


# picture: crosses along principal directions
PRINCIPAL = {
    "principal_moments": Tensor(
        "moment", "M", "principal moments per length", (1, 0), ("tension at the top", "tension at the bottom")
    ),
    "principal_forces": Tensor("membrane_force", "N", "principal membrane forces per length", (1, -1)),
    **{
        f"principal_stress_{face}": Tensor(
            f"stress_{face}", f"stress_{face}", f"principal stresses {place}", (1, -2)
        )
        for face, place in (("top", "at the top"), ("middle", "in the middle"), ("bottom", "at the bottom"))
    },
}
ROUNDING = 1e-9  # of the largest value: what is none
USUAL_PRINCIPAL = ("principal_moments", "principal_forces")  # the others are drawn when they are named
# powers of force and length in the unit of a field
POWERS = {
    "displacement": (0, 1),
    "moment": (1, 0),
    "membrane_force": (1, -1),
    "von_mises_top": (1, -2),
    "von_mises_middle": (1, -2),
    "von_mises_bottom": (1, -2),
    "shear": (1, -1),
    **{f"stress_{face}": (1, -2) for face in ("top", "middle", "bottom")},
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
# components, drawn when they are named
COMPONENTS: dict[str, tuple[str, int, str]] = {
    "shear_x": ("shear", 0, "shear force Q_x per length"),
    "shear_y": ("shear", 1, "shear force Q_y per length"),
    **{
        f"stress_{face}_{name}": (f"stress_{face}", column, f"stress s_{name} {place}")
        for face, place in (("top", "at the top"), ("middle", "in the middle"), ("bottom", "at the bottom"))
        for column, name in enumerate(("xx", "yy", "xy"))
    },
}


def usual_pictures(result: Result) -> tuple[str, ...]:
    """The pictures that are drawn when none is named, in files and reports."""
    left = (*COMPONENTS, *(name for name in PRINCIPAL if name not in USUAL_PRINCIPAL))
    return tuple(name for name in pictures(result) if name not in left)


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
    shell = result.model.get("kind") == "shell"
    table = SHELL_FIELDS if shell else FIELDS
    shown = [name for name, (values, _, _) in table.items() if values in result.fields]
    shown += [name for name, row in PRINCIPAL.items() if row.field in result.fields and result.evaluate]
    shown += [name for name, (values, _, _) in COMPONENTS.items() if values in result.fields]
    path = ("load_deflection",) if shell and result.path and result.probes else ()
    return (*shown, *path, *motion, "mesh")


def principal_label(result: Result, what: str) -> str:
    """Words for a picture of crosses, with the range of the principal values."""
    row = PRINCIPAL[what]
    found = principal(result.fields[row.field])
    label = labelled(row.label, result.units, *row.powers)
    low, high = float(found.min()), float(found.max())
    nothing = ROUNDING * max(abs(low), abs(high))
    low, high = (value if abs(value) > nothing else 0.0 for value in (low, high))
    return f"{label}, from {low:.4g} to {high:.4g}"


def picture_field(result: Result, what: str) -> tuple[str, int, str]:
    """The field that a picture shows, its column, and words for it."""
    return {**(SHELL_FIELDS if result.model.get("kind") == "shell" else FIELDS), **COMPONENTS}[what]


def picture_values(result: Result, what: str) -> tuple[Floats, str]:
    """Values at the nodes of the rows of fields, and words for the colour bar."""
    name, column, label = picture_field(result, what)
    if name not in result.fields:
        raise InputError(f'no picture "{what}": the result has no field "{name}"')
    values = result.fields[name].reshape(len(result.points), -1)
    values = at_nodes(result.rows, name, values, result.fields, result.edge_fields)
    if result.analysis not in MODAL:  # shapes have no size
        label = labelled(label, result.units, *POWERS[name])
    return column_of(values, column), label


def column_of(values: Floats, column: int) -> Floats:
    """One column of values (..., k), or the length of vectors."""
    return np.asarray(np.linalg.norm(values, axis=-1) if column == SIZE else values[..., column])
