"""Material and thickness of a plate or shell at any place: what its stiffness, mass and stresses come from.

Symbols
-------
w''         (w_xx, w_yy, 2 w_xy)
D           bending stiffness (3, 3): (M_xx, M_yy, M_xy) = -D w''
Q           plane-stress stiffness (3, 3); D = t^3 / 12 Q in a single material of thickness t
A, B        membrane and coupling stiffness: N = A E - B w'', M = B E - D w'' with the membrane strain E
S           transverse shear stiffness (2, 2)
sigma       stress at height z: -z Q w''
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.by_group import parts_of
from kshell.material.inelastic import Inelastic, relaxation_of, yielding_of
from kshell.material.laminate import require_symmetric
from kshell.material.materials import guessed_shear
from kshell.material.part import Part
from kshell.material.thermal import Expansion
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.values.varying import show, values_at

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# smallest over largest eigenvalue of a stiffness that can still be inverted with a digit left
SOFTEST = 1e-14
BOTTOM, MIDDLE, TOP = -1, 0, 1
# makes the norm of (w_xx, w_yy, 2 w_xy) that of the tensor
SHEAR = np.outer([1.0, 1.0, np.sqrt(2.0)], [1.0, 1.0, np.sqrt(2.0)])


class Section:
    """The cross-section of a plate or shell on a mesh. Use `plate_section` or `shell_section` to make one.

    Attributes
    ----------
    parts : list of Part
        The cross-sections there are.
    constant_per_triangle : bool
        Whether thickness and stiffness do not vary inside triangles.
    """

    def __init__(self, mesh: Mesh, parts: list[Part], part: Ints) -> None:
        """`part` (triangle,) says which of the parts each triangle has; thicknesses are checked over the whole mesh."""
        self._mesh, self.parts, self._part = mesh, parts, part
        self.constant_per_triangle = all(one.constant for one in parts)
        self._uniform = self.constant_per_triangle and len(parts) == 1
        self._check_everywhere()
        self._require_regular()

    def on(self, mesh: Mesh) -> Section:
        """The same on a mesh with vertices moved."""
        return Section(mesh, self.parts, self._part)

    @property
    def part_numbers(self) -> Ints:
        """(triangle,) number of the part that each triangle has."""
        return np.broadcast_to(self._part, (len(self._mesh.triangles),))

    @property
    def uniform(self) -> bool:
        """Whether thickness and stiffness are the same everywhere."""
        return self._uniform

    @property
    def coupling_ratio(self) -> float:
        """The largest size of B against sqrt(A D): 0 where no part is lopsided about its middle."""
        return max(part.coupled for part in self.parts)

    @property
    def has_stress(self) -> bool:
        """Whether stresses are known everywhere; not where a stiffness is given without its thickness."""
        return all(part.has_stress for part in self.parts)

    def _gather(
        self, triangles: Ints, points: Floats, shape: tuple[int, ...], of: Callable[[Part, Floats], Floats]
    ) -> Floats:
        """What the part of each triangle has, of its thickness at points (n, q, 3): (n, q, *shape)."""
        if len(self.parts) == 1:
            return of(self.parts[0], self._thickness(self.parts[0], points))
        result = np.empty((*points.shape[:-1], *shape))
        mine = self._part[triangles]
        for number, part in enumerate(self.parts):
            here = np.flatnonzero(mine == number)
            if len(here):
                result[here] = of(part, self._thickness(part, points[here]))
        return result

    @staticmethod
    def _thickness(part: Part, points: Floats) -> Floats:
        if isinstance(part.thickness, float) and 0.0 < part.thickness < np.inf:
            return np.full(points.shape[:-1], part.thickness)
        t = values_at(part.thickness, points, what=part.what)
        if t.size and not t.min() > 0.0:
            worst = points.reshape(-1, 3)[t.argmin()]
            raise InputError(
                f"{part.what}: {show(part.thickness)} is {t.min():g} at {place(worst)}: it must be > 0"
            )
        return t

    def thickness(self, triangles: Ints, points: Floats) -> Floats:
        """Thickness at points of triangles; of a stiffness without thickness that of a homogeneous plate alike.

        Parameters
        ----------
        triangles : (n,) int array
        points : (n, q, 3) array

        Returns
        -------
        (n, q) array, > 0.
        """
        return self._gather(triangles, points, (), lambda part, t: t)

    @property
    def thickness_per_triangle(self) -> Floats:
        """(triangle,) thickness in the middle of each."""
        count = len(self._mesh.triangles)
        if self._uniform:
            return np.full(
                count, self.thickness(np.zeros(1, dtype=np.int64), self._mesh.points[None, :1])[0, 0]
            )
        return self.thickness(np.arange(count), self._centroids[:, None])[:, 0]

    def bending(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q, 3, 3) stiffness D at points (n, q, 3) of triangles (n,), force times length."""
        return self._gather(triangles, points, (3, 3), lambda part, t: part.bending(t))

    def membrane(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q, 3, 3) stiffness A at points (n, q, 3) of triangles (n,), force per length."""
        return self._gather(triangles, points, (3, 3), lambda part, t: part.membrane(t))

    def coupling(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q, 3, 3) stiffness B, force; zero unless parts are not symmetric about their middle."""
        return self._gather(triangles, points, (3, 3), lambda part, t: part.coupling(t))

    @cached_property
    def without_shear(self) -> str:
        """Why the transverse shear stiffness is not known, in words; empty where it is."""
        for part in self.parts:
            if part.shear(np.ones(1)) is None:
                return (
                    f"{part.what}: the transverse shear stiffness is not known: give S of a section, G13 and G23 of an "
                    "orthotropic material, or C with six rows"
                )
        return ""

    @cached_property
    def guessed_shear(self) -> str:
        """Which transverse shear moduli were not given and taken as G12, in words; empty where none is."""
        found = {
            name for part in self.parts for material in part.materials for name in guessed_shear(material)
        }
        return f"shear: {' and '.join(sorted(found))} not given, taken as G12" if found else ""

    def shear(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q, 2, 2) transverse shear stiffness S, force per length, where `without_shear` is empty."""

        def of(part: Part, t: Floats) -> Floats:
            found = part.shear(t)
            if found is None:
                raise ValueError(self.without_shear)
            return found

        return self._gather(triangles, points, (2, 2), of)

    def part_of(self, triangle: int) -> Part:
        """The cross-section that a triangle has."""
        return self.parts[self._part[triangle]]

    @property
    def has_yield_stress(self) -> bool:
        """Whether a yield stress is given somewhere."""
        return any(
            part.yield_stress(face) is not None for part in self.parts for face in (BOTTOM, MIDDLE, TOP)
        )

    def yield_stress(self, face: int) -> Floats:
        """(triangle,) yield stress at the bottom (-1), in the middle (0), at the top (1); infinite where not given."""
        limits = [part.yield_stress(face) for part in self.parts]
        return np.array([np.inf if limit is None else limit for limit in limits])[self._part]

    def warming(self, triangles: Ints, expansion: Expansion | None) -> tuple[Floats, Floats]:
        """What triangles (n,) do per unit of temperature in the middle, and of its growth per height (last axis).

        Parameters
        ----------
        expansion : (2,), optional
            Along the axes of the material; that of the materials if absent.

        Returns
        -------
        free : (n, 6, 2)
            Strain and curvature that leave no forces and moments, about the middle, shears doubled.
        left : (n, 3, 3, 2)
            Stress that is left at the bottom, in the middle and at the top.

        Raises
        ------
        InputError
            If a material has no expansion.
        """
        mine = self._part[triangles]
        free, left = np.zeros((len(self.parts), 6, 2)), np.zeros((len(self.parts), 3, 3, 2))
        for number in np.unique(mine).tolist():
            found = self.parts[number].warming(expansion)
            free[number], left[number] = np.concatenate([found.strain, found.curvature]), found.faces
        return free[mine], left[mine]

    def inelastic(self) -> Inelastic:
        """What the shell remembers of its past.

        Raises
        ------
        InputError
            If parts differ in it, or layers harden, or a material relaxes and yields.
        """
        return self._inelastic

    @cached_property
    def _inelastic(self) -> Inelastic:
        relaxation = relaxation_of([part.materials or [None] for part in self.parts], self._part)
        for part in self.parts:
            if len(part.materials) > 1 and any(getattr(m, "hardening", None) for m in part.materials):
                raise InputError(
                    f"{part.what}: layers do not yield: sections yield as a whole, of one material; leave hardening out"
                )
        single = [part.materials[0] if len(part.materials) == 1 else None for part in self.parts]
        if not any(getattr(material, "hardening", None) for material in single):
            return Inelastic(relaxation)
        yielding = yielding_of(single, self._part, self.thickness_per_triangle)
        if relaxation and yielding is not None:
            raise InputError("material: hardening and relaxation given: leave one of them out")
        return Inelastic(relaxation, yielding)

    @property
    def moduli(self) -> list[Floats]:
        """(3, 3) matrices that depend on directions where the section does."""
        return [matrix for part in self.parts for matrix in part.moduli]

    @property
    def stiffness_ratio(self) -> float:
        """The stiffest bending over the softest one; 2 / (1 + nu) of an isotropic plate with nu near -1."""
        ratios = []
        for part in self.parts:
            value = _eigenvalues((SHEAR * part.laws[-1]).tobytes())
            ratios.append(float(value[-1] / value[0]) if value[0] > 0.0 else np.inf)
        return max(ratios)

    def bending_per_triangle(self) -> Floats:
        """(triangle, 3, 3) stiffness D, where `constant_per_triangle` holds."""
        if not self.constant_per_triangle:
            raise ValueError("the thickness varies inside triangles: use bending(triangles, points)")
        count = len(self._mesh.triangles)
        if self._uniform:  # one matrix for all, which takes no memory
            return np.broadcast_to(self.bending_everywhere, (count, 3, 3))
        every = np.arange(count)
        return self.bending(every, self._centroids[:, None])[:, 0]

    @cached_property
    def bending_everywhere(self) -> Floats:
        """(3, 3) D, where `uniform` holds."""
        return self.bending(np.zeros(1, dtype=np.int64), self._mesh.points[None, :1])[0, 0]

    def mass(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q) mass per area at points (n, q, 3) of triangles (n,)."""
        return self._gather(triangles, points, (), lambda part, t: part.mass(t))

    def stress(self, face: int, triangles: Ints, points: Floats) -> tuple[Floats, Floats]:
        """(P, R), (n, q, 3, 3) each: the stress is P E + R kappa at the bottom (-1), in the middle (0), at the top (1).

        E is the strain of the middle of the material, kappa the change of curvature.
        """
        both = self._gather(
            triangles, points, (3, 6), lambda part, t: np.concatenate(part.stress(face, t), axis=-1)
        )
        return both[..., :3], both[..., 3:]

    @property
    def _centroids(self) -> Floats:
        return self._mesh.points[self._mesh.triangles].mean(axis=1)

    def _require_regular(self) -> None:
        """Refuse elastic constants whose softest part is lost in the rounding of the stiffest."""
        for law in (law for part in self.parts for law in part.laws):
            value = _eigenvalues(np.ascontiguousarray(law, dtype=float).tobytes())
            if not value[0] > value[-1] * SOFTEST:
                raise InputError(
                    f"material: the stiffness in the plane is between {value[0]:.3g} and {value[-1]:.3g}, and double "
                    f"precision cannot keep both apart from rounding (their ratio must exceed {SOFTEST:g}): look at "
                    "the powers of ten of the elastic constants"
                )

    def _check_everywhere(self) -> None:
        """Bad thickness is found before anything is assembled, at the corners of all triangles."""
        if not self.constant_per_triangle:
            self.thickness(np.arange(len(self._mesh.triangles)), self._mesh.points[self._mesh.triangles])
            return
        for number, part in enumerate(
            self.parts
        ):  # the same everywhere: looked at in the first of its triangles
            first = int(np.argmax(self._part == number)) if len(self.parts) > 1 else 0
            self._thickness(part, self._mesh.points[self._mesh.triangles[first]].mean(axis=0)[None, None])


