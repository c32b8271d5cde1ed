"""Materials that remember: relaxation against the law of compliance, yielding against beams and bars."""

import numpy as np
import pytest

import kshell as ks
from kshell.shell.koiter.yielding import P, flow_of
from kshell.verify.cases import large_scenes
from tests.plate.plates import rectangle

LENGTH, WIDTH, THICKNESS, E = 1.0, 0.1, 0.01, 1e9
D = E * THICKNESS**3 / 12
LIMIT = 5e4
YIELDED = LIMIT * THICKNESS**2 / 4  # moment that yields through and through
# free to contract
HELD = [ks.Fixed("x0", "xr"), ks.Fixed((0, 0, 0), "yz"), ks.Fixed((0, WIDTH, 0), "z"), ks.Fixed("x1", "z")]
TIP_AT_YIELD = YIELDED * LENGTH**2 / (3 * D)


def strip(cells, material, load, **changes):
    """A cantilever, light enough to follow its load."""
    given = {
        "mesh": large_scenes.rectangle(LENGTH, WIDTH, cells, 1),
        "thickness": THICKNESS,
        "material": material,
        "supports": [ks.Clamped("x0")],
        "loads": [ks.LineForce("x1", load)],
        "probes": {"tip": (LENGTH, 0, 0)},
    }
    return ks.Scene(**{**given, **changes})


def test_creep():
    """Under a load that stays the deflection grows by the law of the standard linear solid."""
    g, tau = 0.6, 1.0
    force = 0.01 * 3 * D / LENGTH**2
    material = ks.Isotropic(E=E, nu=0.0, density=1e-3, relaxation=[[g, tau]])
    worst = {}
    for step in (0.1, 0.025):
        scene = strip(
            6, material, (0, 0, force), solve={"time": 3.0, "step": step, "scheme": "euler", "order": 2}
        )
        history = ks.simulate(scene).history
        law = 0.01 * (1 - g * np.exp(-(1 - g) * history["time"] / tau)) / (1 - g)
        tip = history["probes"]["tip"]["u"][:, 2]
        worst[step] = np.abs(tip[1:] / law[1:] - 1).max()
        assert (np.diff(history["dissipated_energy"]) > 0).all()
    assert worst[0.025] < 1e-3
    assert worst[0.1] < 2e-3


def test_regions_creep_by_terms_of_their_own():
    """A bar of three materials: one half relaxes by two terms, a quarter by one of them, the rest not at all."""
    force = 1e-3 * E * THICKNESS

    def material(*terms):
        return ks.Isotropic(E=E, nu=0.0, density=1e-3, relaxation=list(terms) or None)

    scene = ks.Scene(
        mesh=bar(),
        thickness=THICKNESS,
        material={"one": material([0.2, 1.0], [0.3, 4.0]), "two": material([0.3, 4.0]), "three": material()},
        supports=[ks.Clamped("bottom")],
        loads=[ks.LineForce("top", (0, force, 0))],
        probes={"end": (0, 1.0, 0)},
        solve={"time": 1.5, "step": 0.05, "scheme": "euler", "order": 1},
    )
    history = ks.simulate(scene).history
    t, end = history["time"][1:], history["probes"]["end"]["u"][1:, 1] / 1e-3
    # of one term the law of compliance; of both the roots of their Laplace transform
    one = (1 - 0.3 * np.exp(-0.7 * t / 4.0)) / 0.7
    both = compliance(t, [(0.2, 1.0), (0.3, 4.0)])
    assert end == pytest.approx(0.5 * both + 0.25 * one + 0.25, rel=3e-3)
    assert (np.diff(history["dissipated_energy"]) > 0).all()


def bar():
    """A strip along y, of surface groups one (half of it), two and three."""
    mesh = rectangle(1, 4, 0.1, 1.0)
    y = mesh.points[mesh.triangles, 1].mean(axis=1)
    groups = {name: mesh.edges[mesh.groups[name].members] for name in ("bottom", "top")}
    parts = {"one": y < 0.5, "two": (y > 0.5) & (y < 0.75), "three": y > 0.75}
    groups |= {name: mesh.triangles[inside] for name, inside in parts.items()}
    return ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups)


