"""Contact: nothing intersects, friction is Coulomb's, the floor carries the weight."""

import numpy as np
import pytest

import kshell as ks
from kshell.verify.cases import large_scenes

G, SLOPE = 9.81, np.radians(20.0)
PATCH = 1.0 * 0.1**2  # mass
FLOOR = ks.Obstacle({"kind": "plane", "point": (0, 0, -1.5e-3), "normal": (0, 0, 1)}, name="floor")
RUBBER = ks.Isotropic(E=1e7, nu=0.3, density=1000.0)


@pytest.fixture(scope="module")
def ipctk():
    return pytest.importorskip("ipctk")


def patch(friction, **changes):
    """A square on a floor that is inclined by the direction of gravity."""
    given = {
        "mesh": large_scenes.rectangle(0.1, 0.1, 2, 2),
        "thickness": 1e-3,
        "material": RUBBER,
        "probes": {"middle": (0.05, 0.05, 0)},
        "loads": [ks.Gravity((G * np.sin(SLOPE), 0, -G * np.cos(SLOPE)))],
        "contact": ks.Contact(friction=friction, self=False, distance=2e-3),
        "obstacles": [FLOOR],
        "solve": {"time": 0.2, "step": 0.01, "scheme": "euler", "order": 2},
    }
    return ks.Scene(**{**given, **changes})


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.35])
def test_sliding_on_an_incline(ipctk, friction):
    """Acceleration g (sin - mu cos), and the floor carries the weight across it."""
    result = ks.simulate(patch(friction))
    history = result.history
    speed = history["momentum"][:, 0] / PATCH
    half = len(speed) // 2
    a = (speed[-1] - speed[half]) / (history["time"][-1] - history["time"][half])
    assert a == pytest.approx(G * (np.sin(SLOPE) - friction * np.cos(SLOPE)), rel=0.03)
    floor = history["contact_force"]["floor"][-1]
    assert floor[2] == pytest.approx(-PATCH * G * np.cos(SLOPE), rel=0.01)
    assert floor[0] == pytest.approx(friction * -floor[2], abs=1e-3 * abs(floor[2]))
    assert history["smallest_gap"].min() > 0.0
    assert result.balance < 1e-6


def test_sticking_on_an_incline(ipctk):
    """Above tan 20 = 0.364 it stays, but for the stated creep eps (1 - sqrt(1 - tan / mu))."""
    result = ks.simulate(patch(0.38))
    creep = 1e-3 * (1 - np.sqrt(1 - np.tan(SLOPE) / 0.38))
    assert result.history["momentum"][-1, 0] / PATCH == pytest.approx(creep, rel=0.03)
    assert result.probe("middle")["u"][0] < 2e-3


def independent(places, faces):
    """Whether segments of triangles that share no corner cross others: all pairs, by signed volumes."""
    edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    e, f = np.meshgrid(np.arange(len(edges)), np.arange(len(faces)), indexing="ij")
    e, f = e.ravel(), f.ravel()
    shared = (edges[e][:, :, None] == faces[f][:, None, :]).any(axis=(1, 2))
    e, f = e[~shared], f[~shared]
    p, q = places[edges[e, 0]], places[edges[e, 1]]
    a, b, c = (places[faces[f, k]] for k in range(3))

    def volume(*corners):
        u, v, w, x = corners
        return np.einsum("ij,ij->i", np.cross(v - u, w - u), x - u)

    ends = volume(a, b, c, p) * volume(a, b, c, q) < 0
    s = [volume(p, q, *pair) for pair in ((a, b), (b, c), (c, a))]
    inside = (s[0] > 0) & (s[1] > 0) & (s[2] > 0) | (s[0] < 0) & (s[1] < 0) & (s[2] < 0)
    return bool((ends & inside).any())


def test_the_independent_test_sees_crossings():
    places = np.array(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, -1], [0.2, 0.2, 1], [0.3, 2, 0]], dtype=float
    )
    faces = np.array([[0, 1, 2], [3, 4, 5]])
    assert independent(places, faces)
    apart = places + np.repeat([[0, 0, 0], [0, 0, 5.0]], 3, axis=0)
    assert not independent(apart, faces)


