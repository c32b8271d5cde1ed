"""Material and thickness of a plate or shell at any place: what its stiffness, mass and stresses come from.

Symbols
-------
w''         (w_xx, w_yy, 2 w_xy)
D           bending stiffness (3, 3): (M_xx, M_yy, M_xy) = -D w''
Q           plane-stress stiffness (3, 3); D = t^3 / 12 Q in a single material of thickness t
A, B        membrane and coupling stiffness: N = A E - B w'', M = B E - D w'' with the membrane strain E
sigma       stress at height z: -z Q w''
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.laminate import Laminate, Layer, laminate, require_symmetric
from kshell.material.materials import Material
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import select
from kshell.mesh.words import place
from kshell.values.naming import listing
from kshell.values.varying import is_constant, show, values_at

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# smallest over largest eigenvalue of a stiffness that can still be inverted with a digit left
SOFTEST = 1e-14


class Section:
    """The cross-section of a plate or shell on a mesh. Use `plate_section` or `shell_section` to make one.

    Attributes
    ----------
    constant_per_triangle : bool
        Whether thickness and stiffness do not vary inside triangles.
    """

    def __init__(self, mesh: Mesh, thickness: Any, material: Material | None, stack: Laminate | None) -> None:
        """Thickness as in a scene (or ignored where `stack` is given); checked over the whole mesh."""
        self._given = (thickness, material, stack)
        self._mesh = mesh
        self._stack = stack
        self._Q = np.zeros((3, 3)) if material is None else material.plane_stress()
        self._density = 0.0 if material is None else material.density
        parts = {"thickness": thickness if stack is None else stack.thickness}
        self._part: Ints = np.zeros(len(mesh.triangles), dtype=np.int32)  # which thickness each triangle has
        if isinstance(thickness, Mapping) and stack is None:
            parts = {f'thickness of "{name}"': value for name, value in thickness.items()}
            self._part = _triangle_parts(mesh, list(thickness))
        self._parts = list(parts.items())
        self.constant_per_triangle = all(is_constant(value) for value in parts.values())
        self._uniform = self.constant_per_triangle and len(parts) == 1
        self._check_everywhere()
        self._require_regular()

    def on(self, mesh: Mesh) -> Section:
        """The same on a mesh with vertices moved."""
        return Section(mesh, *self._given)

    @property
    def laminate(self) -> Laminate | None:
        """The layers, where it has some."""
        return self._stack

    @property
    def uniform(self) -> bool:
        """Whether thickness and stiffness are the same everywhere."""
        return self._uniform

    def thickness(self, triangles: Ints, points: Floats) -> Floats:
        """Thickness at points of triangles.

        Parameters
        ----------
        triangles : (n,) int array
        points : (n, q, 3) array

        Returns
        -------
        (n, q) array, > 0.
        """
        result = np.empty(points.shape[:-1])
        part = self._part[triangles]
        for number, (what, value) in enumerate(self._parts):
            mine = slice(None) if len(self._parts) == 1 else np.flatnonzero(part == number)
            here = points[mine]
            t = values_at(value, here, what=what)
            if t.size and not t.min() > 0.0:
                worst = here.reshape(-1, 3)[t.argmin()]
                raise InputError(f"{what}: {show(value)} is {t.min():g} at {place(worst)}: it must be > 0")
            result[mine] = t
        return result

    def bending(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q, 3, 3) stiffness D at points (n, q, 3) of triangles (n,), force times length."""
        if self._stack is not None:
            return np.broadcast_to(self._stack.D, (*points.shape[:-1], 3, 3))
        return (self.thickness(triangles, points) ** 3 / 12.0)[..., None, None] * self._Q

    def membrane(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q, 3, 3) stiffness A at points (n, q, 3) of triangles (n,), force per length."""
        if self._stack is not None:
            return np.broadcast_to(self._stack.A, (*points.shape[:-1], 3, 3))
        return self.thickness(triangles, points)[..., None, None] * self._Q

    @property
    def coupling(self) -> Floats:
        """(3, 3) stiffness B, force; zero unless layers are not symmetric about their middle."""
        return np.zeros((3, 3)) if self._stack is None else self._stack.B

    @property
    def moduli(self) -> tuple[Floats, Floats, Floats]:
        """Plane-stress stiffness Q at the bottom, in the middle and at the top."""
        if self._stack is None:
            return self._Q, self._Q, self._Q
        return self._stack.bottom, self._stack.middle, self._stack.top

    @property
    def stiffness_ratio(self) -> float:
        """The stiffest bending over the softest one; 2 / (1 + nu) of an isotropic plate with nu near -1."""
        shear = np.diag([1.0, 1.0, np.sqrt(2.0)])  # makes the norm of (w_xx, w_yy, 2 w_xy) that of the tensor
        law = shear @ (self._Q if self._stack is None else self._stack.D) @ shear
        value = np.linalg.eigvalsh(law)
        return float(value[-1] / value[0]) if value[0] > 0.0 else np.inf

    def bending_per_triangle(self) -> Floats:
        """(triangle, 3, 3) stiffness D, where `constant_per_triangle` holds."""
        if not self.constant_per_triangle:
            raise ValueError("the thickness varies inside triangles: use bending(triangles, points)")
        every = np.arange(len(self._mesh.triangles))
        if self._uniform:  # one matrix for all, which takes no memory
            one = self.bending(every[:1], self._mesh.points[None, :1])[0, 0]
            return np.broadcast_to(one, (len(every), 3, 3))
        return self.bending(every, self._centroids[:, None])[:, 0]

    def mass(self, triangles: Ints, points: Floats) -> Floats:
        """(n, q) mass per area at points (n, q, 3) of triangles (n,)."""
        if self._stack is not None:
            return np.full(points.shape[:-1], self._stack.mass)
        return self._density * self.thickness(triangles, points)

    def stress_factors(self, triangles: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Factors (n, q, 3, 3) F of the stress sigma = F w'' at the top (z = t/2) and at the bottom.

        For one isotropic material sigma = F w'' equals 12 M z / t^3. Initial curvature is subtracted from
        w'' by the caller.
        """
        half = 0.5 * self.thickness(triangles, points)[..., None, None]
        if self._stack is not None:
            return -half * self._stack.top, half * self._stack.bottom
        return -half * self._Q, half * self._Q

    @property
    def _centroids(self) -> Floats:
        return self._mesh.points[self._mesh.triangles].mean(axis=1)

    def _require_regular(self) -> None:
        """Refuse elastic constants whose softest part is lost in the rounding of the stiffest."""
        laws = (self._Q,) if self._stack is None else (self._stack.A, self._stack.D)
        for law in laws:
            value = np.linalg.eigvalsh(law) if np.isfinite(law).all() else np.full(3, np.nan)
            if not value[0] > value[-1] * SOFTEST:
                raise InputError(
                    f"material: the stiffness in the plane is between {value[0]:.3g} and {value[-1]:.3g}, and double "
                    f"precision cannot keep both apart from rounding (their ratio must exceed {SOFTEST:g}): look at "
                    "the powers of ten of the elastic constants"
                )

    def _check_everywhere(self) -> None:
        """Bad thickness is found before anything is assembled, at the corners of all triangles."""
        every = np.arange(len(self._mesh.triangles))
        if self.constant_per_triangle:
            self.thickness(every, self._centroids[:, None])
        else:
            self.thickness(every, self._mesh.points[self._mesh.triangles])


