"""The mesh as a scene wants it: its top on the side asked for, flat triangles of curved shells curved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kshell.errors import InputError
from kshell.material.section import shell_section
from kshell.mesh.mesh import Mesh

if TYPE_CHECKING:
    from kshell.scene.scene import Scene


def turned(scene: Scene, mesh: Mesh) -> Mesh:
    """The mesh of a scene with its top where the key `top_towards` wants it.

    Raises
    ------
    InputError
        If a chart or the plane says already where the top is, or a sheet faces neither way.
    """
    if scene.top_towards is None:
        return mesh
    if scene.chart is not None or mesh.is_flat:
        why = (
            "the chart"
            if scene.chart is not None
            else "a flat mesh in a plane z = const, whose top is at +z,"
        )
        raise InputError(
            f"scene: top_towards is for shells in space, but {why} says where the top is: leave it out"
        )
    from kshell.mesh.facing import towards

    given = scene.top_towards
    return towards(mesh, point=given["point"]) if isinstance(given, dict) else towards(mesh, given)


def curved(scene: Scene, mesh: Mesh) -> Mesh:
    """The mesh of a scene, as its key `facets` says.

    Raises
    ------
    InputError
        If `facets` asks for curved triangles where they are curved already.
    """
    if scene.chart is not None or mesh.midpoints is not None:
        if scene.facets == "curved":
            why = (
                "the chart gives its shape" if scene.chart is not None else "it has mid-edge nodes of its own"
            )
            raise InputError(
                f'scene: facets = "curved" is for flat triangles, but {why} ({mesh.source}): leave facets out'
            )
        return mesh
    if mesh.is_flat or mesh.curving is not None:
        return mesh
    from kshell.mesh.curving.decision import curve

    try:
        section = shell_section(mesh, scene.thickness, scene.material, scene.layers, scene.section)
    except InputError:
        return mesh  # said with all else that is wrong with the section where it is used
    return curve(mesh, section.thickness_per_triangle, scene.facets, scene.crease)