def nothing_crosses(result, scene):
    """No state kept has surfaces that cross, looked at pair by pair."""
    from kshell.analysis.obstacles import _triangles

    mesh = result.mesh
    for _, make in result.series:
        state = make()
        places, faces = [mesh.points + state.fields["displacement"]], [mesh.triangles]
        for obstacle in scene.obstacles:
            if isinstance(obstacle.shape, dict) and obstacle.shape["kind"] != "plane":
                points, triangles = _triangles(obstacle, mesh.points.mean(axis=0), mesh.size, 0.0)
                faces.append(triangles + sum(map(len, places)))
                places.append(points)
        assert not independent(np.concatenate(places), np.concatenate(faces))


@pytest.mark.full
def test_drape_over_a_ball(ipctk):
    """A sheet falls on a ball; order 1, so its triangles are those of contact."""
    scene = ks.Scene(
        mesh=large_scenes.rectangle(0.5, 0.5, 4, 4),
        thickness=2e-3,
        material=ks.Isotropic(E=1e6, nu=0.3, density=500.0),
        loads=[ks.Gravity((0, 0, -G))],
        probes={"corner": (0.5, 0.5, 0)},
        contact=ks.Contact(friction=0.3),
        obstacles=[
            ks.Obstacle({"kind": "sphere", "centre": (0.253, 0.252, -0.126), "radius": 0.12}, name="ball")
        ],
        damping={"drag": 2.0},
        solve={"time": 0.24, "step": 0.02, "scheme": "euler", "order": 1, "output": 5},
    )
    result = ks.simulate(scene)
    assert result.probe("corner")["u"][2] < -0.1
    assert result.history["smallest_gap"].min() > 0.0
    assert result.history["contact_force"]["ball"][:, 2].min() < -0.5
    nothing_crosses(result, scene)


def pressed(down, **changes):
    """A strip on two supports under a cylinder that moves down."""
    given = dict(
        mesh=large_scenes.rectangle(0.4, 0.05, 8, 1),
        thickness=2e-3,
        material=ks.Isotropic(E=1e9, nu=0.0, density=1000.0),
        supports=[ks.Fixed("x0", "xyz"), ks.Fixed("x1", "yz")],
        probes={"middle": (0.2, 0.025, 0)},
        contact=ks.Contact(self=False, distance=5e-4),
        obstacles=[
            ks.Obstacle(
                {"kind": "cylinder", "point": (0.2, 0, 0.022), "axis": (0, 1, 0), "radius": 0.02},
                motion=[0, 0, down],
                name="tool",
            )
        ],
    )
    return ks.Scene(**{**given, **changes})


@pytest.mark.full
def test_a_plate_that_moves_presses(ipctk):
    """A strip follows the cylinder that presses it down, with the force on the cylinder."""
    scene = pressed(
        "-0.02*min(t/0.06, 1)",
        damping={"drag": 400.0},
        solve={"time": 0.12, "step": 3e-3, "scheme": "euler", "order": 2},
    )
    result = ks.simulate(scene)
    assert result.probe("middle")["u"][2] == pytest.approx(-0.019, abs=1.2e-3)
    inertia = 0.05 * 2e-3**3 / 12
    w = -result.probe("middle")["u"][2]
    force = 48 * 1e9 * inertia * w / 0.4**3
    assert result.history["contact_force"]["tool"][-1, 2] == pytest.approx(force, rel=0.1)


