"""What a user describes: a mesh, its material and thickness, supports, loads and probes.

Pure data, checked when it is made; it knows nothing of elements. Scenes are written in Python or as
TOML files (`kshell.scene.arguments`).
"""

from __future__ import annotations

import copy
import os
from collections.abc import Mapping, Sequence
from dataclasses import field, fields
from html import escape
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import shown
from kshell.scene.arguments import scene_arguments
from kshell.scene.cases import Case, Combination, load_factors
from kshell.scene.contact import Contact, contact, obstacles
from kshell.scene.imperfection import Imperfection
from kshell.scene.line import Line
from kshell.scene.loads import Load
from kshell.scene.masses import Mass
from kshell.scene.motion import damping, initial_displacement, initial_velocity
from kshell.scene.options import SolveOptions
from kshell.scene.parts import (
    all_of,
    as_chart,
    as_cuts,
    as_geometry,
    as_mesh,
    as_probes,
    as_top_towards,
)
from kshell.scene.reading import inside
from kshell.scene.sections import (
    as_direction,
    as_layers,
    as_material,
    as_offset,
    as_section,
    as_thickness,
    by_group,
    densities,
    require_one_section,
)
from kshell.scene.supports import Support
from kshell.scene.toml import apply_override, read_toml
from kshell.values import kinds
from kshell.values.html import html_table
from kshell.values.naming import listing, suggestion
from kshell.values.units import as_units
from kshell.values.validation import Number, described

THICKNESS = kinds.by_group(kinds.either(kinds.POSITIVE, kinds.EXPRESSION))
TOWARDS = kinds.either(kinds.DIRECTION, kinds.table(point=kinds.POINT))


