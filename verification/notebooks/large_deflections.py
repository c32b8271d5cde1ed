# %% [markdown]
# # Large deflections
#
# Let the surface $x$ move to $x + u$, as far as it likes. With the first and second fundamental forms $a$, $b$ before
# and after, the strains of Koiter's shell are
#
# $$\varepsilon = \tfrac12\,(a(u) - a(0)),\qquad \rho = b(u) - b(0),$$
#
# exact for any rotation. The energy
#
# $$\tfrac12\int\varepsilon : A : \varepsilon + \rho : D : \rho\;\mathrm{d}a - \lambda\,(\text{work of the loads})$$
#
# is stationary where there is equilibrium. Newton's method finds it; it keeps the stress of the last iteration as an
# unknown of its own, so that thin shells take a handful of iterations where plain Newton creeps. Where the load cannot
# grow any more the path of equilibria is followed by its length, through limit points and down again.
#
# Made from `large_deflections.py` by `python -m verification.notebooks.make large_deflections`.

# %%
import itertools
import warnings

import matplotlib.pyplot as plt
import numpy as np

import kshell as ks
from kshell.verify.cases import find, large_scenes

warnings.simplefilter("ignore", ks.KshellWarning)
quick = False
LARGE = {"large_deflection": True}

# %% [markdown]
# ## The elastica
#
# A strip clamped at one end under a force at the other, $\alpha = P L^2/EI$. Bisshopp and Drucker (1945) solve it with
# elliptic integrals. The curves are the deformed strip in its true shape.

# %%
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
head = (
    f"{'alpha':>6}{'w/L':>14}{'reference':>14}{'error':>9}{'shortening/L':>15}{'reference':>14}{'error':>9}"
)
print(f"{head}  steps, iterations")
for alpha in (1, 2, 5, 10):
    result = ks.solve(large_scenes.elastica(alpha, 8), order=3, **LARGE)
    known = find(f"large.elastica.P{alpha}").references
    u = result.probe("tip")["u"] / 10
    w, shortening = known["w_tip"].value / 10, known["u_tip"].value / 10
    print(f"{alpha:6}{u[2]:14.9f}{w:14.9f}{abs(u[2] / w - 1):9.0e}{-u[0]:15.9f}{shortening:14.9f}"
          f"{abs(-u[0] / shortening - 1):9.0e}  {result.solver['steps']}, {result.solver['iterations']}")  # fmt: skip
    along = np.column_stack([np.linspace(0, 10, 60), np.full(60, 0.5), np.zeros(60)])
    shape = along + result.at(along)["u"]
    axes.plot(shape[:, 0], shape[:, 2], label=f"$\\alpha$ = {alpha}")
    axes.plot(10 * (1 - shortening), 10 * w, "k+", markersize=11)
axes.plot([0, 10], [0, 0], "--", color="0.6", label="at rest")
axes.set(xlabel="x", ylabel="z", aspect="equal", title="Thin cantilever; + ends of the elastica")
_ = axes.legend(loc="upper left")

# %% [markdown]
# ## Rolled up
#
# An end moment $M$ bends the strip into an arc of a circle of radius $EI/M$, $M = 2\pi EI/L$ into a full one. With
# $t = L/120$ the strip stretches a little as it bends, which the formula leaves out.

# %%
figure, axes = plt.subplots(figsize=(7, 3.6), layout="constrained")
for turns in (0.125, 0.25, 0.5, 1.0) if not quick else (0.25, 0.5):
    result = ks.solve(large_scenes.roll_up(turns, 16), order=3, steps=6, **LARGE)
    u = result.probe("tip")["u"]
    exact = 12 * np.array([np.sinc(2 * turns) - 1, 0.0, np.sin(np.pi * turns) ** 2 / (np.pi * turns)])
    print(
        f"{turns:5} turns: tip moves ({u[0]:9.5f}, {u[2]:9.5f}), formula ({exact[0]:9.5f}, {exact[2]:9.5f})"
    )
    along = np.column_stack([np.linspace(0, 12, 100), np.full(100, 0.5), np.zeros(100)])
    shape = along + result.at(along)["u"]
    axes.plot(shape[:, 0], shape[:, 2], label=f"{turns} turns")
axes.set(xlabel="x", ylabel="z", aspect="equal", title="A strip rolled up by an end moment")
_ = axes.legend()

# %% [markdown]
# ## A plate that becomes a membrane
#
# A clamped circular plate whose edge cannot move: bending alone says $w = \frac{3}{16}(1-\nu^2)\,Q h$ with
# $Q = q R^4/E h^4$, but as it deflects by its thickness it stretches, and that carries more and more. The reference
# solves von Karman's equations.
#
# `large_deflection = "auto"`, the default, decides by itself which of the two is needed, and says why.

# %%
pressures = (0.5, 1, 2, 5, 10, 20, 50) if not quick else (0.5, 20)
von_karman = {
    0.5: 0.08497760367, 1: 0.1680340728, 2: 0.3228353605, 5: 0.6796039971, 10: 1.051956765, 20: 1.493792403,
    50: 2.198011365,
}  # fmt: skip
found = []
for Q in pressures:
    scene = large_scenes.von_karman(Q, 8)
    result = ks.solve(scene)  # auto
    found.append(result.probe("centre")["u"][2] / 0.01)
    size = "large" if result.model["large_deflection"] else "small"
    known = von_karman[Q]
    error = abs(found[-1] / known - 1)
    print(
        f"Q = {Q:4}: w/h = {found[-1]:.6f}, reference {known:.6f}, error {error:.0e}, for {size} deflections"
    )
