"""Curvature of triangle meshes.

`area`, `gaussian_curvature` and `mean_curvature` are the classical vertex formulas, cheap but pointwise
convergent on special meshes only; `normal_cycle` measures curvature in balls and converges in the mean;
`principal` fits a surface around each vertex and converges pointwise on any mesh; `midedge` is the second
fundamental form that the Koiter element uses.
"""

from kshell.geometry.discrete.curvature import (
    angle_defect,
    area,
    gaussian_curvature,
    mean_curvature,
    mean_curvature_vector,
    total_curvature,
    vertex_areas,
    volume,
)
from kshell.geometry.discrete.fields import VertexCurvature
from kshell.geometry.discrete.midedge import MidedgeForm, midedge
from kshell.geometry.discrete.normal_cycle import normal_cycle
from kshell.geometry.discrete.principal import principal
from kshell.geometry.discrete.topology import euler_characteristic, vertex_normals

__all__ = [
    "MidedgeForm",
    "VertexCurvature",
    "angle_defect",
    "area",
    "euler_characteristic",
    "gaussian_curvature",
    "mean_curvature",
    "mean_curvature_vector",
    "midedge",
    "normal_cycle",
    "principal",
    "total_curvature",
    "vertex_areas",
    "vertex_normals",
    "volume",
]
