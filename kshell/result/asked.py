"""What a result is asked for: values at probes, anywhere, along lines, in cuts, along supports, of all load cases."""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError, SolveError
from kshell.result.cases import Envelope
from kshell.scene.line import Line
from kshell.values.naming import listing, suggestion

if TYPE_CHECKING:
    from kshell.result.result import Result

Floats = NDArray[np.float64]


class Asked:
    """Answers of a `Result`, which has the data."""

    probes: MutableMapping[str, dict[str, Any]]
    probe_motions: MutableMapping[str, Floats]
    evaluate: Callable[[Floats], dict[str, Floats]] | None
    cases: dict[str, Result]
    along_supports: Mapping[str, Any]
    reactions: Mapping[str, MutableMapping[str, Any]]

    def probe(self, name: str) -> dict[str, Any]:
        """Values at a probe: x, u (3,), rotation (3,), M (3,), N (3,), stress_top (3,), stress_bottom (3,).

        Raises
        ------
        InputError
            If the scene has no probe of that name; the message lists them.
        """
        if name not in self.probes:
            raise InputError(
                f'no probe "{name}": {suggestion(name, self.probes)}the probes are {listing(self.probes)}'
            )
        return self.probes[name]

    def motion_at_probe(self, name: str) -> Floats:
        """(3,) the displacement u of a probe, without finding its other values."""
        if name in self.probe_motions:
            return self.probe_motions[name]
        return np.asarray(self.probes[name]["u"], dtype=float)

    def at(self, points: ArrayLike) -> dict[str, Floats]:
        """Values at any points (n, 3) or (3,), as for a probe; arrays have one row per point.

        Returns
        -------
        dict
            x, u, rotation, M, N (n, 3), distance (n,) of the points from x, and where stresses are known stress_top,
            stress_middle and stress_bottom (n, 3). N of a plate is zero.

        Raises
        ------
        InputError
            If the points are not (n, 3) finite numbers.
        SolveError
            If this result only has values at vertices.
        """
        x = np.asarray(points, dtype=float)
        if x.shape[-1:] != (3,) or x.ndim > 2 or not np.isfinite(x).all():
            raise InputError(f"points of shape {x.shape}: give (n, 3) finite coordinates")
        if self.evaluate is None:
            raise SolveError("this result has values at vertices only: look at result.fields")
        values = {key: value for key, value in self.evaluate(np.atleast_2d(x)).items() if key != "triangle"}
        if "M" in values:
            values.setdefault("N", np.zeros_like(values["M"]))
        return values

    @property
    def envelope(self) -> Envelope:
        """Smallest and largest values of all load cases, each with its case.

        Raises
        ------
        InputError
            If the scene has no load cases.
        """
        if not self.cases:
            raise InputError("this result has no load cases, which an envelope is of: give the scene cases")
        return Envelope(self.cases)

    def along(self, a: ArrayLike, b: ArrayLike, n: int = 101) -> dict[str, Floats]:
        """Values at n points at equal distances from a to b, as of `at`, and s: how far each is from a.

        Raises
        ------
        InputError
            If the ends are not two points, or n is not a whole number of at least 2.
        SolveError
            If this result only has values at vertices.
        """
        points = Line("along", a, b, n).points()
        values = self.at(points)
        values["distance"] = np.linalg.norm(values["x"] - points, axis=1)
        return {"s": np.linalg.norm(points - points[0], axis=1), **values}

    def reaction_along(self, support: str) -> dict[str, Any]:
        """How the reaction of a support is distributed along its lines.

        Parameters
        ----------
        support : str
            A key of `reactions`.

        Returns
        -------
        dict
            line (n,): number of the line, divided at corners; s (n,): length along it; x (n, 3); force and moment
            (n, 3) per length of the support on the structure, at the ends of every edge and at three points between;
            ends: list of {"at" (3,), "force" (3,)}, concentrated forces at corners, ends and points; resultant: force
            and moment (3,) about the origin, of all of these.

        Notes
        -----
        The line forces are those whose work on the functions of the element is that of the nodal forces
        (`kshell.elements.along`), not derivatives of the solution. Supports share nothing but the force at a corner,
        in equal parts, so that resultants of supports that meet differ from `reactions` by how nodal forces there are
        shared; their sum does not.

        Raises
        ------
        InputError
            If there is no such support along a line.
        SolveError
            If this result does not know it: one that was read from files, or of Argyris shells.
        """
        if support in self.along_supports:
            return self.along_supports[support]
        if support not in self.reactions:
            raise InputError(
                f'no support "{support}": {suggestion(support, self.reactions)}the supports are '
                f"{listing(self.reactions)}"
            )
        if self.along_supports:
            raise InputError(
                f'support "{support}" is not along a line: only its resultant is known, result.reactions'
            )
        raise SolveError(
            "this result has the resultants of its supports only (result.reactions): distributions are found by a "
            "solve, and not of Argyris shells or from files"
        )

    def cut(self, point: ArrayLike, normal: ArrayLike) -> dict[str, Any]:
        """Section forces where a plane cuts the surface: what the part on the side of the normal exerts on the other.

        Parameters
        ----------
        point : (x, y, z)
            Any point of the plane.
        normal : (x, y, z)

        Returns
        -------
        dict
            force and moment (3,), the moment about the centre `at` of the cut; of the force N along the normal and V
            (3,) across it, of the moment the torque T about the normal and M (3,) across it; length of the cut.

        Notes
        -----
        They are integrals of membrane forces, shear forces and moments, and as accurate as these: the moment converges
        faster with the mesh than the shear force, which is a derivative of moments.

        Raises
        ------
        InputError
            If the plane does not cut the surface.
        SolveError
            If this result only has values at vertices.
        """
        from kshell.result.cut import cut

        return cut(cast("Result", self), point, normal)
