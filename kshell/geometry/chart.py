"""Charts: regular parametrisations x(u, v) of surfaces in space, vectorised over points."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.geometry.chart_mesh import mesh_on_chart
from kshell.geometry.components import Floats, stacked
from kshell.geometry.curve import Curve
from kshell.geometry.exact import SymbolicMap, traced
from kshell.geometry.places import Range, interval, parameter_arrays, refuse_where
from kshell.geometry.quadrature import over_rectangle
from kshell.geometry.smooth import AffineMap, ComposedMap, GivenMap, SmoothMap
from kshell.geometry.surface_curve import SurfaceCurve
from kshell.geometry.surface_point import PARAMETERS, SurfacePoint
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import shown


class Chart:
    """A surface x(u, v).

    Parameters
    ----------
    x : callable or SmoothMap
        x(u, v) for arrays u, v of one shape: a tuple of three arrays, or one array (..., 3).
    derivatives : sequence of callables, optional
        The first returns (x_u, x_v), the second (x_uu, x_uv, x_vv), the third (x_uuu, x_uuv, x_uvv, x_vvv).
        Left out, `x` is traced and differentiated by sympy, which needs a function made of numpy functions.
    domain : pair of pairs
        Ranges of u and v that `area` and `mesh` take when none are given.
    name : str
        For messages.

    Raises
    ------
    InputError
        If the derivatives cannot be derived, or those given do not belong to `x`.
    """

    def __init__(
        self,
        x: Callable[..., Any] | SmoothMap,
        derivatives: Sequence[Callable[..., Any]] | None = None,
        domain: tuple[Range, Range] = ((0.0, 1.0), (0.0, 1.0)),
        name: str = "chart",
    ) -> None:
        self.domain = (interval("the range of u", domain[0]), interval("the range of v", domain[1]))
        self.name = name
        if isinstance(x, SmoothMap):
            self.map = x
        elif derivatives is None:
            self.map = traced(x, PARAMETERS, 3)
        else:
            self.map = given = GivenMap(x, derivatives, 2, 3)
            given.check(self.domain)
        if (self.map.parameters, self.map.components) != (2, 3):
            raise InputError(f"{name}: a chart has 2 parameters and 3 components")

    @classmethod
    def from_expressions(
        cls,
        x: str,
        y: str,
        z: str,
        parameters: tuple[str, str] = PARAMETERS,
        constants: Mapping[str, float] | None = None,
        domain: tuple[Range, Range] = ((0.0, 1.0), (0.0, 1.0)),
        name: str = "chart",
    ) -> Chart:
        """A chart from three formulas, such as "u*cos(v)", "u*sin(v)", "2*v"; its derivatives are exact.

        Raises
        ------
        InputError
            If a formula cannot be read or is not differentiable.
        """
        return Chart(SymbolicMap.from_texts([x, y, z], parameters, constants), domain=domain, name=name)

    def __repr__(self) -> str:
        return f"<{self.name}>"

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """(..., 3) the points x(u, v), also where the parametrisation is singular."""
        return self.derivatives(u, v, order=0)[0]

    def derivatives(self, u: ArrayLike, v: ArrayLike, order: int = 2) -> tuple[Floats, ...]:
        """Point and partial derivatives, without any check of regularity.

        Returns
        -------
        tuple of arrays
            The point (..., 3), x_i as (..., 2, 3), x_ij as (..., 2, 2, 3), and so on up to `order`;
            the axes before the last count the parameters by which is differentiated.

        Raises
        ------
        InputError
            If a parameter is not finite, the chart is not finite there, or the order is not known.
        """
        where = parameter_arrays(PARAMETERS, (u, v))
        self.map.require(order, f"{self.name}: this")
        partials = self.map.partials(where, order)
        out = []
        for n in range(order + 1):
            arrays = [stacked(partials[n - j, j], where[0].shape) for j in range(n + 1)]
            refuse_where(
                ~np.logical_and.reduce([np.isfinite(a).all(axis=-1) for a in arrays]), PARAMETERS, where,
                f"{self.name} or one of its derivatives is not finite", "stay inside the domain of the chart",
            )  # fmt: skip
            full = np.empty((*where[0].shape, *(2,) * n, 3))
            for axes in np.ndindex(*(2,) * n):
                full[(..., *axes, slice(None))] = arrays[sum(axes)]
            out.append(full)
        return tuple(out)

    def at(self, u: ArrayLike, v: ArrayLike) -> SurfacePoint:
        """The differential geometry at parameters u, v, which are broadcast.

        Raises
        ------
        InputError
            Where the chart is singular or not finite; the message has the parameters.
        """
        u, v = parameter_arrays(PARAMETERS, (u, v))
        return SurfacePoint(self.map, self.name, u, v)

    def integrate(
        self,
        f: Callable[[SurfacePoint], ArrayLike],
        u_range: Sequence[float] | None = None,
        v_range: Sequence[float] | None = None,
        scale: float = 0.0,
    ) -> float:
        """Integral over the surface, dA = |x_u x x_v| du dv, of a function of its points.

        The relative error sought is 1e-13 of the integral of |f|, or of `scale` if that is larger: give the
        natural size of the answer where f may be zero but for rounding. Missing 1e-9 is a KshellWarning.
        """

        def integrand(u: Floats, v: Floats) -> Floats:
            s = self.at(u, v)
            return np.asarray(f(s)) * s.area_element

        return over_rectangle(
            integrand, *self.ranges(u_range, v_range), f"the integral over the {self.name}", scale
        )

    def area(self, u_range: Sequence[float] | None = None, v_range: Sequence[float] | None = None) -> float:
        """Area of the part over a rectangle of parameters (the whole domain if none is given)."""
        return self.integrate(lambda s: np.ones(s.shape), u_range, v_range)

    def ranges(self, u_range: Sequence[float] | None, v_range: Sequence[float] | None) -> tuple[Range, Range]:
        """The given ranges, checked; those of the domain where None."""
        u = self.domain[0] if u_range is None else interval("the range of u", u_range)
        v = self.domain[1] if v_range is None else interval("the range of v", v_range)
        return u, v

    def mesh(
        self,
        n_u: int,
        n_v: int,
        order: int = 2,
        names: Sequence[str | None] = ("u0", "u1", "v0", "v1"),
        u_range: Sequence[float] | None = None,
        v_range: Sequence[float] | None = None,
        pattern: str = "diagonal",
    ) -> Mesh:
        """Triangles of order 1 or 2 on the surface, oriented as its normal, with named sides.

        Sides that coincide (a cylinder's seam) are glued, a side that is one point (a pole) becomes one
        vertex. See `kshell.geometry.chart_mesh`.

        Parameters
        ----------
        n_u, n_v : int
            Cells along u and v, each cut into triangles.
        order : {1, 2}
            With 2 the mid-edge nodes lie on the surface.
        names : four of str or None
            Names of the sides u = first, u = last, v = first, v = last; equal names make one group.
        u_range, v_range : pairs, optional
        pattern : {"diagonal", "alternate", "crossed"}
            One diagonal per cell, alternating diagonals, or both diagonals with a vertex in the middle.
        """
        return mesh_on_chart(self, self.name, n_u, n_v, order, names, *self.ranges(u_range, v_range), pattern)

    def parameter_mesh(
        self,
        n_u: int,
        n_v: int,
        names: Sequence[str | None] = ("u0", "u1", "v0", "v1"),
        u_range: Sequence[float] | None = None,
        v_range: Sequence[float] | None = None,
        pattern: str = "diagonal",
    ) -> Mesh:
        """The same triangles flat in the (u, v) plane: the mesh of a scene that is given by a chart."""
        flat = Chart(
            SymbolicMap.from_texts(["u", "v", "0"], PARAMETERS), name=f"parameters of the {self.name}"
        )
        return mesh_on_chart(flat, flat.name, n_u, n_v, 1, names, *self.ranges(u_range, v_range), pattern)

    def along(self, path: Curve) -> SurfaceCurve:
        """The curve on the surface over a path in the (u, v) plane."""
        return SurfaceCurve(self.map, self.name, path)

    def moved(self, rotation: ArrayLike, shift: ArrayLike = (0.0, 0.0, 0.0)) -> Chart:
        """The chart rotation @ x + shift. The matrix may be any; a rigid motion needs a rotation."""
        return Chart(AffineMap(self.map, rotation, shift), domain=self.domain, name=f"moved {self.name}")

    def reparametrised(self, parameters: Chart, domain: tuple[Range, Range] | None = None) -> Chart:
        """x(phi(s, t)), where `parameters` is phi as a chart of the plane: its x and y are u and v."""
        return Chart(
            ComposedMap(self.map, parameters.map), domain=domain or parameters.domain, name=self.name
        )

    def swapped(self) -> Chart:
        """The chart x(v, u): the same surface with the opposite normal."""
        swap = Chart(SymbolicMap.from_texts(["v", "u", "0"], PARAMETERS), domain=self.domain[::-1])
        return self.reparametrised(swap)


class ReadyChart(Chart):
    """A chart with a name and constants, whose map is written by hand."""

    def __init__(self, ready_map: SmoothMap, domain: tuple[Range, Range], **constants: float) -> None:
        # "MonkeySaddle" is called "monkey saddle"
        kind = "".join(" " + c.lower() if c.isupper() else c for c in type(self).__name__).strip()
        for key, value in constants.items():
            number = isinstance(value, (int, float, np.integer, np.floating))
            if not (number and np.isfinite(value) and value > 0.0):
                raise InputError(f"{kind}: {key} = {shown(value)} must be a positive number")
        self.constants = constants
        super().__init__(ready_map, domain=domain, name=kind)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{k}={v:g}' for k, v in self.constants.items())})"

    def __eq__(self, other: object) -> bool:
        return (
            type(self) is type(other) and isinstance(other, ReadyChart) and self.constants == other.constants
        )

    def __hash__(self) -> int:
        return hash((type(self).__name__, tuple(self.constants.items())))
