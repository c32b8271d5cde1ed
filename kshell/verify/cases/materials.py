"""Materials beyond isotropic at nu = 0.3: fibres, laminates, extreme Poisson's ratios, heat. Closed forms.

Rectangles [0, 1] x [0, b] are simply supported under the pressure sin(pi x) sin(pi y / b), which bends every
plate whose axes are those of the rectangle into the same shape; disks have radius 1. Thickness 1 throughout.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases import meshes
from kshell.verify.cases.case import Case, case
from kshell.verify.cases.plate import LINEAR, plate, runs, unit_material
from kshell.verify.cases.quantities import At, Compliance, Quantity, Reaction

FIBRES: Mapping[str, float] = {"E1": 25.0, "E2": 1.0, "nu12": 0.25, "G12": 0.5}
QUARTER = 0.25  # thickness of a layer
CROSS_PLY = (0.0, 90.0, 90.0, 0.0)
EXPANSION, GRADIENT = 1e-5, 1e4  # a curvature of 0.1
ORIGIN = (0.0, 0.0)


def rectangle(b: float, **section: Any) -> Callable[[int, int], ks.Scene]:
    """The simply supported rectangle of a material or of layers, at any refinement."""

    def scene(refinement: int, order: int) -> ks.Scene:
        return ks.Scene(
            mesh=meshes.rectangle(1.0, b, refinement),
            supports=[ks.SimplySupported(["x0", "x1", "y0", "y1"])],
            loads=[ks.Pressure(f"sin(pi*x)*sin(pi*y/{b!r})")],
            solve=LINEAR,
            **section,
        )

    return scene


def disk(nu: float, kind: str, load: Any) -> Callable[[int, int], ks.Scene]:
    """A disk of bending stiffness 1, at any refinement."""

    def scene(refinement: int, order: int) -> ks.Scene:
        return plate(meshes.ellipse(refinement, order), {"edge": kind}, [load], unit_material(nu))

    return scene


def values(b: float) -> dict[str, Quantity]:
    """In the middle, and the sums."""
    middle = (0.5, b / 2)
    sums: dict[str, Quantity] = {"compliance": Compliance(), "reaction": Reaction()}
    return {"w_c": At(middle, "w"), "Mx_c": At(middle, "Mx"), "My_c": At(middle, "My"), **sums}


def composites() -> Iterator[Case]:
    """Fibres along x, the same from its 3 x 3 stiffness, and a cross-ply laminate."""
    along = ks.Orthotropic(**FIBRES)
    layers = [ks.Layer(along, QUARTER, angle) for angle in CROSS_PLY]
    for b in (1.0, 2.0):
        yield case(
            f"material.orthotropic.sinus.ba{b:g}",
            f"fibres along x, E1/E2 = 25, G12/E2 = 0.5, nu12 = 0.25, b/a = {b:g}",
            rectangle(b, thickness=1.0, material=along),
            values(b),
            runs(8, 32),
        )
        yield case(
            f"material.crossply.sinus.ba{b:g}",
            f"four layers of the same fibres at 0, 90, 90, 0 degrees, b/a = {b:g}",
            rectangle(b, layers=layers),
            values(b),
            runs(8, 32, koiter=(24, 12, 8)),
        )
    nu21 = FIBRES["nu12"] * FIBRES["E2"] / FIBRES["E1"]
    q = np.array(
        [[FIBRES["E1"], nu21 * FIBRES["E1"], 0.0], [nu21 * FIBRES["E1"], FIBRES["E2"], 0.0], [0.0] * 3]
    )
    q /= 1.0 - FIBRES["nu12"] * nu21
    q[2, 2] = FIBRES["G12"]
    yield case(
        "material.anisotropic.sinus.ba1",
        "the fibres along x, given as a plane-stress stiffness",
        rectangle(1.0, thickness=1.0, material=ks.Anisotropic(C=q)),
        values(1.0),
        runs(8, 32),
        "material.orthotropic.sinus.ba1",
    )


def extremes() -> Iterator[Case]:
    """Poisson's ratios near their limits -1 and 1/2, where the three-dimensional law is singular."""
    for nu in (-0.9, 0.0, 0.4999):
        yield case(
            f"material.disk.nu{nu:g}",
            f"simply supported disk, uniform pressure, nu = {nu:g}, bending stiffness 1",
            disk(nu, "S", ks.Pressure(1.0)),
            {
                "w_c": At(ORIGIN, "w", nu),
                "M_c": At(ORIGIN, "Mx", nu),
                "compliance": Compliance(),
                "reaction": Reaction(),
            },
            runs(4, 16, curved=True),
        )


def heated() -> Iterator[Case]:
    """A disk hotter on its upper face: free to bend it is a cap without moments, clamped it stays flat."""
    load = ks.Temperature(gradient=GRADIENT, expansion=EXPANSION)
    yield case(
        "material.heat.disk.ss",
        "simply supported disk, curvature 0.1 by a temperature gradient",
        disk(0.3, "S", load),
        {"w_c": At(ORIGIN, "w"), "w_half": At((0.5, 0.0), "w")},
        runs(4, 16, curved=True),
    )
    yield case(
        "material.heat.disk.clamped",
        "clamped disk, curvature 0.1 by a temperature gradient",
        disk(0.3, "C", load),
        {"M_c": At(ORIGIN, "Mx"), "M_half": At((0.5, 0.0), "Mx")},
        runs(4, 16, curved=True),
    )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (composites, extremes, heated) for one in family()]