@lru_cache(maxsize=256)
def _eigenvalues(law: bytes) -> Floats:
    """Of a symmetric (3, 3) array, ascending: finer meshes and further points of a sweep ask for those of the same."""
    matrix = np.frombuffer(law).reshape(3, 3)
    return np.asarray(np.linalg.eigvalsh(matrix) if np.isfinite(matrix).all() else np.full(3, np.nan))


def plate_section(
    mesh: Mesh, thickness: Any = None, material: Any = None, layers: Any = None, section: Any = None
) -> Section:
    """The cross-section of a plate.

    Parameters
    ----------
    mesh : Mesh
    thickness : number, expression in x, y, z, or callable
    material : Material
    layers : sequence of Layer
        Bottom to top, instead of thickness and material.
    section : kshell.material.given.Section
        Instead of thickness and material. Each may be a dict of surface group to one of these.

    Raises
    ------
    InputError
        If the thickness is not positive somewhere, a triangle has no section or several, or one is not symmetric
        about its middle.
    """
    found = shell_section(mesh, thickness, material, layers, section)
    require_symmetric(found.coupling_ratio)
    return found


def shell_section(
    mesh: Mesh, thickness: Any = None, material: Any = None, layers: Any = None, section: Any = None
) -> Section:
    """The cross-section of a shell: as `plate_section`, but it need not be symmetric."""
    return Section(mesh, *parts_of(mesh, thickness, material, layers, section))
