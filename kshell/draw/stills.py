"""Still pictures of surfaces by PyVista, off screen, where it is installed: smooth fields, hidden sides hidden.

The variable KSHELL_STILLS=matplotlib keeps to matplotlib, whose pictures need no graphics library of the system.
"""

from __future__ import annotations

import os
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.pictures import COMPONENTS, MODAL, PRINCIPAL, SHELL_FIELDS
from kshell.mesh.check import is_flat

if TYPE_CHECKING:
    from kshell.result.result import Result

CHOICE = "KSHELL_STILLS"
FROM = (9, 4)  # versions of VTK that draw off screen without a display


def drawn_by_pyvista(result: Result, what: str) -> bool:
    """Whether a picture is a still of PyVista: fields on surfaces that are not flat, where it is there."""
    known = what in SHELL_FIELDS or what in COMPONENTS or what in PRINCIPAL
    if not known or result.model.get("kind") != "shell" or result.analysis in MODAL:
        return False
    return not is_flat(result.mesh.points) and _available()


def _available() -> bool:
    return os.environ.get(CHOICE, "") != "matplotlib" and _installed()


@lru_cache(maxsize=1)
def _installed() -> bool:
    try:
        import pyvista
        from vtkmodules.vtkCommonCore import vtkLogger, vtkVersion
    except Exception:  # it is the system's libraries that may be missing, each with an error of its own
        return False
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # it complains of every display that is not there
    version = vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()
    return version >= FROM and pyvista is not None


def still(result: Result, what: str) -> NDArray[np.uint8] | None:
    """(height, width, 3) the picture; None where the graphics of the system do not draw it."""
    from kshell.draw.view import view_of

    plotter: Any = None
    try:
        plotter = view_of(result, what, None, True)
        return np.ascontiguousarray(np.asarray(plotter.screenshot(None, return_img=True))[..., :3])
    except RuntimeError:
        return None
    finally:
        if plotter is not None:
            plotter.close()
