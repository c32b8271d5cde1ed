"""Elastic materials, and what remains of them in plane stress.

Symbols
-------
Q           plane-stress stiffness: (sigma_xx, sigma_yy, sigma_xy) = Q (e_xx, e_yy, 2 e_xy)
C           stiffness in space, in the order xx yy zz yz xz xy with engineering shears
theta       angle from the global x axis to material axis 1, counter-clockwise about z
T           strains in material axes = T strains in global axes
"""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import WithJsonSchema

from kshell.errors import InputError
from kshell.material.elastic_constants import elastic_constants, require_positive
from kshell.material.elastic_symmetry import stiffness, stiffness_matrix
from kshell.material.expansion import ExpansionKey
from kshell.material.inelastic import Hardening, Relaxation, require_yield_stress
from kshell.values import kinds
from kshell.values.validation import Number, described

Floats = NDArray[np.float64]


class Material(Protocol):
    """What plates and shells ask of a material."""

    @property
    def density(self) -> float:
        """Mass per volume."""

    def plane_stress(self) -> Floats:
        """(3, 3) stiffness Q in global axes, force per area."""


def strain_rotation(angle: float) -> Floats:
    """T of the table above for an angle in degrees: (3, 3), engineering shears.

    Q_global = T^T Q_material T, because the energy does not depend on the axes.
    """
    theta = np.deg2rad(angle)
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])


def rotated(stiffness: ArrayLike, angle: float) -> Floats:
    """Plane-stress stiffness (3, 3) in global axes of a material turned by an angle in degrees."""
    rotation = strain_rotation(angle)
    turned = rotation.T @ np.asarray(stiffness, dtype=float) @ rotation
    return 0.5 * (turned + turned.T)


@described("material")
class Isotropic:
    """The same in all directions. Give E and nu, or lame_lambda and lame_mu.

    Attributes
    ----------
    E : float [force / length^2]
        Young's modulus, > 0.
    nu : float [1]
        Poisson's ratio, -1 < nu < 1/2.
    lame_lambda, lame_mu : float [force / length^2]
        Lame's constants instead of E and nu; lame_mu is the shear modulus.
    density : float [mass / length^3]
        Mass per volume.
    yield_stress : float, optional [force / length^2]
        Against which von Mises stresses are held as `utilisation`; with hardening the shell yields.
    expansion : float or [a1, a2], optional [1 / temperature]
        Coefficient of thermal expansion, along both axes of the material or along each; for temperature loads.
    hardening : float or [isotropic, kinematic], optional [force / length^2]
        Growth of the yield stress per plastic strain; with it the section yields as a whole, by Ilyushin's surface.
    relaxation : list of [g, tau], optional [1, time]
        Of a motion: parts g of the stiffness that are lost with the times tau (Prony series); what is given is the
        stiffness against sudden strains.

    Raises
    ------
    InputError
        If not exactly one of the two pairs is given or a constant is outside its limits.

    Examples
    --------
    ```toml
    [material]
    E = 210e9
    nu = 0.3
    density = 7850
    yield_stress = 235e6
    expansion = 1.2e-5
    hardening = 2e9

    [group.web.material]
    lame_lambda = 1.2e11
    lame_mu = 8.1e10
    ```
    """

    E: Number | None = None
    nu: Number | None = None
    lame_lambda: Number | None = None
    lame_mu: Number | None = None
    density: Number = 0.0
    yield_stress: Number | None = None
    expansion: ExpansionKey = None
    hardening: Hardening = None
    relaxation: Relaxation = None

    def __post_init__(self) -> None:
        pairs = {name: getattr(self, name) for name in ("E", "nu", "lame_lambda", "lame_mu")}
        given = {name: value for name, value in pairs.items() if value is not None}
        if set(given) not in ({"E", "nu"}, {"lame_lambda", "lame_mu"}):
            raise InputError(
                f"material: {' and '.join(given) or 'nothing'} given: an isotropic material needs E and nu, "
                "or lame_lambda and lame_mu (Isotropic.from_constants takes any two constants)"
            )
        constants = elastic_constants(**given)
        for name in pairs:
            object.__setattr__(self, name, constants[name])
        _require_density(self.density)
        _require_yield_stress(self.yield_stress)
        require_yield_stress(self.hardening, self.yield_stress)

    @classmethod
    def from_constants(cls, density: float = 0.0, **two: float) -> Isotropic:
        """From any two of E, nu, lame_lambda, lame_mu, bulk_modulus."""
        constants = elastic_constants(**two)
        return cls(E=constants["E"], nu=constants["nu"], density=density)

    @property
    def bulk_modulus(self) -> float:
        """K = E / (3 (1 - 2 nu))."""
        return self.E / (3.0 * (1.0 - 2.0 * self.nu))  # type: ignore[operator]

    def plane_stress(self) -> Floats:
        """(3, 3) stiffness Q, force per area; the shear term is lame_mu."""
        E, nu = float(self.E), float(self.nu)  # type: ignore[arg-type]
        return E / (1.0 - nu * nu) * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])

    def __repr__(self) -> str:
        return f"Isotropic(E={self.E!r}, nu={self.nu!r}, density={self.density!r})"