print(f"\nwhy, at Q = {Q}: " + next(words for words in result.model["reasons"] if "large" in words))
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
fine = np.linspace(0, 50, 100)
axes.plot(fine, 3 / 16 * 0.91 * fine, "--", color="0.6", label="bending alone")
axes.plot(list(von_karman), list(von_karman.values()), "-", color="#1d4ed8", label="von Karman")
axes.plot(pressures, found, "o", color="#c2410c", label="kshell")
axes.set(xlabel="$q R^4 / E h^4$", ylabel="w / h in the middle", ylim=(0, 4), title="Clamped circular plate")
_ = axes.legend()

# %% [markdown]
# ## The slit ring
#
# A ring of radii 6 and 10, 0.03 thin, cut along a radius; one side of the cut is clamped, the other lifted by 0.8 per
# length. It twists into a helix, and rises by more than its radius.


# %%
def in_space(result, title, view=(25, -60), mirrors=((1, 1, 1),)):
    """The deformed surface in its true shape, and its images in planes of symmetry."""
    moved = result.mesh.points + result.fields["displacement"]
    figure = plt.figure(figsize=(7, 5), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    for signs in mirrors:
        corners = moved * np.array(signs)
        axes.plot_trisurf(
            *corners.T, triangles=result.mesh.triangles, color="#7dd3a8", edgecolor="#064e3b", linewidth=0.2
        )
    axes.view_init(*view)
    axes.set_aspect("equal")
    axes.locator_params(nbins=5)
    axes.set(title=title, xlabel="x", ylabel="y", zlabel="z")


around = 8 if not quick else 3
result = ks.solve(large_scenes.slit_annulus(around, 5 * around), order=2, steps=5, **LARGE)
case = find("large.annulus.P1")
for name, quantity in case.quantities.items():
    value, known = quantity.of(result), case.references[name].value
    print(f"{name}: {value:.4f}, table of Sze, Liu and Lo {known:.3f}, difference {value / known - 1:+.2%}")
in_space(result, "Slit ring, true shape")

# %% [markdown]
# The table was computed with elements that have shear and 10 x 80 cells. A study with splines, on meshes which it calls
# still too coarse, has 13.840 and 17.477; kshell's cubics tend to 13.85 and 17.49.
#
# ## Pulled apart
#
# An open cylinder pulled by two opposite forces: it bends first, then suddenly stretches. One run with
# `analysis = "path"` gives the whole curve.

# %%
scene = large_scenes.pull_out(8 if not quick else 4, 12 if not quick else 6)
result = ks.trace(scene, steps=20 if not quick else 10)
factor = np.array([entry["factor"] for entry in result.path])
table = np.array(large_scenes.PULL_OUT)
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for column, (probe, axis, sign, colour) in enumerate(
    (("A", 2, 1, "#c2410c"), ("B", 0, -1, "#1d4ed8"), ("C", 0, -1, "#059669")), 1
):
    moves = [sign * entry["probes"][probe]["u"][axis] for entry in result.path]
    axes.plot(moves, factor, "-", color=colour, label=f"{probe}, kshell")
    axes.plot(table[:, column], table[:, 0], "o", color=colour, markersize=3.5, label=f"{probe}, table")
    print(f"{probe}: {moves[-1]:.4f} at the full load, table {table[-1, column]:.3f}, "
          f"difference {moves[-1] / table[-1, column] - 1:+.2%}")  # fmt: skip
axes.set(
    xlabel="displacement", ylabel="load / 40000", title="Open cylinder pulled apart: force A, sides B and C"
)
axes.legend()
eight = list(itertools.product((1, -1), repeat=3))
in_space(result, "The whole cylinder at the full load, true shape", (20, -55), eight)

# %% [markdown]
# ## Snapping through
#
# A shallow roof hinged at its straight sides, under a force at its crown. The load has a maximum; a real roof jumps
# from there to the far branch. The path goes down through unstable equilibria (dashed) to the least load and up again.

# %%
layups = {"isotropic": ((), large_scenes.ROOF), "0/90/0": ((0, 90, 0), large_scenes.LAMINATED_ROOF)}
figure, axes = plt.subplots(figsize=(7.5, 4.5), layout="constrained")
for (words, (layup, table)), colour in zip(layups.items(), ("#c2410c", "#1d4ed8"), strict=True):
    result = ks.trace(large_scenes.roof(4 if not quick else 2, layup), order=3 if not quick else 2)
    path = [
        entry for entry in result.path if entry["factor"] <= 1
    ]  # the last arc may end beyond the full load
    w = np.array([-entry["probes"]["crown"]["u"][2] for entry in path])
    factor = np.array([entry["factor"] for entry in path])
    stable = np.array([entry["stable"] for entry in path])
    axes.plot(w, factor, "--", color=colour, linewidth=1)
    axes.plot(np.where(stable, w, np.nan), factor, "-", color=colour, linewidth=2, label=f"{words}, kshell")
    axes.plot(*np.array(table).T[::-1], "o", color=colour, markersize=3.5, label=f"{words}, table")
    for point in result.critical:
        axes.axhline(point["factor"], color=colour, linewidth=0.5)
    limits = ", ".join(f"{point['factor']:.5f}" for point in result.critical)
    high = max(load for load, deflection in table if deflection < 15)
    low = min(load for load, deflection in table if deflection > 15)
    print(f"{words}: {len(result.path) - 1} steps, limit points at {limits}; table {high}, {low}")
axes.set(
    xlabel="deflection of the crown", ylabel="load / 3000", title="Hinged shallow roof", ylim=(-0.15, 1.1)
)
_ = axes.legend()

# %% [markdown]
# The limit loads agree to half a percent of the largest; between them the table lies a little to the right, because
# elements with shear sink in further under the force, by $P/(2\pi k G h)$ times the logarithm of span over element.