@described("scene")
class Scene:
    """A plate or shell with everything that holds and loads it.

    Attributes
    ----------
    mesh : path, kshell.Mesh, skfem.MeshTri or meshio.Mesh
        .msh of order 1 or 2, .geo .step .brep (meshed by gmsh), .inp .bdf .med .unv .obj .stl and others.
    thickness : number, expression in x, y, z, or callable f(x, y, z) [length]
        Not together with `layers` or `section`. This, material, layers, section, offset and direction may be a dict of
        surface group to value; the group "*" in it stands for all other triangles.
    material : Isotropic, Orthotropic or Anisotropic
    layers : sequence of Layer
        Bottom to top, instead of thickness and material; the top is on the side of the normal.
    section : Section
        Stiffness given directly, instead of thickness and material.
    chart : kshell.geometry.Chart or dict with its kind and constants, optional
        The mesh lies in the plane z = 0 of its parameters u, v. Loads, points and probes are in x, y, z as usual.
    offset : float [length]
        Height of the middle of the material above the mesh, along the normal; shells only.
    direction : (x, y, z), optional [1]
        From its projection on the shell the angle of the material axes counts; without it from that of x (of y
        where x is normal). Shells only.
    imperfection : Imperfection or dict, optional
        Of the shape; Koiter shells only.
    supports : sequence of supports
        Clamped, SimplySupported, SoftSupported, Symmetry, Free, Hinge, RigidLink, Fixed, Elastic.
    loads : sequence of loads
        Pressure, Traction, Gravity, LineForce, EdgeMoment, PointForce, PointMoment, Temperature, InitialCurvature,
        InitialStrain.
    probes : dict of str to (x, y, z) or {"at": (x, y, z), "on": surface group}
        Named points whose values are reported; where sheets meet, those on the group.
    cases : sequence of Case
        Loads that act together; without any, all loads do. Prescribed motion is part of every case.
    combinations : sequence of Combination
        Cases added up with factors.
    masses : sequence of Mass
        Beside those of the material, without stiffness.
    cuts : str or sequence of str
        Groups of curves along which the mesh is cut open.
    lines : sequence of Line
        Along which values are reported.
    mesh_size : float, optional [length]
        Triangle size, only for geometry files.
    mesh_order : "auto", 1 or 2
        Order of the triangles, only for geometry files; auto: 2 where a surface or curve is curved.
    facets : "auto", "flat" or "curved"
        Whether flat triangles of a curved surface get mid-edge nodes on a smooth surface through their vertices; auto:
        where the error of these nodes is small against the thickness.
    crease : float [degrees]
        Angle from which neighbours meet in a fold that stays one.
    top_towards : (x, y, z) or {"point": (x, y, z)}, optional [length]
        Direction in which the top of every sheet looks, or a point from which it is seen; shells in space only.
    geometry : path, optional
        .geo, .step, .brep or .iges from which a mesh of order 1 was made: its mid-edge nodes are put on the curves
        and surfaces there, which makes it one of order 2.
    initial_velocity : (vx, vy, vz), function f(x, y, z), or {"value": ..., "on": group}, optional
        At the start of a motion.
    initial_displacement : (ux, uy, uz) or function f(x, y, z), optional [length]
        At the start of a motion, which goes on from there.
    damping : Damping or dict, optional
        Of a motion, or a response.
    contact : Contact or dict, optional
        What touches, in a motion or at rest; with obstacles alone the defaults.
    obstacles : sequence of Obstacle
    title : str
        Of all that is printed, drawn and written.
    units : str
        Names of the units of force and length, and if wanted of mass, time and temperature, in which all numbers are:
        "N, mm". A label beside the results; nothing is converted.
    solve : SolveOptions or dict
        The defaults for `kshell.solve(scene)`.

    Raises
    ------
    InputError
        Naming the key, its value and how to mend it.

    Examples
    --------
    ```toml
    title = "Roof"
    units = "N, m"
    mesh = "roof.step"
    mesh_size = 0.2
    mesh_order = 2
    geometry = "roof.step"
    facets = "curved"
    crease = 40
    top_towards = [0, 0, 1]
    thickness = "0.01 + 0.002*x"
    offset = 0.005
    direction = [0, 1, 0]
    ```
    """

    mesh: Annotated[Any, BeforeValidator(as_mesh), WithJsonSchema(kinds.PATH)]
    thickness: Annotated[Any, BeforeValidator(by_group(as_thickness)), WithJsonSchema(THICKNESS)] = None
    material: Annotated[Any, BeforeValidator(by_group(as_material))] = None
    supports: Any = ()
    loads: Any = ()
    probes: Annotated[dict[str, Any], BeforeValidator(as_probes)] = field(default_factory=dict)
    layers: Annotated[Any, BeforeValidator(by_group(as_layers))] = None
    chart: Annotated[Any, BeforeValidator(as_chart)] = None
    offset: Annotated[
        Any, BeforeValidator(by_group(as_offset)), WithJsonSchema(kinds.by_group(kinds.NUMBER))
    ] = 0.0
    direction: Annotated[
        Any, BeforeValidator(by_group(as_direction)), WithJsonSchema(kinds.by_group(kinds.DIRECTION))
    ] = None
    imperfection: Any = None
    mesh_size: Number | None = None
    mesh_order: Literal["auto", 1, 2] = "auto"
    facets: Literal["auto", "flat", "curved"] = "auto"
    crease: Number = 30.0
    top_towards: Annotated[Any, BeforeValidator(as_top_towards), WithJsonSchema(TOWARDS)] = None
    geometry: Annotated[Any, BeforeValidator(as_geometry), WithJsonSchema(kinds.PATH)] = None
    cases: Any = ()
    combinations: Any = ()
    lines: Any = ()
    cuts: Annotated[Any, BeforeValidator(as_cuts)] = ()
    masses: Any = ()
    initial_velocity: Any = None
    initial_displacement: Any = None
    damping: Any = None
    contact: Any = None
    obstacles: Any = ()
    title: str = ""
    units: Annotated[Any, BeforeValidator(as_units), WithJsonSchema({"type": "string"})] = ""
    solve: Any = field(default_factory=SolveOptions)
    section: Annotated[Any, BeforeValidator(by_group(as_section))] = None

    def __post_init__(self) -> None:
        for key, cls, words in (
            ("supports", Support, "a support such as ks.Clamped(...)"),
            ("loads", Load, "a load such as ks.Pressure(...)"),
            ("cases", Case, "a ks.Case(...)"),
            ("combinations", Combination, "a ks.Combination(...)"),
            ("lines", Line, "a ks.Line(...)"),
            ("masses", Mass, "a ks.Mass(...)"),
        ):
            object.__setattr__(self, key, all_of(getattr(self, key), cls, key, words))
        if isinstance(self.imperfection, Mapping):
            object.__setattr__(self, "imperfection", Imperfection(**self.imperfection))
        if not isinstance(self.imperfection, Imperfection | None):
            raise InputError(
                f"scene: imperfection = {shown(self.imperfection)}: must be a ks.Imperfection(...), for example "
                "ks.Imperfection(amplitude=0.001)"
            )
        object.__setattr__(self, "initial_velocity", initial_velocity(self.initial_velocity))
        object.__setattr__(self, "initial_displacement", initial_displacement(self.initial_displacement))
        object.__setattr__(self, "damping", damping(self.damping))
        object.__setattr__(self, "obstacles", obstacles(self.obstacles))
        touching = contact(self.contact)
        object.__setattr__(self, "contact", Contact() if touching is None and self.obstacles else touching)
        if isinstance(self.solve, Mapping):
            object.__setattr__(self, "solve", SolveOptions(**self.solve))
        if not isinstance(self.solve, SolveOptions):
            raise InputError(f"scene: solve = {shown(self.solve)}: must be a dict of the keys of [solve]")
        require_one_section(self)
        load_factors(self.loads, self.cases, self.combinations)  # every name in them exists
        if len({line.name for line in self.lines}) < len(self.lines):
            raise InputError("scene: two lines have the same name: give each its own")
        if self.mesh_size is not None and not self.mesh_size > 0:
            raise InputError(f"scene: mesh_size = {self.mesh_size:g} must be > 0")
        if not 0 < self.crease < 180:
            raise InputError(f"scene: crease = {self.crease:g} must be an angle between 0 and 180 degrees")
        if self.geometry is not None and self.chart is not None:
            raise InputError(
                "scene: geometry and chart given: each says how the shell is curved, leave one out"
            )

    def __repr__(self) -> str:
        parts = ["supports", "loads", "masses", "probes", "cases"]
        counts = ", ".join(f"{len(getattr(self, part))} {part}" for part in parts if getattr(self, part))
        return f'<Scene "{self.title}": mesh {self.mesh_name}{", " if counts else ""}{counts}>'

    def _repr_html_(self) -> str:
        """What is in it, for notebooks."""
        rows = [("mesh", self.mesh_name), ("thickness", self.thickness), ("material", self.material)]
        rows += [("layer", layer) for layer in self.layers or ()]
        held = (("support", self.supports), ("load", self.loads), ("mass", self.masses), ("case", self.cases))
        for key, items in held:
            rows += [(key, item.name if key == "case" else str(item)) for item in items]
        rows += [("probe", f"{name} at {at}") for name, at in self.probes.items()]
        return f"<p><b>{escape(self.title or 'Scene')}</b></p>{html_table(['', ''], rows)}"

    @property
    def mesh_name(self) -> str:
        """Its file, or what it is."""
        return str(self.mesh) if isinstance(self.mesh, Path) else f"<{type(self.mesh).__name__}>"

    @property
    def density_missing(self) -> bool:
        """Whether some material or section has no mass, so gravity would do nothing there."""
        return any(density == 0.0 for density in densities(self))

    @property
    def case_factors(self) -> dict[str, NDArray[np.float64]]:
        """Factors (load,) of the loads in every case and combination, by name."""
        return load_factors(self.loads, self.cases, self.combinations)

    def of_case(self, name: str) -> Scene:
        """The scene with the loads of one case or combination alone.

        Raises
        ------
        InputError
            If there is none of that name.
        """
        factors = self.case_factors
        if name not in factors:
            raise InputError(f'no case "{name}": {suggestion(name, factors)}the cases are {listing(factors)}')
        loads = [load.times(float(f)) for load, f in zip(self.loads, factors[name], strict=True) if f != 0.0]
        out = copy.copy(self)  # all else was checked when the scene was made
        for key, value in (("loads", loads), ("cases", ()), ("combinations", ())):
            object.__setattr__(out, key, type(getattr(self, key))(value))
        return out

    def changed(self, **changes: Any) -> Scene:
        """The scene with some of its arguments changed."""
        return Scene(**{f.name: getattr(self, f.name) for f in fields(self) if f.init} | changes)

    def read_mesh(self, allow_system: bool = False) -> Mesh:
        """The mesh of the scene, read and checked, flat triangles of curved surfaces curved as `facets` says.

        Parameters
        ----------
        allow_system : bool
            Whether geometry files may run programs and write files.

        Raises
        ------
        InputError
            If it cannot be read or used.
        """
        from kshell.mesh import read_mesh
        from kshell.scene.facets import curved, turned

        mesh = read_mesh(self.mesh, self.mesh_size, self.mesh_order, self.geometry, allow_system)
        mesh = curved(self, turned(self, mesh))
        if not self.cuts:
            return mesh
        from kshell.mesh.slit import slit

        return slit(mesh, self.cuts)

    @classmethod
    def load(cls, path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Scene:
        """The scene in a TOML file; relative paths in it are relative to the file.

        Parameters
        ----------
        path : path
        overrides : sequence of "key=value"
            Replace values of the file before it is checked; keys are dotted, lists count from 0:
            "material.E=70e9", "load.0.value=2000".

        Raises
        ------
        InputError
            If the file cannot be read, or something in it is wrong: names file, key, value and mend.
        """
        path = Path(path)
        data = read_toml(path)
        for override in overrides:
            apply_override(data, override)
        return cls.from_dict(data, path.parent, path.name)

    @classmethod
    def from_dict(
        cls, data: Mapping[str, Any], folder: str | os.PathLike[str] = ".", source: str = "scene"
    ) -> Scene:
        """The scene in a dict with the keys of a scene file; paths are relative to `folder`."""
        arguments = scene_arguments(data, Path(folder), source)
        with inside(source, "scene: "):
            return cls(**arguments)

    def save(self, path: str | os.PathLike[str]) -> list[str]:
        """Write a scene file that gives the same scene; a mesh that only is in memory is written beside it.

        Parameters
        ----------
        path : path
            Ends in .toml.

        Returns
        -------
        The paths written.

        Raises
        ------
        InputError
            If a value is a function or a chart of its own, which no file holds, or the file cannot be written.
        """
        from kshell.scene.writing import save_scene

        if Path(path).suffix.lower() != ".toml":
            raise InputError(f"{path}: a scene file ends in .toml")
        return save_scene(self, path)
