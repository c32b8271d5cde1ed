"""Loads that depend on the normal, and snow and water: resultants against integrals known exactly."""

import numpy as np
import pytest

import kshell as ks

RADIUS, LENGTH = 2.0, 3.0
EDGES = ("u0", "u1", "v0", "v1")
VAULT = ks.geometry.Chart.from_expressions(f"{RADIUS}*cos(u)", "v", f"{RADIUS}*sin(u)")
RANGES = {"u_range": (0.0, np.pi), "v_range": (0.0, LENGTH)}


def total(load, discretisation):
    """Resultant of a load on half a cylinder about the y axis, its crown up, held along all edges."""
    if discretisation == "koiter":
        mesh = {"mesh": VAULT.mesh(16, 6, order=2, **RANGES)}
    else:
        mesh = {"mesh": VAULT.parameter_mesh(12, 6, **RANGES), "chart": VAULT}
    scene = ks.Scene(
        **mesh,
        thickness=0.05,
        material=ks.Isotropic(E=1e9, nu=0.3),
        supports=[ks.Clamped(EDGES)],
        loads=[load],
    )
    result = ks.solve(scene, element=discretisation, large_deflection=False, error="off")
    return -sum(reaction["force"] for reaction in result.reactions.values())


@pytest.fixture(params=["koiter", "argyris"])
def discretisation(request):
    return request.param


def test_snow_lies_on_the_plan(discretisation):
    force = total(ks.Snow(700.0), discretisation)
    np.testing.assert_allclose(force, [0, 0, -700.0 * 2 * RADIUS * LENGTH], rtol=1e-4, atol=1e-2)


def test_snow_slides_off_steep_parts(discretisation):
    force = total(ks.Snow("700*nz**2"), discretisation)  # on this cylinder nz is sin u or its negative
    np.testing.assert_allclose(force[2], -700.0 * RADIUS * LENGTH * 4 / 3, rtol=1e-4)


@pytest.mark.parametrize(
    "load", [ks.Pressure("900*nx"), ks.Traction(["900*nx*nx", 0, "900*nx*nz"])], ids=["pressure", "traction"]
)
def test_wind_by_the_normal(load, discretisation):
    force = total(load, discretisation)
    np.testing.assert_allclose(force, [900.0 * RADIUS * LENGTH * np.pi / 2, 0, 0], rtol=1e-4, atol=0.1)


def wall(load, large=False):
    """An upright wall, 4 wide and 3 high, its foot clamped; its normal along y or against it."""
    surface = ks.geometry.Chart.from_expressions("u", "0", "v")
    scene = ks.Scene(
        mesh=surface.mesh(8, 12, order=1, u_range=(0.0, 4.0), v_range=(0.0, 3.0)),
        thickness=0.2,
        material=ks.Isotropic(E=30e9, nu=0.2),
        supports=[ks.Clamped("v0")],
        loads=[load],
    )
    return ks.solve(scene, large_deflection=large, error="off").reactions["v0"]


@pytest.mark.parametrize("follower", [False, True])
def test_water_against_a_wall(follower):
    depth = 2.0  # at the height of a row of vertices
    foot = wall(ks.Hydrostatic(weight=9810.0, level=depth, follower=follower), follower)
    force = 9810.0 * depth**2 / 2 * 4.0
    tolerance = 1e-4 if follower else 1e-10
    assert abs(foot["force"][1]) == pytest.approx(force, rel=tolerance)
    away = wall(ks.Hydrostatic(weight=-9810.0, level=depth, follower=follower), follower)
    np.testing.assert_allclose(away["force"], -foot["force"], rtol=1e-3, atol=1e-3 * force)


def test_water_above_its_level_is_none():
    foot = wall(ks.Hydrostatic(weight=9810.0, level="-1 + 0*x"))
    np.testing.assert_allclose(foot["force"], 0.0, atol=1e-12)


def plate(load):
    scene = ks.Scene(
        mesh="meshes/plate.msh",
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.Clamped("left")],
        loads=[load],
        probes={"end": (2.0, 0.5, 0.0)},
    )
    return ks.solve(scene, large_deflection=False, error="off").probe("end")["u"][2]


def test_on_a_plate_the_normal_is_z():
    known = plate(ks.Pressure(100.0))
    for load in (
        ks.Pressure("100*nz"),
        ks.Traction([0, "nx + ny", "100*nz**3"]),
        ks.Snow(200.0).times(0.5),
        ks.Hydrostatic(weight=50.0, level=2.0),
    ):
        sign = -1.0 if isinstance(load, ks.Snow) else 1.0
        assert plate(load) == pytest.approx(sign * known, rel=1e-12)


def test_scene_files_and_pictures(tmp_path):
    scene = ks.Scene.from_dict(
        {
            "mesh": "meshes/scordelis_lo.msh",
            "thickness": 0.25,
            "material": {"E": 4.32e8, "nu": 0.0},
            "support": [
                {"on": "wall", "fix": "xz"},
                {"on": ["middle", "crown"], "kind": "symmetry"},
            ],
            "load": [
                {"kind": "snow", "value": "20 if nz > 0.9 or nz < -0.9 else 0", "name": "snow"},
                {"kind": "pressure", "value": "5*max(nx, 0)", "name": "wind"},
                {"kind": "hydrostatic", "weight": 1.0, "level": 10},
            ],
        }
    )
    scene.save(tmp_path / "scene.toml")
    again = ks.Scene.load(tmp_path / "scene.toml")
    assert [load.kind for load in again.loads] == ["snow", "pressure", "hydrostatic"]
    assert again.loads == scene.loads
    result = ks.solve(again, large_deflection=False, error="off")
    assert result.balance < 1e-8
    assert result.plot("mesh") is not None


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ks.LineForce("edge", [0, 0, "nz"]), "nz"),
        (lambda: plate(ks.Snow("-1")), "negative"),
        (lambda: ks.Fixed("left", "z", "nx"), "nx"),
        (lambda: ks.Hydrostatic(weight=1.0), "level is missing"),
        (lambda: plate(ks.Pressure("1/nx")), "finite"),
    ],
)
def test_wrong_uses(make, words):
    with pytest.raises(ks.InputError, match=words):
        make()
