# %% [markdown]
# # Motion, contact, and materials that remember
#
# Every implicit time step is one equilibrium: with $v_1 = d\,x_1 - v_k$ and $a_1 = c\,x_1 - a_k$ a step of any scheme
# solves
#
# $$w\,M a_1 + D v_1 + f(x_1) = f_1 + r ,$$
#
# that is, a static problem with springs $w\,c\,M + d\,D$. Contact adds a potential that grows without bound where
# surfaces meet; materials that remember add strains that stay.
#
# Made from `motion.py` by `python -m verification.notebooks.make motion`.

# %%
import warnings

import matplotlib.pyplot as plt
import numpy as np

import kshell as ks
from kshell.verify.cases.large_scenes import rectangle

warnings.simplefilter("ignore", ks.KshellWarning)
quick = False

# %% [markdown]
# ## A cantilever in its first mode
#
# The period is longer than that of the beam, $\omega = 1.8751^2 \sqrt{EI / \rho A} / L^2$, by what theory says of
# each scheme: $(\omega h)^2 / 12$ for the rule that keeps energy and momentum, four times that for implicit Euler,
# which damps.

# %%
E, t, density = 200e9, 0.005, 7800.0
root = 1.8751040687
omega = root**2 * np.sqrt(E * t**2 / 12 / density)
period = 2 * np.pi / omega


def mode(x):
    k = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
    return np.cosh(root * x) - np.cos(root * x) - k * (np.sinh(root * x) - np.sin(root * x))


cantilever = ks.Scene(
    mesh=rectangle(1.0, 0.1, 4, 1), thickness=t, material=ks.Isotropic(E=E, nu=0.0, density=density),
    supports=[ks.Clamped("x0")], probes={"tip": (1.0, 0, 0)},
    initial_velocity=lambda x, y, z: (0 * x, 0 * x, 5e-5 * omega * mode(x)),
)  # fmt: skip
figure, axes = plt.subplots(figsize=(8, 3.4), layout="constrained")
for scheme in ("alpha", "em", "bdf2", "euler"):
    history = ks.simulate(cantilever, scheme=scheme, order=2, time=3.2 * period, step=period / 40).history
    z = history["probes"]["tip"]["u"][:, 2]
    axes.plot(history["time"] / period, z / 1e-4, label=scheme)
    up = [k for k in range(1, len(z) - 1) if z[k] <= 0 < z[k + 1]]
    cross = [history["time"][k] - z[k] * np.diff(history["time"])[k] / (z[k + 1] - z[k]) for k in up]
    print(
        f"{scheme:6} period longer by {np.mean(np.diff(cross)) / period - 1:.2e}, "
        f"(wh)^2/12 = {(np.pi / 20) ** 2 / 12:.2e}"
    )
axes.set(xlabel="t / T", ylabel="tip / amplitude", title="40 steps a period")
_ = axes.legend()

# %% [markdown]
# ## A roof that snaps through
#
# The load grows beyond what the roof carries; it jumps, swings, and comes to rest where the static path goes on.

# %%
roof = ks.Scene.load("meshes/roof_snap.toml")
snap = ks.simulate(roof, step=2e-3 if quick else 1e-3)
still = ks.Scene.load("meshes/roof_snap.toml", ["load.0.value=[0, 0, -600]"])
path = ks.trace(still, time=None, step="auto", scheme="auto")
figure, axes = plt.subplots(figsize=(8, 3.4), layout="constrained")
load = 600 * np.minimum(snap.history["time"] / 0.05, 1)
axes.plot(-snap.history["probes"]["crown"]["u"][:, 2], load, label="in motion")
axes.plot(
    [-state["probes"]["crown"]["u"][2] for state in path.path], [600 * state["factor"] for state in path.path],
    ".--", label="static path",
)  # fmt: skip
axes.set(xlabel="deflection of the crown", ylabel="force on a quarter")
_ = axes.legend()
rest, there = snap.probe("crown")["u"][2], path.probe("crown")["u"][2]
print(f"comes to rest at {rest:.4f}, static {there:.4f}")

