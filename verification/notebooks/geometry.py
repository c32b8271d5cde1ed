# %% [markdown]
# # The geometry of curves, surfaces and triangle meshes
#
# A gallery of `kshell.geometry`. Curvatures are positive where a surface bends toward its normal, `k1 >= k2`.
# The notebook is made from `geometry.py` beside it by `python -m verification.notebooks.make geometry`.

# %%
import matplotlib.pyplot as plt
import numpy as np

import kshell.geometry as g
from kshell.draw import geometry_plot as plot
from kshell.errors import InputError
from kshell.geometry import discrete
from verification.geometry.convergence import draw, table
from verification.geometry.meshes import TorusMesh, lantern, random_sphere, vertex_ring

TURN = (0.0, 2 * np.pi)

# %% [markdown]
# ## Curves
#
# A helix of curvature 0.8 and torsion 0.4, with its Frenet frames; then the same curve rebuilt from these two
# numbers and its length alone (the fundamental theorem), which agrees up to a rigid motion.

# %%
helix = g.Curve.from_expressions("cos(t)", "sin(t)", "t/2")
f = helix.at([0.0, 1.0, 2.0])
print("curvature", f.curvature, " torsion", f.torsion)

by_length, rebuilt = helix.by_arc_length(0.0, 12.0), g.rebuild(0.8, 0.4, helix.length(0.0, 12.0))
s = np.linspace(0.0, rebuilt.domain[1], 400)
a, b = by_length.at(s), rebuilt.at(s)
moved = (a.point - a.point[0]) @ a.frame[0].T
print(f"largest distance of the rebuilt helix: {np.abs(moved - b.point).max():.1e}")
_ = plot.frames(helix, np.linspace(0.0, 12.0, 26))
# %% [markdown]
# At an inflection the Frenet frame is not defined, and kshell says so. A rotation-minimising frame passes.

# %%
wave = g.Curve.from_expressions("t", "sin(t)", "cos(2*t)/4", domain=(-4, 4))
cubic = g.Curve.from_expressions("t", "t**3")
try:
    print(cubic.at([-1.0, 0.0, 1.0]).normal)
except InputError as error:
    print(error)
_ = plot.frames(wave, np.linspace(-4.0, 4.0, 33), rotation_minimising=True)
# %% [markdown]
# ## Charts
#
# Every quantity of a chart at one point. Derivatives are exact: closed form for the ready charts, by sympy for
# formulas and plain functions.

# %%
p = g.Torus(2, 1).at(0.3, 0.8)
for name in ("point", "normal", "first_form", "second_form", "shape_operator", "principal_curvatures",
             "mean_curvature", "gaussian_curvature", "kind"):  # fmt: skip
    print(f"{name:22s}", np.array2string(np.asarray(getattr(p, name)), precision=6).replace("\n", ""))

# %% [markdown]
# Where a parametrisation is singular, the message has the place.

# %%
for chart, u, v in ((g.Cone(1, 1), 0.5, 0.0), (g.Sphere(1), [1.0, 1.0], [1.0, np.pi])):
    try:
        chart.at(u, v)
    except InputError as error:
        print(error)

# %% [markdown]
# ### Curvature in colours

# %%
plot.curvature(g.Torus(2, 1), "gaussian_curvature")
plot.curvature(g.MonkeySaddle(), "mean_curvature")
_ = plot.curvature(g.Ellipsoid(3, 2, 1), "k1")
# %% [markdown]
# ### Kinds of points
#
# A planar point needs `dN = 0`. On a cylinder `det dN = 0` too, but its points are parabolic.

# %%
bell = g.Chart.from_expressions("u", "v", "2*exp(-u**2 - v**2)", domain=((-2, 2), (-2, 2)), name="bell")
plot.classification(g.Torus(2, 1))
plot.classification(bell)
print(
    "monkey saddle at the origin:", g.MonkeySaddle().at(0, 0).kind, "- cylinder:", g.Cylinder().at(0, 0).kind
)

# %% [markdown]
# ### The Gauss map
#
# The normals of an ellipsoid cover the sphere once; those of a catenoid cover it but for the poles, turned over
# (K is negative).