def compliance(t, terms):
    """J(t) E of a Prony series: 1 / E_inf less decaying terms, by the poles of 1 / (s E(s))."""
    rest = 1 - sum(g for g, _ in terms)
    # E(s) = rest + sum g s / (s + 1 / tau), as one fraction of polynomials
    low = np.poly1d([1.0])
    for _, tau in terms:
        low *= np.poly1d([1.0, 1.0 / tau])
    high = rest * low
    for g, tau in terms:
        other = np.poly1d([1.0])
        for _, another in terms:
            if another != tau:
                other *= np.poly1d([1.0, 1.0 / another])
        high += g * np.poly1d([1.0, 0.0]) * other
    out = low(0.0) / high(0.0) * np.ones_like(t)
    for pole in high.roots.real:
        out += low(pole) / (pole * high.deriv()(pole)) * np.exp(pole * t)
    return out


def test_relaxation_damps():
    """A vibration of a bar-like strip decays by the loss of its material: ratio g / 2 (w tau) / (1 + (w tau)^2)."""
    omega = 1.8751040687**2 * np.sqrt(D / (1000.0 * THICKNESS)) / LENGTH**2
    g = 0.1
    material = ks.Isotropic(E=E, nu=0.0, density=1000.0, relaxation=[[g, 1.0 / omega]])
    period = 2 * np.pi / omega

    def push(x, y, z):
        return 0 * x, 0 * x, 1e-4 * omega * x**2

    scene = strip(
        4, material, (0, 0, 0.0), loads=[], initial_velocity=push,
        solve={"time": 3.3 * period, "step": period / 80, "order": 2},
    )  # fmt: skip
    z = ks.simulate(scene).history["probes"]["tip"]["u"][:, 2]
    tops = [k for k in range(1, len(z) - 1) if z[k - 1] < z[k] >= z[k + 1] and z[k] > 0]
    decrement = np.log(z[tops[1]] / z[tops[2]])
    assert decrement / (2 * np.pi) == pytest.approx(g / 4, rel=0.1)


def beam(force):
    """Tip of the beam under a force, and what of it stays: H kappa_p = |M| - M0."""
    x = np.linspace(0, LENGTH, 4001)
    moment = force * (LENGTH - x)
    plastic = np.maximum(moment - YIELDED, 0) / (0.05 * D)
    return np.trapezoid((moment / D + plastic) * (LENGTH - x), x), np.trapezoid(plastic * (LENGTH - x), x)


@pytest.mark.parametrize("hardening", [0.05 * E, [0.0, 0.05 * E]])
def test_springback(hardening):
    """A strip bent to three times its deflection at yield and let go keeps what the beam keeps."""
    low, high = 0.0, 10 * YIELDED / LENGTH
    for _ in range(60):
        force = 0.5 * (low + high)
        low, high = (force, high) if beam(force)[0] < 3 * TIP_AT_YIELD else (low, force)
    assert beam(force)[1] / TIP_AT_YIELD == pytest.approx(1.7186, abs=2e-4)
    material = ks.Isotropic(E=E, nu=0.0, density=1e-4, yield_stress=LIMIT, hardening=hardening)
    bent = []
    for share in (0.985, 0.995):
        load = (0, 0, f"{share * force}*max(0, 1 - abs(t - 1))")
        scene = strip(20, material, load, solve={"time": 2.0, "step": 0.1, "scheme": "euler"})
        history = ks.simulate(scene).history
        tip = history["probes"]["tip"]["u"][:, 2] / TIP_AT_YIELD
        bent.append((tip.max(), tip[-1]))
        assert history["iterations"].max() <= 15
        assert history["external_work"][-1] < 1.02 * history["dissipated_energy"][-1]
    (before, kept), (after, more) = bent
    assert kept + (3.0 - before) * (more - kept) / (after - before) == pytest.approx(1.7186, rel=0.01)


def test_springback_of_a_static_load():
    """The static analysis grows the load in steps and arrives at the same tip."""
    material = ks.Isotropic(E=E, nu=0.0, density=1e-4, yield_stress=LIMIT, hardening=0.05 * E)
    force = 1.25 * YIELDED / LENGTH
    result = ks.solve(strip(20, material, (0, 0, force)))
    assert result.probe("tip")["u"][2] == pytest.approx(beam(force)[0], rel=0.03)
    assert result.model["order"] == 1
    assert result.model["large_deflection"]
    assert result.balance < 1e-6
    assert "yields" in result.error["why_not"]