@described("material")
class Orthotropic:
    """Two perpendicular material axes in the plane, axis 1 turned by `angle` degrees from x.

    Attributes
    ----------
    E1, E2 : float [force / length^2]
        Young's moduli along the axes, > 0.
    nu12 : float [1]
        Contraction along 2 under stress along 1; nu12^2 < E1 / E2.
    G12 : float [force / length^2]
        Shear modulus in the plane, > 0.
    angle : float [degrees]
        Degrees from the global x axis to axis 1, counter-clockwise.
    density : float [mass / length^3]
        Mass per volume.
    yield_stress : float, optional [force / length^2]
        Against which von Mises stresses are held as `utilisation`.
    expansion : float or [a1, a2], optional [1 / temperature]
        Coefficient of thermal expansion, along both axes of the material or along each; for temperature loads.
    relaxation : list of [g, tau], optional [1, time]
        Of a motion: parts g of the stiffness that are lost with the times tau (Prony series); what is given is the
        stiffness against sudden strains.
    G13, G23 : float, optional [force / length^2]
        Transverse shear moduli along the axes, > 0; G12 where they are not given. Only how much shear would add to the
        deflection, and shear stresses, hang on them.

    Examples
    --------
    ```toml
    [material]
    E1 = 140e9
    E2 = 10e9
    nu12 = 0.3
    G12 = 5e9
    G13 = 5e9
    G23 = 3.5e9
    angle = 30
    density = 1600
    yield_stress = 900e6
    expansion = [-0.5e-6, 30e-6]
    relaxation = [[0.2, 10.0], [0.1, 1000.0]]
    ```
    """

    E1: Number
    E2: Number
    nu12: Number
    G12: Number
    angle: Number = 0.0
    density: Number = 0.0
    G13: Number | None = None
    G23: Number | None = None
    yield_stress: Number | None = None
    expansion: ExpansionKey = None
    relaxation: Relaxation = None

    def __post_init__(self) -> None:
        for name in ("E1", "E2", "G12", "G13", "G23"):
            if getattr(self, name) is not None:
                require_positive(name, getattr(self, name))
        if self.nu12**2 >= self.E1 / self.E2:
            raise InputError(
                f"material: nu12 = {self.nu12:g} must lie between -{(self.E1 / self.E2) ** 0.5:g} and "
                f"{(self.E1 / self.E2) ** 0.5:g}, the square root of E1 / E2 (positive energy): "
                "nu12 is the contraction along axis 2 under stress along axis 1"
            )
        _require_density(self.density)
        _require_yield_stress(self.yield_stress)

    def plane_stress(self) -> Floats:
        """(3, 3) stiffness Q in global axes, force per area."""
        nu21 = self.nu12 * self.E2 / self.E1
        scale = 1.0 / (1.0 - self.nu12 * nu21)
        coupling = scale * self.nu12 * self.E2
        axes = np.array(
            [[scale * self.E1, coupling, 0.0], [coupling, scale * self.E2, 0.0], [0.0, 0.0, self.G12]]
        )
        return rotated(axes, self.angle)


