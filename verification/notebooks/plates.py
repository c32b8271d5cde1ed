# %% [markdown]
# # Kirchhoff plates against analytic deflections
#
# A thin plate of bending stiffness $D = E t^3 / 12 (1 - \nu^2)$ under the pressure $q$ bends so that
#
# $$D\,\Delta^2 w = q, \qquad M_{xx} = -D\,(w_{xx} + \nu\,w_{yy}), \qquad M_{xy} = -D\,(1-\nu)\,w_{xy}.$$
#
# kshell minimises $\tfrac12\int \kappa : D : \kappa - \int q\,w$ over Morley's quadratics, or over Argyris' quintics
# with continuous slopes. This notebook sets both beside closed forms and series, then shows how fast they converge.
# It is made from `plates.py` beside it by `python -m verification.notebooks.make plates`.

# %%
import warnings

import matplotlib.pyplot as plt
import numpy as np

import kshell as ks
from kshell.verify.cases import Run, find, meshes

warnings.simplefilter("ignore", ks.KshellWarning)
sizes = (4, 8, 16, 32)

# %% [markdown]
# ## A square on four sides
#
# Navier's series gives $w = 0.00406235\,q a^4/D$ in the middle, $M = 0.0478864\,q a^2$ there, and a force of
# $2 (1-\nu) D\,|w_{xy}| = 0.0649647\,q a^2$ that holds down each corner. The scene, with $a = q = D = 1$:

# %%
scene = ks.Scene(
    mesh=meshes.rectangle(1.0, 1.0, 16),
    thickness=1.0,
    material=ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3),
    supports=[ks.SimplySupported(["x0", "x1", "y0", "y1"])],
    loads=[ks.Pressure(1.0)],
    probes={"centre": (0.5, 0.5, 0.0)},
)
result = ks.solve(scene, element="argyris", large_deflection=False)
centre = result.probe("centre")
corner = result.reactions["x0"]["corners"][0]["force"][2]
reference = find("ssss.uniform.ba1").references
for name, found in (("w_c", centre["u"][2]), ("Mx_c", centre["M"][0]), ("R", corner)):
    exact = reference[name].value
    print(f"{name:5} {found:16.12f}   reference {exact:16.12f}   error {abs(found / exact - 1):.1e}")
print(f"loads and reactions differ by {result.balance:.0e} of their size")
result.plot("deflection")

# %% [markdown]
# The bending moment, largest in the middle, and the twisting moment that needs the corner forces:

# %%
result.plot("moment_xx")

# %%
result.plot("moment_xy")

# %% [markdown]
# ## Every kind of edge
#
# The table of cases that tests, charts and `kshell verify` use: one line per plate, Argyris on its coarse mesh.

# %%
chosen = ("clamped.uniform.ba1", "clamped.uniform.ba2", "levy.SCSC.ba1", "levy.SFSF.ba1", "levy.SSSF.ba1.5",
          "winkler.k100", "ssss.hydrostatic.ba1", "triangle.ss.equilateral")  # fmt: skip
print(f"{'case':26}{'quantity':14}{'value':>16}{'reference':>16}{'error':>9}")
for id in chosen:
    case = find(id)
    run = case.quick_runs[0]
    for one in case.compare(run, case.solve(run))[:2]:
        print(f"{id:26}{one.quantity:14}{one.value:16.9f}{one.reference:16.9f}{one.error:9.1e}")

# %% [markdown]
# ## How fast
#
# Theory: Morley order 2 in everything; Argyris order 6 in the deflection, 4 in moments, where the solution is smooth.
# Dashed lines have these slopes.

# %%
figure, panels = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained", sharey=True)
cases = {"w_c": "deflection", "Mx_c": "moment"}
for axes, (quantity, words) in zip(panels, cases.items(), strict=True):
    for element, marker, order in (("argyris", "o-", {"w_c": 6, "Mx_c": 4}[quantity]), ("morley", "^-", 2)):
        case = find("ssss.sinus.ba1")
        errors = []
        for n in sizes:
            value = case.quantities[quantity].of(case.solve(Run(element, n)))
            errors.append(abs(value / case.references[quantity].value - 1))
        axes.loglog(sizes, errors, marker, label=element)
        axes.loglog(sizes, 0.5 * errors[0] * (np.array(sizes) / sizes[0]) ** -order, "--", color="0.6")
    axes.set(xlabel="cells per side", title=words.capitalize())
    axes.legend()
_ = panels[0].set_ylabel("relative error")

# %% [markdown]
# ## A force at a point
#
# $w$ is $r^2\log r$ under the force: the deflection is finite ($0.0116008\,P a^2/D$), the moment is not. Layers of
# smaller triangles around the force help the deflection, until the rest of the mesh decides; the moment under the
# force grows with every layer.

# %%
case = find("ssss.point.ba1")
exact = case.references["w_c"].value
for layers in (0, 3, 6):
    scene = ks.Scene(
        mesh=meshes.rectangle(1.0, 1.0, 8, refine=[(0.5, 0.5)], layers=layers),
        thickness=1.0,
        material=ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3),
        supports=[ks.SimplySupported(["x0", "x1", "y0", "y1"])],
        loads=[ks.PointForce((0.5, 0.5, 0.0), (0, 0, 1))],
    )
    result = ks.solve(scene, element="argyris", large_deflection=False)
    at = result.at((0.5, 0.5, 0.0))
    w, m = at["u"][0, 2], at["M"][0, 0]
    print(f"{layers} layers: w = {w:.8f}, error {abs(w / exact - 1):.1e};  M under the force {m:.3f}")