@pytest.mark.full
def test_pressed_to_rest(ipctk):
    """Without inertia: the force on the tool, the balance, and its work, which the strip stores."""
    result = ks.solve(pressed("-0.02*t", solve={"order": 2}))
    w = -result.probe("middle")["u"][2]
    force = 48 * 1e9 * 0.05 * 2e-3**3 / 12 * w / 0.4**3
    assert w == pytest.approx(0.019, abs=1.2e-3)
    tool = result.history["contact_force"]["tool"]
    assert tool[-1, 2] == pytest.approx(force, rel=0.03)
    held = sum(result.reactions[name]["force"][2] for name in ("x0", "x1"))
    assert held == pytest.approx(tool[-1, 2], rel=1e-6)
    assert result.external_work == pytest.approx(result.strain_energy, rel=0.02)
    assert result.balance < 1e-8
    assert result.history["time"][-1] == 1.0
    assert (np.diff(tool[:, 2]) > 0).all()


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_sheet_at_rest_on_a_floor(ipctk, friction):
    """Nothing else holds it: it comes down, and the floor carries all of the weight."""
    scene = patch(friction, loads=[ks.Gravity((0, 0, -G))], solve={"order": 1})
    result = ks.solve(scene)
    floor = result.history["contact_force"]["floor"]
    assert floor[-1] == pytest.approx([0, 0, -PATCH * G], abs=1e-6 * PATCH * G)
    assert result.balance < 1e-6
    assert abs(result.probe("middle")["u"][2]) < 1.5e-3
    assert result.history["smallest_gap"].min() > 0.0


@pytest.mark.full
def test_friction_at_rest(ipctk):
    """On an incline a sheet rests where mu is above tan 20 = 0.364, by friction; below it slides away."""
    sticks = patch(0.4, solve={"order": 1})
    result = ks.solve(sticks)
    floor = result.history["contact_force"]["floor"][-1]
    assert floor == pytest.approx(
        PATCH * G * np.array([np.sin(SLOPE), 0, -np.cos(SLOPE)]), abs=1e-6 * PATCH * G
    )
    slides = patch(0.3, solve={"order": 1})
    with pytest.raises(ks.SolveError, match=r"moves on and on|not at rest") as caught:
        ks.solve(slides)
    assert caught.value.state.history["time"][-1] < 1.0


@pytest.mark.full
def test_drape_to_rest(ipctk):
    """A sheet on a ball at rest: the ball carries its weight, nothing crosses."""
    scene = ks.Scene(
        mesh=large_scenes.rectangle(0.5, 0.5, 6, 6),
        thickness=2e-3,
        material=ks.Isotropic(E=1e6, nu=0.3, density=500.0),
        loads=[ks.Gravity((0, 0, -G))],
        probes={"corner": (0.5, 0.5, 0)},
        contact=ks.Contact(friction=0.3),
        obstacles=[
            ks.Obstacle({"kind": "sphere", "centre": (0.253, 0.252, -0.126), "radius": 0.12}, name="ball")
        ],
        solve={"order": 1},
    )
    result = ks.solve(scene)
    assert result.history["contact_force"]["ball"][-1] == pytest.approx([0, 0, -0.25 * G], abs=1e-6)
    assert result.balance < 1e-6
    nothing_crosses(result, scene)
    assert result.probe("corner")["u"][2] < -0.15  # which folds it hangs in is open


@pytest.mark.full
def test_drape_of_both_orders(ipctk):
    """The shadow of a stiff square on a ball: orders 1 and 2 on two meshes within 3 %."""
    shadows = []
    for order, cells in ((1, 8), (1, 12), (2, 4), (2, 6)):
        scene = ks.Scene(
            mesh=large_scenes.rectangle(0.5, 0.5, cells, cells),
            thickness=2e-3,
            material=ks.Isotropic(E=1e8, nu=0.3, density=1000.0),
            loads=[ks.Gravity((0, 0, -G))],
            contact=ks.Contact(friction=0.3, distance=2e-3, self=False),
            obstacles=[
                ks.Obstacle({"kind": "sphere", "centre": (0.25, 0.25, -0.186), "radius": 0.18}, name="ball")
            ],
            solve={"order": order, "error": "off"},
        )
        result = ks.solve(scene)
        places = (result.points + result.fields["displacement"])[:, :2]
        u, v = (places[result.mesh.triangles[:, k]] - places[result.mesh.triangles[:, 0]] for k in (1, 2))
        shadows.append(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2 / 0.25)
    assert max(shadows) < 1.03 * min(shadows)
    assert 0.85 < min(shadows) < 0.95


