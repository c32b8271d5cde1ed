"""What a solve answers: plain data. `Asked` has the questions to it, `Kept` its files and pictures.

Fields at vertices, one row per vertex, and where sheets or sections meet one for each of them (`kshell.result.rows`;
names in `kshell.result.vtu` describe the columns):

displacement (3), rotation (3), moment (xx yy xy), shear (x y), stress_top and stress_bottom (xx yy xy),
von_mises_top, von_mises_bottom, principal_moments (larger, smaller)

Shells have shear from order 2 on, and besides membrane_force (xx yy xy), the symmetric part of the force in cuts,
membrane_stress_resultant (xx yy xy), what the membrane strain works against, stress_middle, von_mises_middle,
principal_forces, and the frame of all these tensors: frame_axis_1 (3) and normal (3).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.result.asked import Asked
from kshell.result.extremes import find_extremes
from kshell.result.kept import Kept
from kshell.result.page import page
from kshell.result.rows import Rows
from kshell.result.sampled import Sampled

if TYPE_CHECKING:
    from kshell.mesh.mesh import Mesh
    from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

BUDGET = ("discretisation", "algebra", "shear", "large_deflection", "geometry")


def no_error_estimate() -> dict[str, Any]:
    """The `error` entry of a result whose error was not estimated."""
    return {"estimate": None, "kind": "none", "budget": dict.fromkeys(BUDGET)}


@dataclass(kw_only=True, repr=False)
class Result(Asked, Kept):
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
        Writes the files where several processes have the result, `writer(result, folder, files)`; `files` gives
        what else is to be written.
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
    sampled : Sampled, optional
        Values of the elements at points inside all triangles, for pictures.
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
    sampled: Sampled | None = None
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

    def __repr__(self) -> str:
        what = f"{self.model.get('kind', '?')}, {self.model.get('element', '?')}, {self.unknowns} unknowns"
        cases = f", {len(self.cases)} cases" if self.cases else ""
        return f'<Result "{self.title}": {self.analysis}, {what}{cases}, {len(self.warnings)} warnings>'

    def _repr_html_(self) -> str:
        """Picture, probes and warnings, for notebooks."""
        return page(self)
