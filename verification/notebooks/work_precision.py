# %% [markdown]
# # Work and precision
#
# How much time and how many unknowns does an error cost, with kshell's elements and solvers and with other programs?
# Every line below is one method on finer and finer meshes; left and below is better.
#
# **What is timed**: processor time on one thread from the arrays of a mesh to the solution, best of 3 to 12, each
# program in a process of its own, without imports and a first small solve. `ks.solve` also checks mesh, supports and
# equilibrium in this time, but does not estimate errors (`error = "off"`), as no other program does; the drivers of the
# others (`verification/peers`) build the model, assemble and solve. Values at points are read behind the clock.
# All have the same grids, as triangles or quadrilaterals; NGSolve alone meshes the disk itself.
#
# **What an error is**: relative, of the energy (load times displacement), of a deflection and of a moment, to values
# that are exact or known to the uncertainty that is shaded.
#
# The table was written by `python -m verification.work_precision`. Programs that were not installed, and those that
# gave no answer, are named under each chart. Made from `work_precision.py` by
# `python -m verification.notebooks.make work_precision`.

# %%
from dataclasses import replace

from verification.work_precision import table
from verification.work_precision.catalogue import COMPARISONS
from verification.work_precision.draw import chart
from verification.work_precision.measure import run_all
from verification.work_precision.tables import first, not_first

quick = False
facts, rows = table.read()
for name, what in facts.items():
    print(f"{name:12} {what}")
print(
    len(rows), "measurements,", len({row["method"] for row in rows}), "methods,", len(COMPARISONS), "problems"
)

# %% [markdown]
# ## A smooth plate
#
# The simply supported square. HHJ elements of high order win where many digits are asked for, Argyris elements need the
# fewest unknowns of one order; the programs differ in what they spend before the first triangle, which decides on
# coarse meshes.

# %%
chart(COMPARISONS["square"], rows, facts)

# %% [markdown]
# ## A re-entrant corner
#
# The clamped L-shape. The corner's singularity would hold every element to the same slow rate; triangles graded towards
# it give the rate back, and high orders on them reach 1e-6 before quintics reach 1e-4.

# %%
chart(COMPARISONS["l_shape"], rows, facts)

# %% [markdown]
# ## A Koiter shell
#
# The Scordelis-Lo roof. Shells with shear deformation (Kratos and OpenSees bend without it, but on flat triangles) stop
# where their theory or their geometry does. Koiter elements of orders 4 to 6 reach 1e-3 with two triangles, 1e-6 with
# eight.

# %%
chart(COMPARISONS["scordelis_lo"], rows, facts)

# %% [markdown]
# ## A thin shell that locks
#
# The clamped hyperbolic paraboloid with $t/L = 10^{-3}$: elements whose membrane strains cannot vanish are too stiff.
# Argyris elements on the chart are among them, Koiter elements of orders 2 and 3 are not.

# %%
chart(COMPARISONS["hypar"], rows, facts)

# %% [markdown]
# ## Large deflections
#
# A cantilever strip whose tip rises by two thirds of its length. kshell finds its load steps itself; the other programs
# get the fewest equal steps with which they converge.

# %%
chart(COMPARISONS["strip"], rows, facts)

# %% [markdown]
# The other charts are in `verification/pictures/work_precision`: the disk, a large square, the pinched cylinder and the
# pinched hemisphere, the thin roof, the slit annulus.
#
# ## Who is first
#
# The least seconds to relative errors of 1e-3, 1e-6 and 1e-9, where anybody gets there and the reference is that good.
# A mesh counts if all finer ones of its method stay below the error, so that no lucky crossing wins. Programs ahead of
# kshell in bold.

# %%
print(first(list(COMPARISONS.values()), rows))

# %% [markdown]
# ## Where kshell is not left and below, and why
#
# In seconds or in unknowns. The reasons are read off the measurements: a *fixed cost* is what kshell's smallest mesh
# takes already; otherwise either each unknown costs more, or more unknowns are needed. NGSolve has elements of any
# order, and eliminates moments and bubbles inside the elements, so that its count of unknowns is that of the condensed
# system.

# %%
print(not_first(list(COMPARISONS.values()), rows))

# %% [markdown]
# ## Measured anew
#
# Two methods on the square, in processes of their own as for the table. Errors repeat to rounding; seconds are those of
# the machine that runs this.

# %%
counts = (4,) if quick else (4, 8, 16)
square = replace(COMPARISONS["square"], plan=dict.fromkeys(("kshell Argyris", "scikit-fem Argyris"), counts))
known = {(row["problem"], row["method"], row["cells"]): row for row in rows}
for row in run_all([square], None):
    old = known[row["problem"], row["method"], row["cells"]]
    print(
        f"{row['method']:20}{row['cells']:4} cells  error of the deflection {row['w error']:.2e}, in the table "
        f"{old['w error']:.2e}"
    )