@described("material")
class Anisotropic:
    """Any elastic material, from its stiffness.

    Attributes
    ----------
    C : (6, 6) or (3, 3) array [force / length^2]
        Stiffness in space in the order xx yy zz yz xz xy (it is reduced to plane stress), or the
        plane-stress stiffness in the order xx yy xy; engineering shears. Symmetric, positive definite.
    density : float [mass / length^3]
        Mass per volume.
    yield_stress : float, optional [force / length^2]
        Against which von Mises stresses are held as `utilisation`.
    expansion : float or [a1, a2], optional [1 / temperature]
        Coefficient of thermal expansion, along both axes of the material or along each; for temperature loads.
    relaxation : list of [g, tau], optional [1, time]
        Of a motion: parts g of the stiffness that are lost with the times tau (Prony series); what is given is the
        stiffness against sudden strains.
    angle : float [degrees]
        Degrees from the global x axis to material axis 1, counter-clockwise.

    Examples
    --------
    ```toml
    [material]
    C = [[170e9, 60e9, 0], [60e9, 170e9, 0], [0, 0, 40e9]]
    density = 2330
    angle = 45
    yield_stress = 300e6
    expansion = 2.6e-6
    ```
    """

    C: Annotated[Any, WithJsonSchema(kinds.either(kinds.matrix(6), kinds.matrix(3)))]
    density: Number = 0.0
    angle: Number = 0.0
    yield_stress: Number | None = None
    expansion: ExpansionKey = None
    relaxation: Relaxation = None
    _stiffness: Any = field(init=False, repr=False, compare=False, default=None)

    def __post_init__(self) -> None:
        matrix = stiffness_matrix(self.C)
        object.__setattr__(self, "C", tuple(map(tuple, matrix.tolist())))  # comparable and immutable
        object.__setattr__(self, "_stiffness", matrix)
        _require_density(self.density)
        _require_yield_stress(self.yield_stress)

    @classmethod
    def of_class(cls, kind: str, angle: float = 0.0, density: float = 0.0, **constants: float) -> Anisotropic:
        """A material of a symmetry class ("cubic", "monoclinic", "trigonal", ...) from its constants C11, C12, ...

        The distinguished axis is z, the normal of the plate; see `kshell.material.elastic_symmetry.CLASSES`.
        """
        return cls(C=stiffness(kind, **constants), density=density, angle=angle)

    @classmethod
    def cubic(
        cls, C11: float, C12: float, C44: float, angle: float = 0.0, density: float = 0.0
    ) -> Anisotropic:
        """Three equal axes, one of them along z; `angle` turns the others about z, in degrees."""
        return cls.of_class("cubic", angle, density, C11=C11, C12=C12, C44=C44)

    @classmethod
    def monoclinic(cls, *, angle: float = 0.0, density: float = 0.0, **constants: float) -> Anisotropic:
        """One plane of symmetry, the plane of the plate (z constant): 13 constants C11 ... C66.

        C16, C26, C36 and C45 are 0 where they are not given.
        """
        return cls.of_class("monoclinic", angle, density, **constants)

    def plane_stress(self) -> Floats:
        """(3, 3) stiffness Q in global axes, force per area.

        From (6, 6), the stresses zz, yz, xz are zero and their strains are eliminated:
        Q = C_pp - C_pn C_nn^-1 C_np with p = xx, yy, xy and n = zz, yz, xz.
        """
        C = self._stiffness
        if len(C) == 6:
            p, n = [0, 1, 5], [2, 3, 4]
            C = C[np.ix_(p, p)] - C[np.ix_(p, n)] @ np.linalg.solve(C[np.ix_(n, n)], C[np.ix_(n, p)])
        return rotated(C, self.angle)


def _require_yield_stress(value: float | None) -> None:
    if value is not None and not value > 0.0:
        raise InputError(f"material: yield_stress = {value:g} must be > 0, or left out")


def transverse_shear(material: Any) -> Floats | None:
    """(2, 2) stiffness G in global axes: (tau_xz, tau_yz) = G (gamma_xz, gamma_yz); None where it is not known.

    Of a stiffness in space with zero stress zz: C_55, C_45, C_44 as they are, which plane stress leaves uncoupled where
    the plate's plane is one of symmetry.
    """
    if isinstance(material, Isotropic):
        return float(material.lame_mu) * np.eye(2)  # type: ignore[arg-type]
    if isinstance(material, Orthotropic):
        own = np.diag([material.G12 if G is None else G for G in (material.G13, material.G23)])
    elif isinstance(material, Anisotropic) and len(material.C) == 6:
        own = np.array(material.C)[np.ix_([4, 3], [4, 3])]
    else:
        return None
    theta = np.deg2rad(material.angle)
    c, s = np.cos(theta), np.sin(theta)
    turn = np.array([[c, -s], [s, c]])
    return turn @ own @ turn.T


def guessed_shear(material: Any) -> tuple[str, ...]:
    """The transverse shear moduli that G12 stands for, because they were not given."""
    if not isinstance(material, Orthotropic):
        return ()
    return tuple(name for name in ("G13", "G23") if getattr(material, name) is None)


def _require_density(density: float) -> None:
    if density < 0.0:
        raise InputError(f"material: density = {density:g} must not be negative")
