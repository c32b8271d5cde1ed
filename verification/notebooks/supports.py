# %% [markdown]
# # Supports and curved edges
#
# What an edge fixes decides the answer more than any element does. Per edge, with normal $n$ and tangent $t$:
#
# | kind | fixed | natural condition |
# |---|---|---|
# | clamped | $w = 0,\; w_{,n} = 0$ | |
# | simply supported | $w = 0$ | $M_{nn} = 0$ |
# | symmetry | $w_{,n} = 0$ | $V_n = 0$ |
# | free | | $M_{nn} = 0,\; V_n = Q_n + M_{nt,t} = 0$ |
#
# On curved edges these hold on the true curve, not on the chords of the mesh. Made from `supports.py` by
# `python -m verification.notebooks.make supports`.

# %%
import textwrap
import warnings

import matplotlib.pyplot as plt
import numpy as np

import kshell as ks
from kshell.verify.cases import Run, find, meshes
from kshell.verify.cases.plate import plate
from verification.failures import curved_support, measured

warnings.simplefilter("ignore", ks.KshellWarning)
sizes = (2, 3, 4, 6, 8)
quick = False

# %% [markdown]
# ## One square, many supports
#
# Letters in the order x = 0, x = 1, y = 0, y = 1: C clamped, S simply supported, F free.

# %%
kinds = ("CCCC", "SSSS", "SSCC", "SSFF", "CFFF")
figure, panels = plt.subplots(1, len(kinds), figsize=(14, 3.2), layout="constrained")
for axes, kind in zip(panels, kinds, strict=True):
    held = dict(zip(("x0", "x1", "y0", "y1"), kind, strict=True))
    scene = plate(meshes.rectangle(1.0, 1.0, 12), held, [ks.Pressure(1.0)])
    result = ks.solve(scene, element="argyris", large_deflection=False)
    w = result.fields["displacement"][:, 2]
    x, y = result.mesh.points[:, 0], result.mesh.points[:, 1]
    image = axes.tripcolor(x, y, result.mesh.triangles, w, shading="gouraud")
    axes.set(title=f"{kind}\nlargest {np.abs(w).max():.5f}", aspect="equal", xticks=[], yticks=[])
    forces = sum(group["force"][2] for group in result.reactions.values())
    print(f"{kind}: largest deflection {np.abs(w).max():.6f}, reactions {forces:+.12f} against the load 1")

# %% [markdown]
# ## The disk
#
# $w = (1-r^2)^2/64$ clamped, $w = (1-r^2)\left(\frac{5+\nu}{1+\nu} - r^2\right)/64$ simply supported. The mesh has
# straight sides; Argyris rebuilds the circle from its vertices.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.8), layout="constrained")
for kind in ("clamped", "ss"):
    case = find(f"disk.{kind}.uniform")
    for element, marker in (("argyris", "o-"), ("morley", "^--")):
        errors = []
        for n in sizes:
            value = case.quantities["w_c"].of(case.solve(Run(element, n)))
            errors.append(abs(value / case.references["w_c"].value - 1))
        left.loglog(sizes, errors, marker, label=f"{kind}, {element}")
left.set(xlabel="rings of triangles", ylabel="relative error of the deflection", title="Disk")
left.legend(fontsize=8)
result = find("disk.ss.uniform").solve(Run("argyris", 6))
r = np.linspace(0, 1, 60)
values = result.at(np.column_stack([r, 0 * r, 0 * r]))
right.plot(r, values["M"][:, 0], label="radial moment")
right.plot(r, values["M"][:, 1], label="tangential moment")
right.plot(r, 3.3 * (1 - r**2) / 16, "k--", linewidth=1, label="closed forms")
right.plot(r, (3.3 - 1.9 * r**2) / 16, "k--", linewidth=1)
right.set(xlabel="r", title="Moments of the simply supported disk")
_ = right.legend(fontsize=8)

# %% [markdown]
# ## Rings
#
# Inner radius 0.2, all kinds of edges: the first letter is the inner edge, G is guided (no slope, free to move).

# %%
print(f"{'ring':12}{'quantity':14}{'value':>16}{'closed form':>16}{'error':>9}")
for kind in ("CF.q", "FC.P", "FS.m", "GS.q", "CC.q"):
    case = find(f"annulus.{kind}.b0.2")
    run = case.quick_runs[0]
    for one in case.compare(run, case.solve(run))[:3]:
        print(f"{kind:12}{one.quantity:14}{one.value:16.9f}{one.reference:16.9f}{one.error:9.1e}")

# %% [markdown]
# ## The paradox of Babuska
#
# Simply supported polygons do not tend to the disk. What goes wrong without the true curve, and what kshell does:

# %%
for words in (curved_support.FAILURE.what, curved_support.FAILURE.kshell):
    print(textwrap.fill(words, 110), end="\n\n")
_ = curved_support.draw(measured("curved_support", quick))

# %% [markdown]
# ## Planes of symmetry
#
# A sixth of the disk between planes of symmetry that meet at 60 degrees, on a mesh of gmsh.

# %%
case = find("unstructured.sector.ss")
run = case.quick_runs[0]
result = case.solve(run)
for one in case.compare(run, result):
    print(f"{one.quantity}: {one.value:.9f}, closed form {one.reference:.9f}, error {one.error:.1e}")
result.plot("deflection")
