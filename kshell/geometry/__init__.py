"""Differential geometry of curves, charts and triangulations.

Curvatures are positive where the surface bends toward its normal (a sphere with inward normal: +1/R),
and k1 >= k2. Angles are radians.
"""

from kshell.geometry import discrete
from kshell.geometry.chart import Chart
from kshell.geometry.charts import (
    Catenoid,
    Cone,
    Cylinder,
    Ellipsoid,
    Helicoid,
    Hypar,
    Hyperboloid,
    MonkeySaddle,
    Plane,
    Sphere,
    Torus,
    ready_chart,
)
from kshell.geometry.curve import Curve
from kshell.geometry.deformation import Deformation
from kshell.geometry.forms import OneForm, ScalarField, TwoForm, stokes
from kshell.geometry.gauss_bonnet import GaussBonnet, gauss_bonnet
from kshell.geometry.rebuild import rebuild
from kshell.geometry.surface_curve import SurfaceCurve
from kshell.geometry.surface_point import SurfacePoint

__all__ = [
    "Catenoid",
    "Chart",
    "Cone",
    "Curve",
    "Cylinder",
    "Deformation",
    "Ellipsoid",
    "GaussBonnet",
    "Helicoid",
    "Hypar",
    "Hyperboloid",
    "MonkeySaddle",
    "OneForm",
    "Plane",
    "ScalarField",
    "Sphere",
    "SurfaceCurve",
    "SurfacePoint",
    "Torus",
    "TwoForm",
    "discrete",
    "gauss_bonnet",
    "ready_chart",
    "rebuild",
    "stokes",
]