def plate_section(
    mesh: Mesh,
    thickness: Any = None,
    material: Material | None = None,
    layers: Sequence[Layer] | None = None,
) -> Section:
    """The cross-section of a plate.

    Parameters
    ----------
    mesh : Mesh
    thickness : number, expression in x, y, z, callable, or dict of group name to one of these
    material : Material
    layers : sequence of Layer
        Bottom to top, instead of thickness and material.

    Raises
    ------
    InputError
        If the thickness is not positive somewhere, the groups do not cover every triangle exactly once,
        or the laminate is not symmetric about its middle.
    """
    if layers is not None:
        require_symmetric(laminate(layers))
    return shell_section(mesh, thickness, material, layers)


def shell_section(
    mesh: Mesh,
    thickness: Any = None,
    material: Material | None = None,
    layers: Sequence[Layer] | None = None,
) -> Section:
    """The cross-section of a shell: as `plate_section`, but layers need not be symmetric."""
    if layers is None:
        return Section(mesh, thickness, material, None)
    return Section(mesh, None, None, laminate(layers))


def _triangle_parts(mesh: Mesh, names: list[str]) -> Ints:
    """(triangle,) position in `names` of the group that each triangle belongs to."""
    part = np.full(len(mesh.triangles), -1, dtype=np.int32)
    for number, name in enumerate(names):
        members = select(mesh, name, dimensions=(2,), what="thickness").members
        taken = members[part[members] >= 0]
        if len(taken):
            where = place(mesh.points[mesh.triangles[taken[0]]].mean(axis=0))
            raise InputError(
                f'thickness: the groups "{names[part[taken[0]]]}" and "{name}" overlap '
                f"({len(taken)} triangles, one at {where}): each place needs one thickness"
            )
        part[members] = number
    bare = np.flatnonzero(part < 0)
    if len(bare):
        where = place(mesh.points[mesh.triangles[bare[0]]].mean(axis=0))
        raise InputError(
            f"thickness: {len(bare)} triangles belong to none of the groups {listing(names)} "
            f"(one at {where}): give the thickness of the rest; the surface groups "
            f"are {listing(name for name, group in mesh.groups.items() if group.dimension == 2)}"
        )
    return part
