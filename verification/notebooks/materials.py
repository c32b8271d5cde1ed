# %% [markdown]
# # Materials, from Lamé to laminates
#
# In a thin plate the stress across the thickness vanishes. What is left of Hooke's law
# $\sigma = \lambda\,\mathrm{tr}\,\varepsilon + 2\mu\,\varepsilon$ is the plane-stress law with
# $\lambda^* = 2\lambda\mu/(\lambda + 2\mu)$, and the bending stiffness is its second moment through the thickness,
#
# $$D = \int_{-t/2}^{t/2} z^2\,C\;dz .$$
#
# Made from `materials.py` by `python -m verification.notebooks.make materials`.

# %%
import textwrap
import warnings

import matplotlib.pyplot as plt
import numpy as np

import kshell as ks
from kshell.verify.cases import find, meshes
from verification.failures import measured, poisson

warnings.simplefilter("ignore", ks.KshellWarning)
np.set_printoptions(precision=6, suppress=True)
quick = False

# %% [markdown]
# ## One material, three ways to write it

# %%
E, nu = 210e9, 0.3
lame, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
constants = ks.Isotropic(E=E, nu=nu).plane_stress()
from_lame = ks.Isotropic(lame_lambda=lame, lame_mu=mu).plane_stress()
law = np.zeros((6, 6))
law[:3, :3] = lame
law += np.diag([2 * mu] * 3 + [mu] * 3)
from_law = ks.Anisotropic(C=law).plane_stress()
print(constants / 1e9)
print("largest differences:", np.abs(from_lame / constants[0, 0] - constants / constants[0, 0]).max(),
      np.abs(from_law / constants[0, 0] - constants / constants[0, 0]).max())  # fmt: skip

# %% [markdown]
# ## Fibres
#
# $E_1 = 25 E_2$: stiff along the fibres. Turned against the axes the stiffness couples bending and twist.

# %%
angles = np.linspace(0, 180, 91)
stiffness = np.array(
    [ks.Orthotropic(E1=25.0, E2=1.0, nu12=0.25, G12=0.5, angle=a).plane_stress() for a in angles]
)
figure, axes = plt.subplots(figsize=(7, 3.6), layout="constrained")
for (i, j), name in (((0, 0), "Q11"), ((1, 1), "Q22"), ((2, 2), "Q66"), ((0, 2), "Q16")):
    axes.plot(angles, stiffness[:, i, j], label=name)
axes.set(
    xlabel="angle of the fibres, degrees", ylabel="plane-stress stiffness", title="E1/E2 = 25, G12/E2 = 0.5"
)
_ = axes.legend()

# %% [markdown]
# A simply supported square bends into half waves under a half-wave pressure, with
# $w = q / \pi^4 (D_{11} + 2 (D_{12} + 2 D_{66}) + D_{22})$ (Navier).

# %%
print(f"{'case':34}{'quantity':12}{'value':>16}{'closed form':>16}{'error':>9}")
for name in ("orthotropic.sinus.ba1", "crossply.sinus.ba1", "anisotropic.sinus.ba1", "disk.nu-0.9", "disk.nu0.4999",
             "heat.disk.ss", "heat.disk.clamped"):  # fmt: skip
    case = find(f"material.{name}")
    run = case.quick_runs[0]
    for one in case.compare(run, case.solve(run))[:2]:
        print(f"{case.id:34}{one.quantity:12}{one.value:16.9f}{one.reference:16.9f}{one.error:9.1e}")

# %% [markdown]
# ## Laminates
#
# Four layers of the same fibres: the order of the stack changes the bending stiffness, not the weight. Deflection of a
# square that is clamped on all sides.

# %%
fibres = ks.Orthotropic(E1=25.0, E2=1.0, nu12=0.25, G12=0.5)
stacks = ((0, 0, 0, 0), (0, 90, 90, 0), (90, 0, 0, 90), (45, -45, -45, 45), (30, 30, 30, 30))
figure, panels = plt.subplots(1, len(stacks), figsize=(14, 3.2), layout="constrained")
for axes, stack in zip(panels, stacks, strict=True):
    scene = ks.Scene(
        mesh=meshes.rectangle(2.0, 1.0, 8),
        layers=[ks.Layer(fibres, 0.25, angle) for angle in stack],
        supports=[ks.Clamped(["x0", "x1", "y0", "y1"])],
        loads=[ks.Pressure(1.0)],
    )
    result = ks.solve(scene, element="argyris", large_deflection=False)
    w = result.fields["displacement"][:, 2]
    axes.tricontourf(*result.mesh.points.T[:2], result.mesh.triangles, w, levels=12)
    axes.set(title=f"{stack}\nlargest {w.max():.5f}", aspect="equal", xticks=[], yticks=[])

# %% [markdown]
# A stack without symmetry couples stretching and bending, which a plate that only bends cannot show. What kshell models
# then, and why:

# %%
scene = ks.Scene(
    mesh=meshes.rectangle(1.0, 1.0, 4),
    layers=[ks.Layer(fibres, 0.5, angle) for angle in (0, 90)],
    supports=[ks.Clamped(["x0", "x1", "y0", "y1"])],
    loads=[ks.Pressure(1.0)],
)
result = ks.solve(scene)
print(result.model["kind"], *result.model["reasons"], sep="\n  ")

# %% [markdown]
# ## The limits of Poisson's ratio

# %%
for words in (poisson.FAILURE.what, poisson.FAILURE.kshell):
    print(textwrap.fill(words, 110), end="\n\n")
_ = poisson.draw(measured("poisson", quick))
