"""What is not for several processes: refused before anything is read, on all of them alike."""

from __future__ import annotations

from kshell.errors import InputError
from kshell.scene.options import SolveOptions
from kshell.scene.scene import Scene

ALONE = "not on several processes (PETSc):"
INSTEAD = "run it as one process without solver = petsc"

ANALYSES = ("static", "path", "modes")


def require_parted(scene: Scene, options: SolveOptions, resume: bool = False) -> None:
    """Raise InputError if what is asked for is not for several processes.

    Parameters
    ----------
    resume : bool
        Whether an earlier path is to go on.
    """
    for asked, what in (
        (options.analysis not in ANALYSES, f'analysis = "{options.analysis}"'),
        (options.tolerance is not None, "tolerance, which refines the mesh"),
        (scene.contact is not None, "contact"),
        (scene.imperfection is not None, "an imperfection"),
        (options.branch != 0, "branch, which leaves a path at a bifurcation"),
        (options.prestress, "prestress"),
        (options.element == "hhj", 'element = "hhj"'),
        (resume, "resume"),
    ):
        if asked:
            raise InputError(f"{ALONE} {what}; {INSTEAD}")


def refuse_model(kind: str, element: str) -> InputError:
    """The error for a model that is not for several processes."""
    instead = 'take element = "koiter", or ' if kind == "shell" else ""
    return InputError(f'{ALONE} a {kind} with the element "{element}"; {instead}{INSTEAD}')