def test_a_sheet_folds_on_itself(ipctk):
    """Half of a strip is thrown onto the other half: it does not pass through."""
    scene = ks.Scene(
        mesh=large_scenes.rectangle(0.4, 0.05, 10, 1),
        thickness=1e-3,
        material=ks.Isotropic(E=1e6, nu=0.3, density=1000.0),
        probes={"end": (0.4, 0, 0)},
        initial_velocity={"value": ["-4*max(x - 0.2, 0)/0.2", 0, "8*max(x - 0.2, 0)/0.2"]},
        contact=ks.Contact(self=True, distance=3e-3),
        damping={"drag": 1.0},
        solve={"time": 0.12, "step": 4e-3, "scheme": "euler", "order": 1, "output": 10},
    )
    result = ks.simulate(scene)
    assert result.history["smallest_gap"].min() > 0.0
    nothing_crosses(result, scene)


def test_wrong_starts_are_refused(ipctk):
    inside = ks.Obstacle({"kind": "sphere", "centre": (0.05, 0.05, 0), "radius": 0.02}, name="ball")
    for changes, words in (
        ({"obstacles": [inside]}, "intersect at the start"),
        ({"contact": ks.Contact(self=False, thickness=0.1)}, "apart at the start"),
        ({"obstacles": [], "contact": ks.Contact(self=False)}, "nothing to touch"),
        ({"loads": [], "solve": {"time": 0.1, "order": 2}}, "nothing moves"),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.simulate(patch(0.0, **changes))
    with pytest.raises(ks.InputError, match="em"):
        ks.simulate(patch(0.0), scheme="em")
    held = patch(0.0, supports=[ks.Clamped("x0")], solve={})
    for options, words in (
        ({"analysis": "modes"}, "contact is for analysis"),
        ({"analysis": "path"}, "contact is for analysis"),
        ({"large_deflection": False}, "large deflections"),
        ({"tolerance": 0.01}, "refine the mesh by hand"),
        ({"model": "plate"}, "that of a shell"),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.solve(held, **options)


def test_words_of_contact_in_scene_files(tmp_path):
    text = (
        'mesh = "m.msh"\nthickness = 0.01\n[material]\nE = 1e9\nnu = 0.3\ndensity = 1000\n[contact]\nfriction = 0.3\n'
        'self = true\nwith = ["table.stl", {kind = "plane", point = [0, 0, -1], normal = [0, 0, 1], name = "floor", '
        'motion = ["0", "0", "0.1*t"]}]\n'
    )
    (tmp_path / "s.toml").write_text(text, encoding="utf-8")
    scene = ks.Scene.load(tmp_path / "s.toml")
    assert scene.contact.friction == 0.3
    assert scene.contact.self
    assert scene.obstacles[0].shape == tmp_path / "table.stl"
    assert scene.obstacles[1].name == "floor"
    assert scene.obstacles[1].displacement(2.0) == pytest.approx([0, 0, 0.2])
    for change, words in (
        ("contact.friction=-1", "must not be negative"),
        ("contact.speed=0", "must be > 0"),
        ("contact.thickness=-1", "number > 0"),
        ("contact.stiffness=3", "stiffness"),
        ('contact.with=[{kind="cube"}]', "the kinds are"),
        ('contact.with=[{kind="sphere", centre=[0,0,0]}]', "radius is missing"),
        ('contact.with=[{kind="plane", point=[0,0,0], normal=[0,0,0]}]', "must not be zero"),
        (
            'contact.with=[{kind="plane", point=[0,0,0], normal=[0,0,1], motion=["x","0","0"]}]',
            "unknown name",
        ),
    ):
        with pytest.raises(ks.InputError, match=words):
            ks.Scene.load(tmp_path / "s.toml", [change])


def test_without_the_package(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "ipctk", None)
    with pytest.raises(ks.InputError, match=r"kshell\[contact\]"):
        ks.simulate(patch(0.0))
