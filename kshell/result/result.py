"""What a solve answers: plain data, with the ways to look at it and to save it.

Fields at vertices, one row per vertex, and where sheets or sections meet one for each of them (`kshell.result.rows`;
names in `kshell.result.vtu` describe the columns):

displacement (3), rotation (3), moment (xx yy xy), shear (x y), stress_top and stress_bottom (xx yy xy),
von_mises_top, von_mises_bottom, principal_moments (larger, smaller)

Shells have shear from order 2 on, and besides membrane_force (xx yy xy), the symmetric part of the force in cuts,
membrane_stress_resultant (xx yy xy), what the membrane strain works against, stress_middle, von_mises_middle,
principal_forces, and the frame of all these tensors: frame_axis_1 (3) and normal (3).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, MutableMapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError, SolveError
from kshell.mesh.words import clipped
from kshell.result import doors
from kshell.result.cases import Envelope
from kshell.result.document import document
from kshell.result.extremes import find_extremes
from kshell.result.page import page
from kshell.result.rows import Rows
from kshell.result.saving import in_one_file, save, write_together
from kshell.result.tables import table_files, tables
from kshell.scene.line import Line
from kshell.values.naming import listing, suggestion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kshell.mesh.mesh import Mesh
    from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

BUDGET = ("discretisation", "algebra", "shear", "large_deflection", "geometry")


def no_error_estimate() -> dict[str, Any]:
    """The `error` entry of a result whose error was not estimated."""
    return {"estimate": None, "kind": "none", "budget": dict.fromkeys(BUDGET)}


@dataclass(kw_only=True, repr=False)
class Result:
    """The answer of one analysis, in the units of the input.

    Attributes
    ----------
    mesh : Mesh
    fields : dict of str to (row, k) array
        Values at vertices, see the module's list. Those of a plate are recovered when they are first looked at, as are
        its cell fields and extremes.
    unknowns : int
        Size of the linear system before supports.
    model : dict
        kind, large_deflection, element, order, and reasons: why this model, in words.
    frame : str
        The axes of M, N and of stresses.
    probes : dict of str to dict
        Per probe x, u, rotation, M, N, stress_top, stress_bottom as arrays, found when they are first looked at.
    reactions : dict of str to dict
        Per support group force (3,) and moment (3,) of the support on the plate.
    along_supports : dict of str to dict
        How reactions are distributed along lines, see `reaction_along`; found when they are looked at.
    balance : float
        Relative error of the equilibrium of loads and reactions.
    strain_energy, external_work : float
    extremes : dict of str to {"value", "at", "group"}
        Over all rows; of stresses with the face, "top", "middle" or "bottom". Found from the fields where it is not
        given.
    rows : Rows
        What the rows of fields belong to; `points`, `vertex`, `patch` and `group` are taken from it.
    sheets : dict of probe to dict of surface group to dict
        Values as in `probes` of every sheet that meets at a probe.
    probe_triangles : dict of (probe, surface group) to int
        Triangles of the values of probes, with an empty group, and of `sheets`.
    probe_motions : dict of probe to (3,) array
        Displacements u as they were found, at probes whose other values are found when they are looked at.
    nodal_values : str
        How values at vertices are made.
    writer : callable, optional
        Writes the files where several processes have the result, `writer(result, folder, pictures)`.
    cell_fields : dict of str to (triangle,) or (triangle, k) array
    edge_fields : dict of str to (edge, k) array
        Values at the middle of edges, for pictures and files of curved triangles.
    energies : dict of str to float
        Parts of the strain energy of a shell: membrane, bending, springs.
    path : list of dict
        Of large deflections: per converged step factor, probes, iterations, and whether it is stable.
    critical : list of dict
        Limit points and bifurcations passed: kind, factor, the number of the step after it, and whether the path was
        followed, branched or jumped then. Their modes are the fields mode_1, mode_2, ...
    eigen : list of dict
        Of modes and buckling, in their order: value, frequency, lower, upper, kind; of modes participation and
        effective_mass, of rigid ones name. Their shapes are the fields mode_1, mode_2, ...
    modal : dict
        Of modes: total_mass (6), and effective_mass (6) of all modes together.
    response : dict
        Of harmonic loads: frequency, damping, modes (natural frequencies), and per probe real and imaginary u.
    history : dict of str to array
        Of motion, the start and every step: time, kinetic_energy, strain_energy, external_work, dissipated_energy,
        momentum, angular_momentum, impulse, reaction (step, 3), iterations, and probes with their displacements u.
    series : list of (factor or time, callable)
        Per entry of `path`, or state kept of a motion, a function that gives its Result.
    evaluate : callable, optional
        Points (n, 3) to a dict of arrays: values anywhere on the surface.
    error : dict
        estimate, kind and budget.
    solver : dict
        name, iterations, seconds per stage, peak_memory_mb.
    warnings : list of str
    scene : Scene, optional
        What was solved, for pictures.
    last_mesh : Mesh, optional
        Of a tolerance: what the mesh was refined to, as a scene takes it.
    input : dict
        Of a result read from its files: the scene, in numbers and text.
    case : str, optional
        Of several load cases: which of them the rest belongs to, the first.
    cases : dict of str to Result
        Of all load cases and combinations.
    units : str
        Names of the units of the scene, a label: "N, mm"; empty without.
    combinations : dict of str to dict
        Factors of the cases in those that are combinations.
    lines : dict of str to dict
        Values along the lines of the scene, as of `along`.
    """

    mesh: Mesh
    fields: MutableMapping[str, Floats]
    unknowns: int
    model: dict[str, Any]
    title: str = ""
    units: str = ""
    analysis: str = "static"
    frame: str = "global x, y"
    probes: MutableMapping[str, dict[str, Any]] = field(default_factory=dict)
    reactions: Mapping[str, MutableMapping[str, Any]] = field(default_factory=dict)
    along_supports: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    balance: float = 0.0
    strain_energy: float = 0.0
    external_work: float = 0.0
    extremes: MutableMapping[str, dict[str, Any]] = field(default_factory=dict)
    cell_fields: MutableMapping[str, NDArray[Any]] = field(default_factory=dict)
    edge_fields: MutableMapping[str, Floats] = field(default_factory=dict)
    energies: dict[str, float] = field(default_factory=dict)
    path: list[dict[str, Any]] = field(default_factory=list)
    critical: list[dict[str, Any]] = field(default_factory=list)
    eigen: list[dict[str, Any]] = field(default_factory=list)
    modal: dict[str, Any] = field(default_factory=dict)
    response: dict[str, Any] = field(default_factory=dict)
    history: dict[str, Any] = field(default_factory=dict)
    series: list[tuple[float, Callable[[], Result]]] = field(default_factory=list)
    evaluate: Callable[[Floats], dict[str, Floats]] | None = None
    error: dict[str, Any] = field(default_factory=no_error_estimate)
    solver: dict[str, Any] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    scene: Scene | None = None
    last_mesh: Mesh | None = None
    input: dict[str, Any] = field(default_factory=dict)
    case: str | None = None
    cases: dict[str, Result] = field(default_factory=dict)
    combinations: dict[str, dict[str, float]] = field(default_factory=dict)
    lines: dict[str, dict[str, Floats]] = field(default_factory=dict)
    rows: Rows = None  # type: ignore[assignment]  # made from the mesh where it is not given
    nodal_values: str = ""
    writer: Callable[..., list[str]] | None = None
    sheets: dict[str, dict[str, dict[str, Any]]] = field(default_factory=dict)
    probe_triangles: MutableMapping[tuple[str, str], int] = field(default_factory=dict)
    probe_motions: MutableMapping[str, Floats] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.rows is None:
            self.rows = Rows.of_vertices(self.mesh)
        if not self.extremes:
            self.extremes = find_extremes(self.rows, self.fields)

    @property
    def points(self) -> Floats:
        """(row, 3) the place of each row of the fields."""
        return self.rows.points

    @property
    def vertex(self) -> NDArray[np.integer]:
        """(row,) its vertex."""
        return self.rows.vertex

    @property
    def patch(self) -> NDArray[np.integer]:
        """(row,) number of the smooth piece it belongs to."""
        return self.rows.patch

    @property
    def group(self) -> NDArray[np.str_]:
        """(row,) the smallest surface group it belongs to, empty where there is none."""
        return self.rows.group

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

        return cut(self, point, normal)

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Rows of all tables that there are: probes, extremes, reactions, eigen, path, lines and the envelope."""
        return tables(self)

    def __repr__(self) -> str:
        what = f"{self.model.get('kind', '?')}, {self.model.get('element', '?')}, {self.unknowns} unknowns"
        cases = f", {len(self.cases)} cases" if self.cases else ""
        return f'<Result "{self.title}": {self.analysis}, {what}{cases}, {len(self.warnings)} warnings>'

    def _repr_html_(self) -> str:
        """Picture, probes and warnings, for notebooks."""
        return page(self)

    def to_dict(self) -> dict[str, Any]:
        """The content of result.json: numbers, text, lists and dicts only.

        Raises
        ------
        SolveError
            If a value is NaN or infinite; the message says which.
        """
        return document(self)

    def save(
        self,
        folder: str | os.PathLike[str],
        plots: bool = False,
        report: bool = False,
        tables: bool = False,
        xdmf: bool = False,
    ) -> list[str]:
        """Write result.json and result.vtu, and pictures if asked, all of them or none.

        Parameters
        ----------
        folder : path
            Made if it does not exist. Earlier results in it are replaced only when all new files are written.
        plots : bool
            Also write deflection.png, moments and stresses, and the mesh with supports and loads.
        report : bool
            Also write report.html, see `report`.
        tables : bool
            Also write probes.csv, reactions.csv and the other tables.
        xdmf : bool
            Write the states of a path or motion as series.xdmf and series.h5 instead of a .vtu file each.

        Returns
        -------
        The paths written.

        Raises
        ------
        InputError
            If the folder cannot be written, or h5py is not installed for xdmf.
        SolveError
            If a value is NaN or infinite.
        """
        files = doors.picture_files(self, plots)
        if report:
            files["report.html"] = doors.report_writer(self)
        if tables:
            files |= table_files(self)
        if xdmf:
            files |= in_one_file(self)
        return save(self, folder, files) if self.writer is None else self.writer(self, folder, files)

    def report(self, file: str | os.PathLike[str]) -> list[str]:
        """Write a report: one HTML file that needs no other and no network.

        It has what was asked (scene, mesh, supports, loads, model), what was found (values, pictures, reactions,
        warnings, error budget), and with what.

        Parameters
        ----------
        file : path
            .html

        Returns
        -------
        The paths written.

        Raises
        ------
        InputError
            If the file cannot be written, or is not named .html.
        """
        path = Path(file)
        if path.suffix.lower() not in (".html", ".htm"):
            raise InputError(f"{clipped(path)}: a report is an HTML file: give it a name that ends in .html")
        return write_together(path.parent, {path.name: doors.report_writer(self)})

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Result:
        """The result in a folder that `save`, or `kshell solve -o`, wrote.

        Numbers are those of result.json, fields those at the vertices of result.vtu; `at` interpolates between them
        linearly, where the result that was saved evaluates its elements.

        Raises
        ------
        InputError
            If there is none, or a file is damaged.
        """
        from kshell.result.loading import load_result

        loaded: Result = load_result(folder, cls)
        return loaded

    def plot(self, what: str = "deflection") -> Figure:
        """A picture: "deflection", "moment_xx", "moment_yy", "moment_xy", "von_mises_top", "mesh".

        Of shells also "force_xx", "force_yy", "force_xy", "von_mises_middle" and "von_mises_bottom", drawn on the
        deformed surface. Of modes and buckling "modes" (a grid of all of them), "mode_1", "mode_2", ... and "mesh".

        Returns
        -------
        matplotlib Figure, to be saved with `savefig`.

        Raises
        ------
        InputError
            If there is no such picture; the message lists them.
        """
        return doors.plot(self, what)

    def show(self, what: str = "deflection", scale: float | None = None, file: str | None = None) -> Any:
        """The deformed surface in 3D with PyVista, to be turned with the mouse.

        Parameters
        ----------
        what : str
            As for `plot`, except "mesh".
        scale : float, optional
            By which displacements are enlarged; absent: so that the largest is a tenth of the size.
        file : path, optional
            Save a picture there instead of opening a window.

        Returns
        -------
        pyvista.Plotter

        Raises
        ------
        InputError
            If PyVista is not installed: it is the extra "view" of kshell.
        """
        return doors.show(self, what, scale, file)