# %% [markdown]
# ## A sheet on a ball
#
# Static analyses take contact: the sheet comes to rest as through a viscous fluid. The ball carries all of its weight,
# and nothing crosses.

# %%
cloth = ks.Scene(
    mesh=rectangle(0.5, 0.5, 6 if quick else 10, 6 if quick else 10), thickness=2e-3,
    material=ks.Isotropic(E=1e6, nu=0.3, density=500.0), loads=[ks.Gravity((0, 0, -9.81))],
    probes={"corner": (0.5, 0.5, 0)}, contact=ks.Contact(friction=0.3),
    obstacles=[ks.Obstacle({"kind": "sphere", "centre": (0.253, 0.252, -0.126), "radius": 0.12}, name="ball")],
)  # fmt: skip
hanging = ks.solve(cloth, order=1, error="off")
force = -hanging.history["contact_force"]["ball"][-1, 2]
print(f"force on the ball {force:.6f}, weight {0.25 * 2e-3 * 500 * 9.81:.6f}")
print(f"smallest gap {hanging.history['smallest_gap'][-1]:.2g}, balance {hanging.balance:.0e}")
places = hanging.points + hanging.fields["displacement"]
figure = plt.figure(figsize=(6, 4.2), layout="constrained")
axes = figure.add_subplot(projection="3d")
axes.plot_trisurf(
    *places.T, triangles=hanging.mesh.triangles, color="#8fb3d9", edgecolor="#44607c", linewidth=0.3
)
axes.set_box_aspect(np.ptp(places, axis=0))
_ = axes.set_axis_off()

# %% [markdown]
# ## Springback and creep
#
# A strip is bent to three times its deflection at yield and let go: the beam with the moment $M_0 = \sigma_y t^2 / 4$
# and hardening $0.05 D$ keeps 1.7186 of that deflection. And under a load that stays a strip whose stress relaxes goes
# on bending, by $J(t) = (1 - g\,e^{-(1-g)t/\tau}) / (1 - g)$.

# %%
E, t, limit = 1e9, 0.01, 5e4
D, yielded = E * t**3 / 12, limit * t**2 / 4
unit = yielded / (3 * D)
peak = 1.2814 * yielded
strip = {
    "thickness": t, "supports": [ks.Clamped("x0")], "probes": {"tip": (1.0, 0, 0)},
    "mesh": rectangle(1.0, 0.1, 10 if quick else 40, 1),
}  # fmt: skip
metal = ks.Isotropic(E=E, nu=0.0, density=1e-4, yield_stress=limit, hardening=0.05 * E)
pull = ks.LineForce("x1", (0, 0, f"{peak}*max(0, 1 - abs(t - 1))"))
bent = ks.simulate(
    ks.Scene(material=metal, loads=[pull], **strip), time=2.0, step=0.05, scheme="euler"
).history
tip = bent["probes"]["tip"]["u"][:, 2] / unit
rubber = ks.Isotropic(E=E, nu=0.0, density=1e-3, relaxation=[[0.6, 1.0]])
stays = ks.LineForce("x1", (0, 0, 0.01 * 3 * D))
crept = ks.simulate(
    ks.Scene(material=rubber, loads=[stays], **strip), time=3.0, step=0.1, scheme="euler", order=1
).history
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
left.plot(tip, peak / yielded * np.maximum(0, 1 - np.abs(bent["time"] - 1)))
left.set(xlabel="tip / deflection at yield", ylabel="load / load at yield", title="springback")
law = 0.01 * (1 - 0.6 * np.exp(-0.4 * crept["time"])) / 0.4
u = crept["probes"]["tip"]["u"][:, 2]
right.plot(crept["time"], u, label="strip")
right.plot(crept["time"], law, "--", label="law of compliance")
right.set(xlabel="t / tau", ylabel="tip", title="creep")
_ = right.legend()
print(
    f"bent to {tip.max():.3f}, keeps {tip[-1]:.3f}; "
    f"creep off its law by at most {np.abs(u[1:] / law[1:] - 1).max():.1e}"
)
