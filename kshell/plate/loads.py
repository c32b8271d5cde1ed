"""Loads of a plate: from a scene's words to linear forms."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.errors import InputError
from kshell.material.section import Section
from kshell.mesh.words import place
from kshell.plate.domain import Domain
from kshell.plate.forms import Bending
from kshell.plate.layout import Layout
from kshell.plate.linear_form import Scaled
from kshell.plate.loading import AreaLoad, CurvatureLoad, EdgeLoad, Field, PointLoad
from kshell.plate.places import first_triangles, places_of, points_3d
from kshell.scene.handlers import Handlers, of_acting
from kshell.scene.loads import (
    EdgeMoment,
    Gravity,
    InitialCurvature,
    InitialStrain,
    LineForce,
    Load,
    PlacedPressure,
    PointForce,
    PointMoment,
    Pressure,
    Snow,
    Temperature,
    Traction,
)
from kshell.scene.placed import Placed
from kshell.scene.thermal import couples, free_strain, left_stress
from kshell.scene.weights import weights
from kshell.values.degree import polynomial_degree
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

IN_PLANE = 1e-12

HANDLERS = Handlers('is for shells: take model = "shell", or leave it out')


@dataclass
class Loads:
    """All loads of a scene.

    Attributes
    ----------
    forms : list of Scaled
    curvatures : list of CurvatureLoad
        Those of the forms that are initial curvatures, for moments and energy.
    numbers : list of int
        Of the load in the scene that each form belongs to.
    warnings : list of str
    warmth : list of (number, Placed)
        Temperatures, with the number of the load.
    warned : list of int
        Of the load that each of the warnings is of.
    """

    forms: list[Scaled] = field(default_factory=list)
    curvatures: list[CurvatureLoad] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    warmth: list[tuple[int, Placed[Load]]] = field(default_factory=list)
    warned: list[int] = field(default_factory=list)

    def of(self, number: int) -> list[Scaled]:
        """The forms of one load."""
        return [form for form, mine in zip(self.forms, self.numbers, strict=True) if mine == number]

    def times(self, factors: Sequence[float]) -> Loads:
        """The same loads times factors, (load,)."""
        acting = [(f, k) for f, k in zip(self.forms, self.numbers, strict=True) if factors[k] != 0.0]
        forms = [form.times(float(factors[number])) for form, number in acting]
        curvatures = [form for form in forms if isinstance(form, CurvatureLoad)]
        warmth = [(k, replace(p, item=p.item.times(float(factors[k])))) for k, p in self.warmth]
        warnings, warned = of_acting(self.warnings, self.warned, factors)
        return Loads(forms, curvatures, [number for _, number in acting], warnings, warmth, warned)

    def initial_curvature(self, triangles: Ints, xy: Floats) -> Floats:
        """Sum of initial curvatures (w_xx, w_yy, 2 w_xy) at points (n, point, 2) of triangles (n,)."""
        total = np.zeros((*xy.shape[:2], 3))
        for load in self.curvatures:
            here = slice(None) if load.triangles is None else np.isin(triangles, load.triangles)
            total[here] += load.curvature(triangles[here], xy[here])
        return total

    def left_stress(self, face: int, triangles: Ints, xy: Floats) -> Floats:
        """(n, point, 3) stresses that warm layers keep at the bottom (-1), in the middle (0), at the top (1)."""
        total = np.zeros((*xy.shape[:2], 3))
        for load in self.curvatures:
            here = slice(None) if load.triangles is None else np.isin(triangles, load.triangles)
            total[here] += load.left(face, triangles[here], xy[here])
        return total


def apply_loads(
    loads: Iterable[Placed[Load]],
    domain: Domain,
    layout: Layout,
    bending: Bending,
    section: Section,
    masses: Sequence[Placed[Any]] = (),
) -> Loads:
    """Translate the loads of a structure.

    Parameters
    ----------
    masses : sequence of Placed
        Added ones, which gravity acts on as well.

    Raises
    ------
    InputError
        For loads in the plane, which a plate in bending cannot answer, and those it does not have.
    """
    builder = _Builder(domain, layout, bending, section, masses)
    for number, placed in enumerate(loads):
        builder.number, before = number, len(builder.out.forms)
        HANDLERS.handle(builder, placed, builder.out.warnings)
        builder.out.numbers += [number] * (len(builder.out.forms) - before)
        builder.out.warned += [number] * (len(builder.out.warnings) - len(builder.out.warned))
    return builder.out


class _Builder:
    def __init__(
        self,
        domain: Domain,
        layout: Layout,
        bending: Bending,
        section: Section,
        masses: Sequence[Placed[Any]],
    ) -> None:
        self.masses = masses
        self.domain, self.layout, self.bending, self.section = domain, layout, bending, section
        self.element = layout.element
        self.number = 0
        self.out = Loads()

    def _triangles(self, placed: Placed[Any]) -> Ints | None:
        return None if placed.place is None else self._members(placed)

    def _members(self, placed: Placed[Any]) -> Ints:
        """Edges or vertices."""
        return placed.members(self.domain.mesh).astype(np.int64)

    def _across(self, load: Any, xy: Floats) -> Floats:
        """z component of a vector load at points (..., 2), after refusing components in the plane."""
        value = load.at(places_of(load, self.domain, xy))
        in_plane = np.abs(value[..., :2]).max(initial=0.0)
        if in_plane > IN_PLANE * np.abs(value).max(initial=0.0):
            worst = xy.reshape(-1, 2)[int(np.abs(value[..., :2]).max(axis=-1).argmax())]
            raise InputError(
                f"{load}: it has a component of {in_plane:g} in the plane of the plate at {place(worst)}; a plate in "
                "bending carries loads along z only: set x and y to 0"
            )
        return value[..., 2]

    def _area(
        self, placed: Placed[Any], value: float | Callable[[Ints, Floats], Floats], degree: int | None
    ) -> None:
        self.out.forms.append(AreaLoad(self.domain, self.element, self._triangles(placed), value, degree))

    @HANDLERS.of(Pressure, PlacedPressure)
    def _pressure(self, load: Any, placed: Placed[Any]) -> None:
        if load.follower:
            raise InputError(
                f"{load}: follower = true turns the pressure with the surface, which matters only under large "
                "deflections; leave it out for a linear plate"
            )
        if is_constant(load.value):
            self._area(placed, float(load.value), 0)
        else:
            self._area(
                placed,
                lambda triangles, xy: load.at(places_of(load, self.domain, xy)),
                polynomial_degree(load.value),
            )

    @HANDLERS.of(Traction, Snow)
    def _traction(self, load: Any, placed: Placed[Any]) -> None:
        degree = polynomial_degree(load.value)
        if is_constant(load.value):
            self._area(placed, float(self._across(load, self.domain.points[:1])[0]), degree)
        else:
            self._area(placed, lambda triangles, xy: self._across(load, xy), degree)

    @HANDLERS.of(Gravity)
    def _gravity(self, load: Any, placed: Placed[Any]) -> None:
        def weight(triangles: Ints, xy: Floats) -> Floats:
            mass = self.section.mass(triangles, points_3d(self.domain, xy))
            if not (mass.min(initial=np.inf) > 0.0 or self.masses):
                raise InputError(f"{load}: the material has no density: give it, in mass per volume")
            return mass * self._across(load, xy)

        even = self.section.constant_per_triangle
        degree = polynomial_degree(load.value) if even else None
        if is_constant(load.value) and self.section.uniform:
            first = np.zeros(1, dtype=np.int64)
            middle = self.domain.points[self.domain.mesh.triangles[first]].mean(axis=1)[:, None]
            self._area(placed, float(weight(first, middle)[0, 0]), degree)
        else:
            self._area(placed, weight, degree)
        for added in weights(self.masses, placed, self.domain.mesh):
            HANDLERS.handle(self, added, self.out.warnings)

    @HANDLERS.of(LineForce)
    def _line_force(self, load: Any, placed: Placed[Any]) -> None:
        edges = self._members(placed)
        form = EdgeLoad(
            self.domain,
            self.element,
            edges,
            lambda xy: self._across(load, xy),
            moment=False,
            degree=polynomial_degree(load.value),
        )
        self.out.forms.append(form)

    @HANDLERS.of(EdgeMoment)
    def _edge_moment(self, load: Any, placed: Placed[Any]) -> None:
        edges = self._members(placed)
        inside = edges[self.domain.mesh.edge_counts[edges] > 1]
        if len(inside):
            where = self.domain.points[self.domain.mesh.edges[inside[0]]].mean(axis=0)
            raise InputError(
                f"{load}: the edge at {place(where)} lies inside the plate, where a bending moment has no outward "
                "side; put it on a boundary edge, or use initial_curvature"
            )
        form = EdgeLoad(
            self.domain,
            self.element,
            edges,
            lambda xy: load.at(points_3d(self.domain, xy)),
            moment=True,
            degree=polynomial_degree(load.value),
        )
        self.out.forms.append(form)

    @HANDLERS.of(PointForce)
    def _point_force(self, load: Any, placed: Placed[Any]) -> None:
        for vertex in self._members(placed):
            xy = self.domain.points[vertex]
            force = float(self._across(load, xy[None])[0])
            triangles, corner = first_triangles(self.domain.mesh, np.array([vertex], dtype=np.int64))
            rows = np.zeros((1, self.element.count))
            rows[0, corner[0] * self.layout.per_vertex] = force
            total = np.array([force, 0.0, 0.0])
            self.out.forms.append(PointLoad(self.domain, self.element, triangles, rows, total, xy))

    @HANDLERS.of(PointMoment)
    def _point_moment(self, load: Any, placed: Placed[Any]) -> None:
        for vertex in self._members(placed):
            xy = self.domain.points[vertex]
            mx, my, mz = load.at(points_3d(self.domain, xy[None]))[0]
            if abs(mz) > IN_PLANE * max(abs(mx), abs(my), abs(mz)):
                raise InputError(
                    f"{load}: the component about z, {mz:g}, turns the plate in its plane, which bending cannot "
                    "carry: set it to 0"
                )
            triangles = np.flatnonzero((self.domain.mesh.triangles == vertex).any(axis=1)).astype(np.int64)
            rows = self._gradient_rows(triangles, xy)  # (n, 2, local): the mean over the triangles around
            work = (mx * rows[:, 1] - my * rows[:, 0]) / len(triangles)
            total = np.array([0.0, mx, my])
            self.out.forms.append(PointLoad(self.domain, self.element, triangles, work, total, xy))

    def _gradient_rows(self, triangles: Ints, xy: Floats) -> Floats:
        affine = self.domain.affine(triangles)
        xi = affine.reference_coordinates(np.broadcast_to(xy, (len(triangles), 1, 2)))
        return matrices.rows(self.element, affine, xi, 1, self.element.transformation(affine))[:, 0]

    @HANDLERS.of(Temperature)
    def _temperature(self, load: Any, placed: Placed[Any]) -> None:
        if couples(load, self.section):
            self.out.warnings.append(
                f"{load}: it stretches the plate in its plane, too, which the plate is taken to be free to do: that "
                'part is ignored; model = "shell" has it'
            )
        elif load.stretches(np.zeros((1, 3))):
            self.out.warnings.append(
                f"{load}: the mean temperature stretches the plate in its plane and does not bend it: ignored"
            )

        def curvature(triangles: Ints, xy: Floats) -> Floats:
            return -free_strain(load, self.section, triangles, points_3d(self.domain, xy))[..., 3:]

        def left(face: int, triangles: Ints, xy: Floats) -> Floats:
            return left_stress(load, self.section, face, triangles, points_3d(self.domain, xy))

        degrees = [polynomial_degree((load.mean, load.gradient)), polynomial_degree(load.expansion or 0.0)]
        degree = None if None in degrees else sum(part or 0 for part in degrees)
        self._curvature(placed, curvature, degree, left)
        self.out.warmth.append((self.number, placed))

    @HANDLERS.of(InitialCurvature)
    def _initial_curvature(self, load: Any, placed: Placed[Any]) -> None:
        def curvature(triangles: Ints, xy: Floats) -> Floats:
            return load.curvature_at(points_3d(self.domain, xy)) * np.array([1.0, 1.0, 2.0])

        self._curvature(placed, curvature, polynomial_degree(load.value))

    @HANDLERS.of(InitialStrain)
    def _initial_strain(self, load: Any, placed: Placed[Any]) -> None:
        self.out.warnings.append(f"{load}: it stretches the plate in its plane and does not bend it: ignored")

    def _curvature(
        self,
        placed: Placed[Any],
        curvature: Field,
        degree: int | None,
        left: Callable[[int, Ints, Floats], Floats] | None = None,
    ) -> None:
        form = CurvatureLoad(self.bending, self._triangles(placed), curvature, degree, left)
        self.out.forms.append(form)
        self.out.curvatures.append(form)
