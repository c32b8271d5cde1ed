# %% [markdown]
# # How sure
#
# Every static result of kshell says how far it may be from the exact solution of its model, and a tolerance refines the
# mesh until that is little enough. This notebook asks whether what it says is true, how sharp it is, and what it costs.
# It is made from `how_sure.py` beside it by `python -m verification.notebooks.make how_sure`.

# %%
import csv
import dataclasses
import time
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import kshell as ks
import verification.benchmarks
from kshell.verify.cases import find, meshes
from kshell.verify.cases.plate import plate

warnings.simplefilter("ignore", ks.KshellWarning)
sizes = (4, 8, 16, 32)

# %% [markdown]
# ## A value and its interval
#
# A clamped L-shape under pressure, from a coarse mesh of equal triangles. Nothing is asked for but 0.01 %:

# %%
scene = plate(meshes.l_shape(2, 0), {"edge": "C"}, [ks.Pressure(1.0)])
scene = dataclasses.replace(scene, probes={"near": (0.25, 0.25, 0.0)})
result = ks.solve(scene, tolerance=1e-4)
found = result.error["probes"]["near"]["u"]
value, half = result.probes["near"]["u"][2], found["half_width"][2]
print(f"w = {value:.10e} +- {half:.1e} ({found['kind']}), expected to be off by {found['expected'][2]:.1e}")
print(f"true: 1.95571370e-4 +- 1e-11; {len(result.error['levels'])} meshes, {result.unknowns} unknowns")
result.plot("error")

# %% [markdown]
# ## Intervals of all meshes overlap
#
# Between a conforming solution (Argyris) and moments in equilibrium (Hellan, Herrmann, Johnson) the energy is caught
# from both sides. Quintics on meshes graded to the corner: the gap falls like $N^{-4}$, as if there were no corner.

# %%
tolerances = (1e-4, 1e-6, 1e-8, 1e-10)
true = 3.578570071578e-3 / 2 / 2**6  # half of that on (-1, 1)^2, at half its size
print(f"{'unknowns':>9}{'lower':>20}{'upper':>20}{'gap':>10}{'gap / error':>13}")
rows = []
for tolerance in tolerances:
    one = ks.solve(scene, tolerance=tolerance, quantity="energy")
    lower, upper = one.error["energy"]["lower"], one.error["energy"]["upper"]
    rows.append((one.unknowns, upper / lower - 1))
    error = true / lower - 1
    print(f"{one.unknowns:9}{lower:20.13e}{upper:20.13e}{rows[-1][1]:10.1e}{rows[-1][1] / abs(error):13.2f}")
unknowns, gaps = np.array(rows).T
print(f"rate of the last three {np.polyfit(np.log(unknowns[1:]), np.log(gaps[1:]), 1)[0]:.2f}")
figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
axes.loglog(unknowns, gaps, "o-", label="guaranteed gap")
axes.loglog(unknowns, gaps[0] * (unknowns / unknowns[0]) ** -4.0, "--", color="0.6", label="slope -4")
axes.set(xlabel="unknowns", ylabel="gap of the energy, relative", title="Clamped L-shape")
axes.legend()
plt.show()

# %% [markdown]
# ## Are they true?
#
# All linear cases with known deflections or energies, from meshes half as fine as the coarsest of their checks, to
# tolerances of 1e-2 to 1e-6, without a look at the references (`python -m verification.benchmarks.coverage`).
# "Missed" is the worst word: said to be reached, and not.

# %%
folder = Path(verification.benchmarks.__path__[0])
with (folder / "coverage.csv").open(encoding="utf-8") as file:
    table = list(csv.DictReader(file))
words = ("met", "not reached", "outside", "missed", "refused")
print(f"{'tolerance':>10}{'runs':>6}" + "".join(f"{word:>13}" for word in words) + f"{'median s':>10}")
for tolerance in sorted({float(row["tolerance"]) for row in table}, reverse=True):
    here = [row for row in table if float(row["tolerance"]) == tolerance]
    counts = "".join(f"{sum(row['outcome'] == word for row in here):13}" for word in words)
    print(f"{tolerance:10.0e}{len(here):6}{counts}{np.median([float(row['seconds']) for row in here]):10.2f}")