@pytest.mark.parametrize(("hardening", "kept"), [(0.05 * E, 0.5), ([0.0, 0.05 * E], -0.2)])
def test_cycles(hardening, kept):
    """A bar pulled to 1.5 of its yield stress and pushed to 1.2 yields back with kinematic hardening only."""
    material = ks.Isotropic(E=E, nu=0.3, density=1e-4, yield_stress=LIMIT, hardening=hardening)
    full = 1.5 * LIMIT * THICKNESS
    load = (f"{full}*(min(t, 1) - 1.8*max(t - 1, 0))", 0, 0)
    scene = strip(2, material, load, supports=HELD, solve={"time": 2.0, "step": 0.1, "scheme": "euler"})
    history = ks.simulate(scene).history
    strain = history["probes"]["tip"]["u"][:, 0] / LENGTH
    hard = 0.05 * E
    assert strain[10] == pytest.approx(1.5 * LIMIT / E + 0.5 * LIMIT / hard, rel=2e-3)
    assert strain[20] == pytest.approx(-1.2 * LIMIT / E + kept * LIMIT / hard, rel=1e-2)


def test_the_tangent_is_that_of_the_return():
    """By differences, and a state on the surface yields no further."""
    rng = np.random.default_rng(1)
    elastic, shape, own = np.zeros((3, 1, 6, 6))
    q = E * np.diag([1.0, 1.0, 0.5])
    t = THICKNESS
    n, m = 1 / (LIMIT * t), 4 / (LIMIT * t**2)
    for block, factor, y in ((slice(0, 3), t, n), (slice(3, 6), t**3 / 12, m)):
        elastic[0, block, block] = factor * q
        own[0, block, block] = factor * np.linalg.inv(P)
        shape[0, block, block] = y**2 * P
    sizes = np.array([1e-5] * 3 + [1e-2] * 3)
    strain = 3 * sizes * rng.standard_normal(6)

    def returned(e):
        trial = np.einsum("tij,tj->ti", elastic, e[None])
        return flow_of(trial, np.zeros((1, 6)), np.ones(1), elastic, shape, 0.05 * E * own, 1e-6 * E * own)

    found = returned(strain)
    assert np.abs(found.plastic).max() > 0
    columns = [
        (returned(strain + d).stress - returned(strain - d).stress)[0] / (2 * d.max())
        for d in 1e-4 * np.diag(sizes)
    ]
    scale = np.sqrt(np.diag(elastic[0]))
    error = (np.array(columns).T - found.tangent[0]) / np.outer(scale, scale)
    assert np.abs(error).max() < 1e-6
    on = found.stress - found.back
    assert np.einsum("ti,tij,tj->t", on, shape, on) == pytest.approx(found.size**2, rel=1e-10)


def test_what_does_not_go_together():
    yields = ks.Isotropic(E=E, nu=0.0, density=1.0, yield_stress=LIMIT, hardening=0.0)
    relaxes = ks.Isotropic(E=E, nu=0.0, density=1.0, relaxation=[[0.3, 1.0]])
    push = (0, 0, 0.1 * YIELDED)
    for options, words in (
        ({"large_deflection": False}, "leave large_deflection"),
        ({"tolerance": 0.01}, "not known"),
        ({"model": "plate"}, "koiter"),
        ({"order": 2}, "order 1"),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.solve(strip(2, yields, push), **options)
    for material, changes, words in (
        (yields, {"damping": {"ratio": 0.1}}, "drag"),
        (relaxes, {"solve": {"scheme": "em"}}, "em"),
        (yields, {"solve": {"scheme": "em"}}, "em"),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.simulate(strip(2, material, push, **changes), time=1.0, step=0.5)
    for keys, words in (
        ({"hardening": 1.0}, "needs yield_stress"),
        ({"yield_stress": 1.0, "hardening": -1.0}, ">= 0"),
        ({"relaxation": [[0.6, 1.0], [0.5, 2.0]]}, "less than 1"),
        ({"relaxation": [[0.6, 0.0]]}, "> 0"),
        ({"relaxation": [0.6, 1.0]}, "pairs"),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.Isotropic(E=E, nu=0.0, **keys)
    stack = [ks.Layer(yields, 0.01), ks.Layer(relaxes, 0.01)]
    with pytest.raises(ks.InputError, match="differs"):
        ks.solve(strip(2, None, push, thickness=None, layers=stack), model="shell")
    with pytest.raises(ks.InputError, match="layers do not yield"):
        ks.solve(
            strip(2, None, push, thickness=None, layers=[ks.Layer(yields, 0.01)] * 2), model="shell", order=1
        )
    assert ks.modes(strip(2, yields, push), count=1).eigen[0]["value"] > 0
