"""Elastic supports of a plate: from letters of freedoms to quadratic forms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.select import Selection
from kshell.mesh.words import place
from kshell.plate.domain import Domain
from kshell.plate.forms import AreaSpring, EdgeSpring, Form, PointSpring
from kshell.plate.layout import Layout
from kshell.plate.places import first_triangles, points_3d
from kshell.scene.supports import Elastic
from kshell.values.degree import polynomial_degree

Floats = NDArray[np.float64]

UPRIGHT = 1e-9  # component of a unit vector that is rounding


def spring_forms(support: Elastic, selection: Selection, domain: Domain, layout: Layout) -> list[Form]:
    """The energies of the springs of one support.

    Raises
    ------
    InputError
        For springs that couple bending with motion in the plane, and rotation springs where there is no rotation.
    """
    what = f"support {support.kind} on '{selection.label}'"
    letters = _spring_letters(support, what)
    members, element = selection.members.astype(np.int64), layout.element

    def stiffness(xy: Floats) -> Floats:
        return support.stiffness_at(points_3d(domain, xy))

    degree = polynomial_degree(support.stiffness)
    if not letters:
        return []
    if selection.dimension == 2:
        if "r" in letters:
            raise InputError(f"{what}: a rotation spring needs a curve or a point, not a surface")
        return [AreaSpring(domain, element, members, stiffness, degree)]
    if selection.dimension == 1:
        return [
            EdgeSpring(domain, element, members, stiffness, freedom == "r", degree) for freedom in letters
        ]
    return _at_points(letters, selection, stiffness, domain, layout, what)


def _at_points(
    letters: str,
    selection: Selection,
    stiffness: Callable[[Floats], Floats],
    domain: Domain,
    layout: Layout,
    what: str,
) -> list[Form]:
    vertices = selection.members.astype(np.int64)
    k = stiffness(domain.points[vertices])
    dofs = [0] if "z" in letters else []
    if "r" in letters:
        if layout.per_vertex == 1:
            raise InputError(f'{what}: this element has no rotation at a point; use element = "argyris"')
        dofs += [1, 2]
    triangles, corner = first_triangles(domain.mesh, vertices)
    forms: list[Form] = []
    for dof in dofs:
        rows = np.zeros((len(vertices), layout.element.count))
        rows[np.arange(len(vertices)), corner * layout.per_vertex + dof] = 1.0
        forms.append(PointSpring(layout.element, domain, triangles, rows, k))
    return forms


def _spring_letters(support: Elastic, what: str) -> str:
    """Of springs those that a plate in bending feels: "z" and "r".

    Raises
    ------
    InputError
        If some lean out of the plane, so that bending and stretching are not apart.
    """
    letters = ""
    for along in support.directions():
        if isinstance(along, str):
            letters += "r" if along == "r" else "z"
        elif abs(along[2]) > 1.0 - UPRIGHT:
            letters += "z"
        elif abs(along[2]) > UPRIGHT:
            raise InputError(
                f"{what}: a spring along {place(along)} couples bending with motion in the plane, which a plate does "
                'not have: set model = "shell"'
            )
    return letters