figure, axes = plt.subplots(figsize=(6, 4.4), layout="constrained")
for kind, colour in (("guaranteed", "C0"), ("estimated", "C1")):
    here = [row for row in table if row["kind"] == kind]
    half, error, known = (
        np.array([float(row[key]) for row in here]) for key in ("half_width", "error", "uncertainty")
    )
    sharp = error > 3 * known  # elsewhere it is the reference's error
    axes.loglog(
        error[sharp], half[sharp], ".", color=colour, label=f"{kind}, {sharp.sum()} runs", markersize=4
    )
axes.plot([1e-12, 1], [1e-12, 1], color="0.6")
axes.set(
    xlabel="true error, relative", ylabel="half width, relative", title="Above the line the interval holds"
)
axes.set(xlim=(1e-10, 1e-1), ylim=(1e-10, 1e-1))
axes.legend()
plt.show()

# %% [markdown]
# ## Against the best mesh by hand
#
# Processor seconds of whole solves. "By hand": the cheapest of uniform meshes from which on all finer ones are within
# the tolerance, which takes a sweep with the answer known. On the L no uniform mesh gets to 1e-4.

# %%
print(f"{'case':24}{'tolerance':>10}{'by tolerance':>14}{'by hand':>10}")
for id in ("ssss.uniform.ba1", "clamped.uniform.ba1", "levy.SFSF.ba1", "lshape.clamped"):
    case = find(id)
    name = "w_near" if id == "lshape.clamped" else "w_c"
    quantity, reference = case.quantities[name], case.references[name].value
    sweep = []
    for n in sizes:
        begin = time.process_time()
        one = ks.solve(case.build(n, 1), element="argyris", error="off")
        sweep.append((abs(quantity.of(one) / reference - 1), time.process_time() - begin))
    for tolerance in (1e-2, 1e-4):
        good = [k for k in range(len(sizes)) if max(error for error, _ in sweep[k:]) <= tolerance]
        hand = f"{min(sweep[k][1] for k in good):8.3f} s" if good else "none"
        made = dataclasses.replace(case.build(2, 1), probes={"goal": (*quantity.point, 0.0)})
        begin = time.process_time()
        one = ks.solve(made, tolerance=tolerance)
        seconds = time.process_time() - begin
        assert abs(one.probes["goal"]["u"][2] / reference - 1) <= max(
            tolerance, 2 * case.references[name].uncertainty
        )
        print(f"{id:24}{tolerance:10.0e}{seconds:12.3f} s{hand:>10}")

# %% [markdown]
# ## What the model leaves out
#
# The budget of a plate names what transverse shear would change. References: quadrilaterals of order 6 with shear,
# graded to edges and corners; $D = 1$, $t$ over the side of a square.

# %%
references = {
    ("hard", 0.01): 5.8980e-4, ("hard", 0.1): 5.8979e-2, ("soft", 0.01): 1.0284e-2, ("soft", 0.1): 1.5384e-1,
    ("clamped", 0.01): 3.0156e-3, ("clamped", 0.1): 2.8609e-1,
}  # fmt: skip
supports = {"hard": ks.SimplySupported, "soft": ks.SoftSupported, "clamped": ks.Clamped}
sides = ["x0", "x1", "y0", "y1"]
print(f"{'edges':10}{'t':>6}{'predicted':>12}{'with shear':>12}{'ratio':>8}")
for (kind, t), change in references.items():
    thin = ks.Scene(
        mesh=meshes.rectangle(1.0, 1.0, 8), thickness=t, material=ks.Isotropic(E=12 * 0.91 / t**3, nu=0.3),
        supports=[supports[kind](sides)], loads=[ks.Pressure(1.0)],
    )  # fmt: skip
    predicted = ks.solve(thin, model="plate", large_deflection=False, tolerance=1e-5).error["budget"]["shear"]
    print(f"{kind:10}{t:6.2f}{predicted:12.4e}{change:12.4e}{predicted / change:8.3f}")
