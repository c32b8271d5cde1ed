"""All cases, in the order in which they are reported."""

from __future__ import annotations

from functools import cache

from kshell.verify.cases import (
    beams,
    circular,
    cylinders,
    doubly_curved,
    gmsh_shells,
    large,
    materials,
    modal,
    modal_shells,
    polygons,
    rectangles,
    unstructured,
)
from kshell.verify.cases.case import Case


@cache
def all_cases() -> tuple[Case, ...]:
    """Every case."""
    families = (
        rectangles, polygons, circular, unstructured, materials, cylinders, doubly_curved, beams, gmsh_shells,
        large, modal, modal_shells,
    )  # fmt: skip
    return tuple(one for family in families for one in family.cases())


def find(id: str) -> Case:
    """The case with this id.

    Raises
    ------
    KeyError
        If there is none.
    """
    return {one.id: one for one in all_cases()}[id]
