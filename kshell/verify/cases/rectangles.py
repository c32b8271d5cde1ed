"""Rectangular plates [0, a] x [0, b] with a = 1: all kinds of edges, loads, foundations, and quarters of them.

Bending stiffness 1 and nu = 0.3 where nothing else is said; q = 1 for uniform pressure, P = 1 for forces.
Sides are named in the order x = 0, x = a, y = 0, y = b: C clamped, S simply supported, F free, Y symmetry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases import meshes
from kshell.verify.cases.case import Case, Run, case
from kshell.verify.cases.plate import plate, runs, unit_material
from kshell.verify.cases.quantities import At, Compliance, CornerForce, EdgeForce, Point, Quantity, Reaction

SIDES = ("x0", "x1", "y0", "y1")
UNIFORM = (ks.Pressure(1.0),)
LAYERS = 3  # of smaller triangles around a point load, and a corner between a clamped and a free edge


def build(
    b: float,
    sides: str,
    loads: Sequence[Any],
    material: Any = None,
    more: Sequence[Any] = (),
    surfaces: Mapping[str, meshes.Where] | None = None,
    refine: Sequence[Point] = (),
    layers: int = 0,
    share: float = 1.0,
) -> Callable[[int, int], ks.Scene]:
    """The scene of a rectangle at any refinement; ``share`` = 1/2 models the quarter around the origin."""

    def scene(refinement: int, order: int) -> ks.Scene:
        n = round(refinement * share)
        mesh = meshes.rectangle(share, share * b, n, surfaces, refine, layers)
        return plate(mesh, dict(zip(SIDES, sides, strict=True)), loads, material, more)

    return scene


def centre_values(b: float, nu: float = 0.3) -> dict[str, Quantity]:
    """Deflection and moments in the middle."""
    middle = (0.5, b / 2)
    return {"w_c": At(middle, "w"), "Mx_c": At(middle, "Mx", nu), "My_c": At(middle, "My", nu)}


def simply_supported() -> Iterator[Case]:
    """SSSS: uniform, sinusoidal, point, hydrostatic and patch loads."""
    for b in (1.0, 1.5, 2.0):
        corner = CornerForce((0.0, 0.0))
        along_edges: dict[str, Quantity] = {
            "V_x0": EdgeForce((0.0, b / 2), "x"),
            "V_y0": EdgeForce((0.5, 0.0), "y"),
        }
        sums: dict[str, Quantity] = {"compliance": Compliance(), "reaction": Reaction()}
        yield case(
            f"ssss.uniform.ba{b:g}",
            f"simply supported, b/a = {b:g}, uniform pressure",
            build(b, "SSSS", UNIFORM),
            {**centre_values(b), **along_edges, "R": corner, **sums},
            runs(8, 32),
        )
        yield case(
            f"ssss.sinus.ba{b:g}",
            f"simply supported, b/a = {b:g}, pressure sin(pi x/a) sin(pi y/b)",
            build(b, "SSSS", [ks.Pressure(f"sin(pi*x)*sin(pi*y/{b!r})")]),
            {**centre_values(b), "R": corner, **sums},
            runs(8, 32, koiter=(24, 12, 8)),
        )
        at_corner: dict[str, Quantity] = {"R": corner} if b == 1.0 else {}
        middle = (0.5, b / 2)
        yield case(
            f"ssss.point.ba{b:g}",
            f"simply supported, b/a = {b:g}, force in the middle",
            build(b, "SSSS", [_force(middle)], refine=[middle], layers=LAYERS),
            {"w_c": At(middle, "w"), **at_corner, **sums},
            runs(8, 32),
        )
    for b in (1.0, 2.0):
        places = {"25": 0.25, "50": 0.5, "60": 0.6, "75": 0.75}
        quantities: dict[str, Quantity] = {
            f"{name}_{key}": At((x, b / 2), name) for key, x in places.items() for name in ("w", "Mx", "My")
        }
        yield case(
            f"ssss.hydrostatic.ba{b:g}",
            f"simply supported, b/a = {b:g}, pressure x/a; values at x = 0.25, 0.5, 0.6, 0.75",
            build(b, "SSSS", [ks.Pressure("x")]),
            {
                **quantities,
                "R_x0": CornerForce((0.0, 0.0)),
                "R_x1": CornerForce((1.0, 0.0)),
                "reaction": Reaction(),
            },
            runs(8, 32),
        )
    for u, argyris, morley in ((0.1, 20, 40), (0.5, 8, 32)):
        yield case(
            f"ssss.patch.u{u:g}",
            f"simply supported square, force 1 spread over the middle {u:g} x {u:g}; the mesh follows the patch",
            build(1.0, "SSSS", [ks.Pressure(1 / u**2, on="patch")], surfaces={"patch": _middle_square(u)}),
            {**centre_values(1.0), "reaction": Reaction()},
            runs(argyris, morley),
        )


def clamped() -> Iterator[Case]:
    """CCCC: uniform pressure and a force in the middle."""
    for b in (1.0, 2.0):
        edges: dict[str, Quantity] = {"Mx_edge": At((0.0, b / 2), "Mx"), "My_edge": At((0.5, 0.0), "My")}
        yield case(
            f"clamped.uniform.ba{b:g}",
            f"clamped, b/a = {b:g}, uniform pressure",
            build(b, "CCCC", UNIFORM),
            {**centre_values(b), **edges, "reaction": Reaction()},
            runs(8, 32, koiter=(24, 12, 8)),
        )
    yield case(
        "clamped.point.ba1",
        "clamped square, force in the middle",
        build(1.0, "CCCC", [_force((0.5, 0.5))], refine=[(0.5, 0.5)], layers=LAYERS),
        {"w_c": At((0.5, 0.5), "w"), "Mx_edge": At((0.0, 0.5), "Mx"), "reaction": Reaction()},
        runs(8, 32),
    )


def levy() -> Iterator[Case]:
    """x = 0 and x = a simply supported, all kinds of edges at y = 0 and y = b, uniform pressure."""
    ratios = {
        "SCSC": (0.5, 1.0, 2.0),
        "SFSF": (0.5, 1.0, 1.5, 2.0),
        "SFSC": (0.5, 1.5, 2.0),
        "SSSF": (0.5, 1.0, 1.5, 2.0),
    }
    ends = {"SCSC": "CC", "SFSF": "FF", "SFSC": "CF", "SSSF": "SF"}
    for kind, several in ratios.items():
        for b in several:
            edges: dict[str, Quantity] = {}
            if ends[kind][1] == "F":
                edges = {"w_y1": At((0.5, b), "w"), "Mx_y1": At((0.5, b), "Mx")}
            if ends[kind][0] == "C":
                edges |= {"Mx_y0": At((0.5, 0.0), "Mx"), "My_y0": At((0.5, 0.0), "My")}
            yield case(
                f"levy.{kind}.ba{b:g}",
                f"x sides simply supported, y = 0 {ends[kind][0]}, y = b {ends[kind][1]}, b/a = {b:g}, pressure",
                build(b, f"SS{ends[kind]}", UNIFORM),
                {**centre_values(b), **edges, "reaction": Reaction()},
                runs(8, 32) if b >= 1.0 else runs(4, 20),
            )


def cantilevers() -> Iterator[Case]:
    """Clamped at x = 0: uniform pressure, a line force along the tip, a force at a corner of the tip."""
    for nu, b, argyris, morley in ((0.3, 1.0, 8, 32), (0.0, 1.0, 6, 32), (0.3, 0.2, 4, 12)):
        loads = {
            "uniform": UNIFORM,
            "tip_line": (ks.LineForce("x1", (0, 0, 1)),),
            "tip_corner": (_force((1.0, 0.0)),),
        }
        tip: dict[str, Quantity] = {"w_tip": At((1.0, b / 2), "w"), "w_tip_corner": At((1.0, 0.0), "w")}
        quantities: dict[str, dict[str, Quantity]] = {
            "uniform": {**tip, "Mx_root": At((0.0, b / 2), "Mx", nu)},
            "tip_line": tip,
            "tip_corner": {"w_load": At((1.0, 0.0), "w"), "w_other": At((1.0, b), "w")},
        }
        for name, load in loads.items():
            # at nu = 0 uniform bending has no singularity at the corners of the root
            root = [] if nu == 0.0 and name != "tip_corner" else [(0.0, 0.0), (0.0, b)]
            singular = [*root, (1.0, 0.0)] if name == "tip_corner" else root
            yield case(
                f"cantilever.{name}.nu{nu:g}.ba{b:g}",
                f"cantilever, b/a = {b:g}, nu = {nu:g}, {name.replace('_', ' ')} load",
                build(b, "CFFF", load, unit_material(nu), refine=singular, layers=LAYERS if singular else 0),
                {**quantities[name], "reaction": Reaction("x0")},
                runs(argyris, morley),
            )


def foundations() -> Iterator[Case]:
    """SSSS on springs, and of a fibre composite."""
    for k in (10.0, 100.0):
        spring = ks.Elastic("all", k)
        yield case(
            f"winkler.k{k:g}",
            f"simply supported square on springs of stiffness k a^4/D = {k:g}, uniform pressure",
            build(1.0, "SSSS", UNIFORM, more=[spring], surfaces={"all": meshes.everywhere}),
            {**centre_values(1.0), "reaction": Reaction()},
            runs(8, 32),
        )
    composite = ks.Orthotropic(E1=25.0, E2=1.0, nu12=0.25, G12=0.5)
    yield case(
        "orthotropic.ssss.ba1",
        "simply supported square, E1/E2 = 25, G12/E2 = 0.5, nu12 = 0.25, thickness 1, uniform pressure",
        build(1.0, "SSSS", UNIFORM, composite),
        {**centre_values(1.0), "reaction": Reaction()},
        runs(8, 32),
    )
    across = ks.Orthotropic(E1=25.0, E2=1.0, nu12=0.25, G12=0.5, angle=90)
    yield case(
        "orthotropic.ssss.ba1.turned",
        "the same plate with the fibres along y",
        build(1.0, "SSSS", UNIFORM, across),
        {
            "w_c": At((0.5, 0.5), "w"),
            "Mx_c": At((0.5, 0.5), "My"),
            "My_c": At((0.5, 0.5), "Mx"),
            "reaction": Reaction(),
        },
        runs(8, 32),
        "orthotropic.ssss.ba1",
    )


def quarters() -> Iterator[Case]:
    """Quarters between planes of symmetry, held against the values of the whole plate."""

    def quarter(
        whole: str,
        b: float,
        sides: str,
        loads: Sequence[Any],
        quantities: Mapping[str, Quantity],
        n: tuple[Run, ...],
        **more: Any,
    ) -> Case:
        return case(
            f"{whole}.quarter",
            "the same plate, a quarter of it between planes of symmetry",
            build(b, sides, loads, share=0.5, **more),
            quantities,
            n,
            whole,
        )

    for b in (1.0, 2.0):
        values = {**centre_values(b), "R": CornerForce((0.0, 0.0))}
        yield quarter(f"ssss.uniform.ba{b:g}", b, "SYSY", UNIFORM, values, runs(8, 32))
    edges: dict[str, Quantity] = {"Mx_edge": At((0.0, 0.5), "Mx"), "My_edge": At((0.5, 0.0), "My")}
    yield quarter("clamped.uniform.ba1", 1.0, "CYCY", UNIFORM, {**centre_values(1.0), **edges}, runs(8, 32))
    fourth = ks.PointForce((0.5, 0.5, 0.0), (0, 0, 0.25))
    yield quarter(
        "clamped.point.ba1",
        1.0,
        "CYCY",
        [fourth],
        {"w_c": At((0.5, 0.5), "w"), "Mx_edge": At((0.0, 0.5), "Mx")},
        runs(8, 32),
        refine=[(0.5, 0.5)],
        layers=LAYERS,
    )
    yield quarter(
        "ssss.patch.u0.5",
        1.0,
        "SYSY",
        [ks.Pressure(4.0, on="patch")],
        centre_values(1.0),
        runs(8, 32),
        surfaces={"patch": _middle_square(0.5)},
    )


def _force(point: Point) -> ks.PointForce:
    return ks.PointForce((*point, 0.0), (0, 0, 1))


def _middle_square(u: float) -> meshes.Where:
    return lambda x, y: np.maximum(np.abs(x - 0.5), np.abs(y - 0.5)) < u / 2


def cases() -> list[Case]:
    """All of them."""
    families = (simply_supported, clamped, levy, cantilevers, foundations, quarters)
    return [one for family in families for one in family()]