# %%
plot.gauss_map(g.Ellipsoid(3, 2, 1))
_ = plot.gauss_map(g.Catenoid(1), v_range=(-1.2, 1.2))
# %% [markdown]
# ### Principal directions
#
# Only the sides that can be seen carry crosses. On the ellipsoid the directions turn around four umbilics, here near
# the ends at x = 2.4 and x = -2.4, where every direction is principal.

# %%
plot.principal_directions(g.Ellipsoid(3, 2, 1), n=22)
_ = plot.principal_directions(g.MonkeySaddle(), n=14)
# %% [markdown]
# ## Gauss-Bonnet
#
# The integral of K, the turning of the boundary and the exterior angles add up to 2 pi times the Euler
# characteristic.

# %%
polar = g.Chart.from_expressions("r*cos(a)", "r*sin(a)", "0", ("a", "r"), domain=(TURN, (0.0, 0.8)))
cases = {
    "torus": (g.Torus(2, 1),),
    "ellipsoid": (g.Ellipsoid(3, 2, 1),),
    "cap of a sphere": (g.Sphere(2), TURN, (0.0, 0.7)),
    "patch of a torus, 4 corners": (g.Torus(2, 1), (0.2, 1.0), (0.3, 2.0)),
    "disc on a saddle": (g.Hypar().reparametrised(polar),),
}
print(f"{'':30s}{'int K':>10s}{'turning':>10s}{'corners':>10s}{'2 pi chi':>10s}{'residual':>11s}")
for name, case in cases.items():
    t = g.gauss_bonnet(*case)
    parts = (t.curvature, t.boundary, sum(t.corners), 2 * np.pi * t.characteristic)
    print(f"{name:30s}" + "".join(f"{x:10.5f}" for x in parts) + f"{t.residual:11.1e}")

# %% [markdown]
# ## One-forms
#
# Both sides of Stokes' theorem on a disc, and the angle form: closed, but not exact around the origin.

# %%
omega = g.OneForm(["exp(u*v)", "sin(u) + u**3*v"])
disc = g.Chart.from_expressions("r*cos(a)", "r*sin(a)", "0", ("r", "a"))
print("int d omega, int around:", *g.stokes(omega.pulled_back(disc), (0.0, 2.0), TURN))
angle = g.OneForm(["-v/(u**2 + v**2)", "u/(u**2 + v**2)"])
circle = g.Curve.from_expressions("cos(t)", "sin(t)")
print(
    "closed:",
    angle.is_closed((-1, 1), (-1, 1)),
    " around the origin:",
    angle.along(circle, *TURN) / np.pi,
    "pi",
)
print("exact:", angle.is_exact((-1, 1), (-1, 1), loops=[(circle, *TURN)]))

# %% [markdown]
# ## Deformation
#
# Green strain and change of curvature of a displaced ellipsoid: the linearised ones differ by terms of second
# order in the displacement, down to sizes where a difference of the forms would have lost all digits.

# %%
field = ("sin(u)*v", "u**2 - v/2", "cos(v)*u + v**2")
sizes = np.logspace(-8, -1, 8)
gaps = []
for size in sizes:
    d = g.Deformation(g.Ellipsoid(3, 2, 1), tuple(f"{float(size)!r}*({c})" for c in field)).at(
        0.7, [0.8, 1.2]
    )
    gaps.append([np.abs(d.green_strain - d.linear_strain).max(),
                 np.abs(d.curvature_change - d.linear_curvature_change).max()])  # fmt: skip
figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
axes.loglog(sizes, np.array(gaps), "o-", label=["Green strain", "change of curvature"])
axes.loglog(sizes, sizes**2, "--", color="0.5", label="second order")
axes.set(xlabel="size of the displacement", ylabel="exact less linearised", title="Linearisation")
_ = axes.legend()
# %% [markdown]
# ## Triangle meshes: what converges, and what does not
#
# ### One vertex
#
# The angle defect over a third of the area around a regular vertex tends to K at valence 6 only; the cotangent
# mean curvature over the barycentric area likewise, while the Voronoi area puts it right at every valence.

# %%
valences = np.arange(3, 13)
limits = {"angle defect, sphere": [], "angle defect, cylinder (+1)": [], "cotangent, barycentric": [],
          "cotangent, Voronoi": []}  # fmt: skip
