# %% [markdown]
# # Where methods fail
#
# An honest gallery: where plate elements, meshes, materials and arithmetic give out, by how much, and what kshell does
# about it. Every statement is pinned by a test in `tests/verification/test_failures.py`; the modules are in
# `verification/failures`. Made from `failures.py` by `python -m verification.notebooks.make failures`.

# %%
import textwrap
import warnings

import kshell as ks
from verification.failures import GALLERY, measured
from verification.failures.failure import text_table

warnings.simplefilter("ignore", ks.KshellWarning)
quick = False


def show(id):
    entry = GALLERY[id]
    numbers = measured(id, quick)
    for words in (f"What fails.  {entry.what}", f"What kshell does.  {entry.kshell}"):
        print(textwrap.fill(words, 110), end="\n\n")
    print(text_table(numbers))
    return entry.draw(numbers)


# %% [markdown]
# ## Far from the origin

# %%
_ = show("origin")

# %% [markdown]
# ## Simple support on curved edges
#
# On a polygon $w = 0$ along two directions at a corner makes $\nabla w = 0$ there. However many corners, the limit
# remembers them: $3/64$ for every $\nu$, where the disk has $(5+\nu)/(1+\nu)/64$.

# %%
_ = show("curved_support")

# %% [markdown]
# ## Thin triangles

# %%
_ = show("thin_triangles")

# %% [markdown]
# ## Singular corners
#
# Near a corner of angle $\omega$ the deflection is $r^{s}$: $s = \pi/\omega$ between simply supported edges, here
# $6/5$ at $150°$; $s = 1.544$ between clamped ones at $270°$. Energies converge like $h^{2(s-1)}$.

# %%
_ = show("corners")

# %% [markdown]
# ## Poisson's ratio at its limits

# %%
_ = show("poisson")

# %% [markdown]
# ## The last digit

# %%
_ = show("conditioning")

# %% [markdown]
# ## Supports at points

# %%
_ = show("point_supports")

# %% [markdown]
# ## Curvature of triangulations

# %%
_ = show("discrete_curvature")

# %% [markdown]
# ## Membrane locking
#
# Bending without stretching needs $E = 0$ all over a triangle. If the polynomials cannot do that but for $u = 0$, the
# membrane energy, $(R/t)^2$ times that of bending, keeps the shell straight.

# %%
_ = show("locking")

# %% [markdown]
# ## Newton's method on thin strips

# %%
_ = show("newton")

# %% [markdown]
# ## Explicit and implicit time steps
#
# An explicit step is stable for $\Delta t \le 2/\omega_{max}$; the fastest motion of a mesh is a wave that crosses
# a triangle, and nobody looks at it.

# %%
_ = show("time_steps")

# %% [markdown]
# ## Textbook numbers

# %%
_ = show("textbook")

# %% [markdown]
# ## Hinges
#
# $E = \sum_e \frac{3}{2} D \frac{|e|^2}{A_1 + A_2}\theta_e^2$. On equilateral triangles this is the energy of a
# plate with $3D$ and $\nu = -1/3$: right for the $(k_1 + k_2)^2$ of a sphere, three times too much for a cylinder.
# On other triangulations it is the energy of other plates.

# %%
_ = show("hinges")

# %% [markdown]
# ## Surfaces whose bending energy is known

# %%
_ = show("known_bending")

# %% [markdown]
# ## A sharp crease

# %%
_ = show("crease")

# %% [markdown]
# ## Averages on smooth elements
#
# $\eta^2 = \int (M - M^*) : D^{-1} (M - M^*)$ with $M^*$ continuous: nothing is seen where $M$ is continuous by itself.

# %%
_ = show("averages")

# %% [markdown]
# ## A shape that stays

# %%
_ = show("frozen_shape")

# %% [markdown]
# ## Extrapolation at corners
#
# $v_\infty = v_3 + (v_3 - v_2) / (2^p - 1)$ with the rate $p$ of three meshes supposes an error $C h^p$.

# %%
_ = show("richardson")

# %% [markdown]
# ## Unbalanced rounding
#
# $J(w) = J(w_h) + \langle d, \kappa(z_h)\rangle + \frac12\langle d, d^*\rangle \pm \frac12|d||d^*|$ holds for
# moments in exact equilibrium only; $f - Kx$ of a rounded matrix is not that.

# %%
_ = show("rounding")
