"""What is compared: a program, its element and its solver, and the meshes it takes."""

from __future__ import annotations

from dataclasses import dataclass

DIRECT, MULTIGRID = "direct", "multigrid"
BARE = "bare"  # shells without energies and the check of equilibrium, for benchmarks


@dataclass(frozen=True)
class Method:
    """A line of the charts.

    Attributes
    ----------
    id : str
    program : str
    driver : str
        Of verification/peers; empty for kshell.
    element : str
        As the driver wants it; for kshell a name, with the order behind it for Koiter elements.
    feed : str
        Which arrays its meshes have, see `problems.Problem.arrays`.
    solver : str
        Of kshell.
    """

    id: str
    program: str
    driver: str
    element: str
    feed: str
    solver: str = DIRECT


def _kshell(name: str, element: str, solver: str = DIRECT) -> Method:
    return Method(f"kshell {name}", "kshell", "", element, "scene", solver)


_KRATOS = "ShellThinElementCorotational3D3N"

METHODS = {
    method.id: method
    for method in (
        _kshell("Argyris", "argyris"),
        _kshell("Argyris, multigrid", "argyris", MULTIGRID),
        _kshell("Morley", "morley"),
        _kshell("Morley, multigrid", "morley", MULTIGRID),
        *(_kshell(f"HHJ, order {p}", f"hhj {p}") for p in (3, 4, 5, 6, 7, 8, 10, 12)),
        *(_kshell(f"Koiter p = {p}", f"koiter {p}") for p in (1, 2, 3, 4, 5, 6)),
        _kshell("Argyris, bare", "argyris", BARE),
        _kshell("Koiter p = 2, bare", "koiter 2", BARE),
        _kshell("Koiter p = 3, bare", "koiter 3", BARE),
        *(
            Method(f"NGSolve plate, order {p}", "NGSolve", "ngsolve_plate.py", str(p), "plane")
            for p in (2, 3, 4, 5, 6, 7, 8, 10, 12)
        ),
        *(
            Method(f"NGSolve shell, order {p}", "NGSolve", "ngsolve_shell.py", str(p), "count")
            for p in (1, 2, 3, 4, 5, 6)
        ),
        Method("scikit-fem Argyris", "scikit-fem", "scikit_fem.py", "argyris", "plane"),
        Method("scikit-fem Morley", "scikit-fem", "scikit_fem.py", "morley", "plane"),
        Method("GetFEM Argyris", "GetFEM", "getfem_plate.py", "argyris", "plane"),
        Method("GetFEM HCT", "GetFEM", "getfem_plate.py", "hct", "plane"),
        Method("FreeFEM Morley", "FreeFEM", "freefem_plate.py", "morley", "plane"),
        Method("Kratos thin triangle", "Kratos", "kratos_shell.py", _KRATOS, "nodes 3"),
        Method("OpenSees DKGT", "OpenSees", "opensees_shell.py", "ShellDKGT", "nodes 3"),
        Method("OpenSees DKGQ", "OpenSees", "opensees_shell.py", "ShellDKGQ", "nodes 4"),
        Method("OpenSees NLDKGQ", "OpenSees", "opensees_shell.py", "ShellNLDKGQ", "nodes 4"),
        Method("CalculiX S8R", "CalculiX", "calculix_shell.py", "S8R", "nodes 8"),
    )
}