for n in valences:
    sphere, cylinder = vertex_ring(n, 1, 1, 0.0, 1e-3), vertex_ring(n, 1, 0, 0.0, 1e-3)
    limits["angle defect, sphere"].append(discrete.gaussian_curvature(sphere, "barycentric")[0])
    limits["angle defect, cylinder (+1)"].append(1 + discrete.gaussian_curvature(cylinder, "barycentric")[0])
    limits["cotangent, barycentric"].append(discrete.mean_curvature(sphere, "barycentric")[0])
    limits["cotangent, Voronoi"].append(discrete.mean_curvature(sphere, "voronoi")[0])
figure, axes = plt.subplots(figsize=(6.5, 4), layout="constrained")
for k, (name, values) in enumerate(limits.items()):
    axes.plot(valences, values, "os^v"[k] + ("--" if k == 2 else "-"), label=name)
axes.axhline(1.0, color="0.5", linewidth=1)
axes.set(xlabel="valence", ylabel="limit / exact", title="Limits at a regular vertex", xticks=valences)
_ = axes.legend()
# %% [markdown]
# ### The Schwarz lantern
#
# With as many bands as the square of the sides the area tends to 4.9 times the right one although every vertex lies
# on the cylinder: the normals do not converge. With the cube it has no limit.

# %%
sides = np.array([4, 6, 8, 12, 16, 24])
figure = plt.figure(figsize=(11, 4.2), layout="constrained")
axes = figure.add_subplot(1, 2, 1)
for power, marker in ((1, "o"), (2, "s"), (3, "^")):
    ratio = [discrete.area(lantern(n, n**power)) / (2 * np.pi) for n in sides]
    axes.loglog(sides, ratio, marker + "-", label=f"bands = sides^{power}" if power > 1 else "bands = sides")
axes.axhline(np.sqrt(1 + np.pi**4 / 4), color="0.5", linestyle="--", label="sqrt(1 + pi^4 / 4)")
axes.set(xlabel="sides", ylabel="area / exact", title="Area of the Schwarz lantern")
axes.set_xticks(sides, labels=sides)
axes.minorticks_off()
axes.legend()
space = figure.add_subplot(1, 2, 2, projection="3d")
pleated = lantern(10, 20)
space.plot_trisurf(
    *pleated.points.T, triangles=pleated.triangles, color="#d8c9a3", edgecolor="#555555", linewidth=0.4
)
space.set_title("10 sides, 20 bands")
_ = space.set_box_aspect((2, 2, 1))

# %% [markdown]
# ### Whole meshes of a torus
#
# The angle defect on a mesh of valences 4 and 8: the values depend on the valence, not on the surface. The fitted
# polynomial finds the curvature on the same mesh. Then an irregular mesh of the unit sphere, where H = 1: the error of
# the midedge form with mean directors does not get smaller with the triangles, that of the normal cycle does.

# %%
crossed = TorusMesh(18, "crossed").mesh
plot.on_mesh(crossed, discrete.gaussian_curvature(crossed), "K", "Angle defect / mixed area, valence 4 and 8")
plot.on_mesh(
    crossed, discrete.principal(crossed).gaussian_curvature, "K", "Fitted polynomial, valence 4 and 8"
)
irregular = random_sphere(600, seed=1)
balls = discrete.normal_cycle(irregular, 0.4)
plot.on_mesh(
    irregular, discrete.midedge(irregular).mean_curvature - 1, "H - 1", "Midedge form, mean directors"
)
_ = plot.on_mesh(irregular, balls.mean_curvature - 1, "H - 1", "Normal cycle, r = 0.4")

# %% [markdown]
# Errors on sequences of meshes. On valence 6 everything converges. With valences 4 and 8, or vertices moved at
# random, the angle defect, the cotangent formula and the midedge form with mean directors stay wrong however fine
# the mesh is; the fitted polynomial, the normal cycle with a radius that shrinks like sqrt(h), and the midedge form
# with exact directors (what the Koiter element solves for) converge on all.

# %%
sizes = (12, 24, 48)
_ = draw(table(sizes), sizes)
