"""How a result is kept and shown: tables, files, a report, pictures, and a view that turns."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, cast

from kshell.errors import InputError
from kshell.mesh.words import clipped
from kshell.result import doors
from kshell.result.document import document
from kshell.result.saving import in_one_file, save, write_together
from kshell.result.tables import table_files, tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kshell.result.result import Result


class Kept:
    """Files and pictures of a `Result`, which has the data."""

    writer: Callable[..., list[str]] | None

    @property
    def _result(self) -> Result:
        return cast("Result", self)

    def tables(self) -> dict[str, list[dict[str, Any]]]:
        """Rows of all tables that there are: probes, extremes, reactions, eigen, path, lines and the envelope."""
        return tables(self._result)

    def to_dict(self) -> dict[str, Any]:
        """The content of result.json: numbers, text, lists and dicts only.

        Raises
        ------
        SolveError
            If a value is NaN or infinite; the message says which.
        """
        return document(self._result)

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
            Also write deflection.png, moments, shear forces, stresses, crosses of principal values, and the mesh with
            supports and loads.
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

        def files() -> dict[str, Callable[[Path], object]]:
            found = doors.picture_files(self._result, plots)
            if report:
                found["report.html"] = doors.report_writer(self._result)
            if tables:
                found |= table_files(self._result)
            if xdmf:
                found |= in_one_file(self._result)
            return found

        if self.writer is not None:
            return self.writer(self._result, folder, files)
        return save(self._result, folder, files())

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
        return write_together(path.parent, {path.name: doors.report_writer(self._result)})

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Self:
        """The result in a folder that `save`, or `kshell solve -o`, wrote.

        Numbers are those of result.json, fields those at the vertices of result.vtu; `at` interpolates between them
        linearly, where the result that was saved evaluates its elements.

        Raises
        ------
        InputError
            If there is none, or a file is damaged.
        """
        from kshell.result.loading import load_result

        loaded: Self = load_result(folder, cls)
        return loaded

    def plot(self, what: str = "deflection") -> Figure:
        """A picture: "deflection", "moment_xx", "moment_yy", "moment_xy", "von_mises_top", "shear", "mesh".

        "principal_moments" draws crosses along the principal directions, strokes as long as the values and of the
        colour of their sign; so do "principal_stress_top" and "principal_stress_bottom". Components: "shear_x",
        "shear_y", "stress_top_xx", ... Of shells also "force_xx", "force_yy", "force_xy", "principal_forces",
        "von_mises_middle" and "von_mises_bottom", drawn on the deformed surface. Of modes and buckling "modes" (a grid
        of all of them), "mode_1", "mode_2", ... and "mesh".

        Returns
        -------
        matplotlib Figure, to be saved with `savefig`.

        Raises
        ------
        InputError
            If there is no such picture; the message lists them.
        """
        return doors.plot(self._result, what)

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
        return doors.show(self._result, what, scale, file)
