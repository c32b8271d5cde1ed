"""What an analysis is given besides its model, and what every result says about how it came about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from kshell.analysis.asked import answer_asked
from kshell.analysis.clock import Clock, Stage
from kshell.analysis.models import build_model
from kshell.analysis.plausible import warn_of_the_implausible
from kshell.analysis.strength import add_strength
from kshell.equilibrium.model import Model
from kshell.mesh.mesh import Mesh
from kshell.result.peaks import mark_peaks
from kshell.result.result import Result
from kshell.scene.loads import Load, Temperature
from kshell.scene.options import SolveOptions
from kshell.scene.placed import Placed
from kshell.scene.scene import Scene
from kshell.scene.structure import Structure, resolve
from kshell.scene.thermal import keeps_stress
from kshell.values.units_sense import doubts

# analyses whose displacements are those of the loads
DEFLECTED = ("static", "path", "dynamic")


@dataclass(frozen=True, eq=False)
class Run:
    """How an analysis is to be done.

    Attributes
    ----------
    scene : Scene
    structure : Structure
        The scene resolved on its mesh, from which models are made.
    options : SolveOptions
    clock : Clock
        Of the stages assemble, solve, recover.
    progress : function, optional
        Called with the name of each stage, and with words in between.
    folder : Path, optional
        Where each converged step of a path is written.
    resume : bool
        Go on after the last step in the folder.
    factors : (load,), optional
        Of the loads of the structure, of one load case.
    allow_system : bool
        Whether geometry files may run programs and write files.
    """

    scene: Scene
    structure: Structure
    options: SolveOptions
    clock: Clock
    progress: Stage | None = None
    folder: Path | None = None
    resume: bool = False
    factors: tuple[float, ...] | None = None
    allow_system: bool = False

    def tell(self, words: str) -> None:
        """Words about the progress."""
        if self.progress is not None:
            self.progress(words)

    def model(self) -> Model:
        """The model that the options ask for, ready to be solved."""
        with self.clock.stage("assemble"):
            model = build_model(self.structure, self.options)
            model.prepare()
        return model if self.factors is None else model.under(self.factors)

    def on_mesh(self, mesh: Mesh) -> Run:
        """The same run on another mesh with the same groups, as after refining, with a clock of its own."""
        return replace(
            self,
            structure=resolve(
                self.scene,
                mesh,
                self.options.analysis == "dynamic",
                self.options.looks,
                self.options.without_errors,
            ),
            clock=Clock(self.progress),
        )

    def with_options(self, **changes: Any) -> Run:
        """The same run with other options and a clock of its own."""
        return replace(self, options=self.options.updated(**changes), clock=Clock(self.progress))


def described(
    result: Result,
    model: Model,
    run: Run,
    reasons: list[str],
    solver: dict[str, Any],
    large: bool,
    warmth: Sequence[Placed[Load]] = (),
) -> Result:
    """The result with what every result says: analysis, model with its reasons, solver, seconds and memory.

    Parameters
    ----------
    warmth : sequence of Placed
        The temperatures that act in its state.
    """
    result.analysis, result.units = run.options.analysis, run.scene.units
    result.model = {
        "kind": model.kind,
        "large_deflection": large,
        "element": model.element,
        "order": model.order,
        "reasons": [
            *model.reasons,
            *reasons,
            *_forgets(model, run),
            *(f"mesh: {note}" for note in model.structure.parameters.notes),
        ],
    }
    if any(_keeps_stress(placed, model.structure) for placed in warmth):
        result.model["reasons"].append(
            "strain energy: without that of the stresses, free of resultants, that warm layers keep against each other"
        )
    result.warnings += doubts(run.scene.units)
    if result.analysis in DEFLECTED:
        warn_of_the_implausible(result, model.structure, large, run.factors)
    acting = model.structure.acting(run.factors)
    mark_peaks(result, acting, model.singular())
    if result.probes or "von_mises_top" in result.fields:
        add_strength(result, acting, warmth, model.singular())
    answer_asked(result, run.scene)
    result.solver = {**solver, "seconds": {**run.clock.seconds}, "peak_memory_mb": run.clock.peak_memory_mb}
    return result


def _keeps_stress(placed: Placed[Load], structure: Structure) -> bool:
    load = placed.item
    return isinstance(load, Temperature) and keeps_stress(
        load, structure.section, placed.members(structure.space)
    )


def _forgets(model: Model, run: Run) -> list[str]:
    """What an analysis leaves out of materials that remember their past, in words."""
    past, analysis = model.structure.section.inelastic(), run.options.analysis
    if past.relaxation and analysis != "dynamic":
        return ["material: its stiffness against sudden strains; it relaxes in motion only"]
    if past.yielding is not None and analysis not in ("static", "path", "dynamic"):
        return ["material: elastic; it yields in statics, paths and motion only"]
    return []
