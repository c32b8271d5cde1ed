"""Buckling of scenes: classical loads of plates and shells, signs, loads that do not grow, and what is refused."""

import numpy as np
import pytest

import kshell as ks
from kshell.verify.cases import find
from tests.analysis.test_modes import square

P = np.pi**2


def press(x, y=0.0, shear=0.0, **more):
    """Uniform N_xx = -x, N_yy = -y, N_xy = shear in units of pi^2 on the unit square."""
    x, y, s = P * x, P * y, P * shear
    forces = {"x0": (x, -s), "x1": (-x, s), "y0": (-s, y), "y1": (s, -y)}
    return [ks.LineForce(on, (*f, 0.0), **more) for on, f in forces.items() if any(f)]


def clamped_across(*sides):
    return [ks.Fixed(side, "zr") for side in sides]


def factors(result):
    return np.array([e["value"] for e in result.eigen])


@pytest.mark.parametrize(
    ("held", "loads", "known"),
    [
        ("SSSS", press(1), [4.0, 6.25, 100 / 9]),
        ("SSSS", press(1, 1), [2.0, 5.0, 5.0]),
        ("SSSS", press(0, 0, 1), [9.324520262, -9.324520262, 11.54590942]),
        ("SSSS", press(-1, -1), [-2.0, -5.0, -5.0]),
    ],
)
def test_supported_square(held, loads, known):
    result = ks.buckling(square(held, n=12, loads=loads))
    assert factors(result) == pytest.approx(known, rel=1e-6)
    assert result.eigen[0]["frequency"] is None
    assert result.to_dict()["analysis"] == "buckling"
    assert np.linalg.norm(result.fields["mode_1"], axis=1).max() == pytest.approx(1.0)


def test_clamped_square():
    scene = square("FFFF", n=12, more=clamped_across("x0", "x1", "y0", "y1"), loads=press(1))
    assert factors(ks.buckling(scene)) == pytest.approx([10.073948, 11.61011278, 19.46501655], rel=2e-5)


def test_uniform_compression_has_guaranteed_intervals():
    result = ks.buckling(square("SSSS", loads=press(1)))
    for entry, known in zip(result.eigen, [4.0, 6.25, 100 / 9], strict=True):
        assert entry["kind"] == "guaranteed"
        assert entry["lower"] < known < entry["upper"]
        assert entry["lower"] > 0.8 * known


@pytest.mark.parametrize("loads", [press(0, 0, 1), press(1, -0.5)])
def test_states_with_tension_are_estimated(loads):
    result = ks.buckling(square("SSSS", loads=loads))
    assert {e["kind"] for e in result.eigen} == {"estimated"}
    assert any("tensile" in words for words in result.model["reasons"])


def test_no_interval_where_none_is_asked_for():
    result = ks.buckling(square("SSSS", loads=press(1)), error="off")
    assert {e["kind"] for e in result.eigen} == {"none"}


def test_loads_that_do_not_grow():
    """N_y fixed at half its critical value: k_x + k_y = 4 for the first shape of the square, so k_x = 4 - k_y."""
    loads = [*press(1), *press(0, 1, fixed=True)]
    assert factors(ks.buckling(square("SSSS", n=12, loads=loads)))[0] == pytest.approx(3.0, rel=1e-6)


def test_fixed_loads_beyond_buckling():
    loads = [*press(1), *press(0, 5, fixed=True)]
    with pytest.raises(ks.SolveError, match="fixed = true alone are beyond buckling"):
        ks.buckling(square("SSSS", loads=loads))


def test_shortened_plate_buckles_at_its_stress():
    """Ends moved towards each other by d, sides free to bulge: N_x = - E t d / a."""
    thickness = 0.01
    ends = [ks.Fixed("x0", "x"), ks.Fixed("x1", "x", value=(-1.0, 0.0, 0.0))]
    result = ks.buckling(square("SSSS", n=12, more=ends, thickness=thickness))
    stress = 12 * (1 - 0.3**2) / thickness**2  # E t, the force per length at a strain of 1
    assert factors(result)[0] == pytest.approx(4 * P / stress, rel=1e-6)


@pytest.mark.parametrize("order", [2, 3])
def test_flat_shell_buckles_as_the_plate(order):
    scene = square("SSSS", n=8, loads=press(1), thickness=0.005)
    assert factors(ks.buckling(scene, model="shell", order=order, count=1)) == pytest.approx([4.0], rel=5e-3)


def test_euler_column_of_a_shell():
    """Clamped at one end, nu = 0: pi^2 E I / (4 L^2)."""
    mesh = ks.geometry.Plane().mesh(16, 2, 1, ("x0", "x1", "y0", "y1"), (0, 10), (0, 1), "alternate")
    scene = ks.Scene(
        mesh=mesh, thickness=0.1, material=ks.Isotropic(E=12e3, nu=0.0), supports=[ks.Clamped("x0")],
        loads=[ks.LineForce("x1", (-1.0, 0, 0))],
    )  # fmt: skip
    result = ks.buckling(scene, count=1)
    assert factors(result) == pytest.approx([np.pi**2 / 400], rel=1e-5)
    assert factors(ks.buckling(scene, model="shell", count=1)) == pytest.approx([np.pi**2 / 400], rel=1e-3)


def test_cylinder_under_axial_load_is_near_the_classical_stress_and_clustered():
    """sigma = E t / (R sqrt(3 (1 - nu^2))), Timoshenko & Gere; its shapes lie close together."""
    r, t, e, nu, length = 1.0, 0.01, 1.0, 0.3, 0.6
    mesh = ks.geometry.Cylinder(R=r).mesh(
        20, 10, 2, ("u0", "u1", "v0", "v1"), (0, np.pi / 4), (0, length / 2)
    )
    classical = e * t**2 / (r * np.sqrt(3 * (1 - nu**2)))
    scene = ks.Scene(
        mesh=mesh, thickness=t, material=ks.Isotropic(E=e, nu=nu),
        supports=[ks.Symmetry("u0"), ks.Symmetry("u1"), ks.Symmetry("v0"), ks.Fixed("v1", "xy")],
        loads=[ks.LineForce("v1", (0, 0, -classical))],
    )  # fmt: skip
    result = ks.buckling(scene, count=4, order=3, error="off")
    assert factors(result)[0] == pytest.approx(1.0, abs=0.03)
    assert np.all(np.diff(factors(result)) >= 0)
    assert factors(result)[-1] < 1.1
    assert any("a cluster" in words for words in result.warnings)


def test_lateral_buckling_of_a_narrow_cantilever():
    """P = 4.01259934 (B C)^(1/2) / L^2, B = E h t^3 / 12, C = G h t^3 / 3 (Timoshenko & Gere); the root may warp."""
    length, h, t, e = 50.0, 1.0, 0.02, 1.0
    mesh = ks.geometry.Plane().mesh(
        50, 2, 1, ("x0", "x1", "y0", "y1"), (0, length), (-h / 2, h / 2), "alternate"
    )
    unit = np.sqrt(e * h * t**3 / 12 * e / 2 * h * t**3 / 3) / length**2
    scene = ks.Scene(
        mesh=mesh, thickness=t, material=ks.Isotropic(E=e, nu=0.0),
        supports=[ks.Fixed("x0", "xyz"), ks.Fixed((0, 0, 0), "r")], loads=[ks.LineForce("x1", (0, -unit / h, 0))],
    )  # fmt: skip
    result = ks.buckling(scene, count=2, error="off")
    assert np.abs(factors(result)) == pytest.approx([4.01259934] * 2, rel=1e-3)
    assert np.prod(factors(result)) < 0


def test_deflection_before_buckling_is_warned_of():
    loads = [*press(1), ks.Pressure(4.0)]
    result = ks.buckling(square("SSSS", loads=loads, thickness=0.01), error="off")
    assert any("before it buckles" in words and "kshell trace" in words for words in result.warnings)
    assert result.modal["path"] == {"kind": "not followed", "factor": None}


@pytest.mark.full
def test_a_plate_that_bends_first_has_no_critical_point():
    result = ks.buckling(square("SSSS", n=4, loads=[*press(1), ks.Pressure(4.0)], thickness=0.01))
    assert result.modal["path"]["kind"] == "none"
    assert any("no critical point up to the factor 6: it bends" in words for words in result.warnings)


@pytest.mark.full
def test_snap_through_is_told_beside_the_linear_factor():
    """The hinged roof of Sze, Liu & Lo 2004 (12.7 thick): a limit load of about 2.2 kN, linear buckling at 10.7."""
    mesh = ks.geometry.Cylinder(R=2540.0).mesh(4, 4, 2, ("mid", "hinge", "cut", "free"), (0, 0.1), (0, 254.0))
    scene = ks.Scene(
        mesh=mesh, thickness=12.7, material=ks.Isotropic(E=3.10275, nu=0.3),
        supports=[ks.Fixed("hinge", "xyz"), ks.Symmetry(["mid", "cut"])],
        loads=[ks.PointForce((2540.0, 0, 0), (-0.25, 0, 0))],
    )  # fmt: skip
    result = ks.buckling(scene, count=1)
    assert result.modal["path"]["kind"] == "limit"
    assert result.modal["path"]["factor"] == pytest.approx(2.2, rel=0.03)
    assert factors(result)[0] > 4 * result.modal["path"]["factor"]
    assert any("has a limit point near the factor 2.2" in words for words in result.warnings)


@pytest.mark.parametrize(
    ("id", "kind"),
    [
        ("buckling.SSSS.x", "guaranteed"),
        ("buckling.CCCC.orthotropic.x", "guaranteed"),
        ("buckling.SSSS.shear", "estimated"),
        pytest.param("buckling.CCCC.x", "guaranteed", marks=pytest.mark.full),
        pytest.param("buckling.CCCC.shear", "estimated", marks=pytest.mark.full),
        pytest.param("buckling.SSSF.x", "guaranteed", marks=pytest.mark.full),
        pytest.param("buckling.disk.clamped", "estimated", marks=pytest.mark.full),
    ],
)
def test_intervals_close_to_a_tolerance(id, kind):
    """Around known factors: proven under uniform compression, elsewhere from moments or meshes."""
    case = find(id)
    result = ks.solve(
        case.build(4, 2 if "disk" in id else 1), element="argyris", error="auto", tolerance=1e-6, count=2
    )
    known = list(case.references.values())
    assert result.error["kind"] == kind
    assert result.error["estimate"] <= 1e-6
    assert "why_not" not in result.error
    assert len(result.error["levels"]) >= 2
    positive = [entry for entry in result.eigen if entry["value"] > 0]
    for entry, reference in zip(positive, known, strict=False):
        assert entry["kind"] == kind
        off = reference.uncertainty * reference.value
        assert entry["lower"] - off <= reference.value <= entry["upper"] + off
        assert entry["upper"] - entry["lower"] <= 1e-6 * entry["value"]


def test_tolerance_of_a_shell_is_estimated_from_meshes():
    """Two modes of a tube: the interval is that of how far they move, and holds the exact values."""
    case = find("shell.buckling.tube")
    result = ks.solve(case.build(3, 0), element="koiter", order=3, count=1, tolerance=2e-3)
    assert result.error["kind"] == "estimated"
    assert result.error["estimate"] <= 2e-3
    assert result.eigen[0]["lower"] - 3e-4 <= 3.0 <= result.eigen[0]["upper"] + 3e-4


def test_a_tolerance_that_is_not_reached_is_told():
    result = ks.buckling(
        square("SSSS", n=2, loads=press(1)), element="morley", count=1, tolerance=1e-9, limit="1 s"
    )
    assert "is not reached" in result.error["why_not"]
    assert any("is not reached" in words for words in result.warnings)


def test_uniform_deflection_is_no_bending():
    ring = find("shell.buckling.tube")
    result = ring.solve(ring.runs[0])
    assert not any("before it buckles" in words for words in result.warnings)


def test_turning_pressure_on_a_free_edge_is_refused():
    mesh = ks.geometry.Cylinder(R=1.0).mesh(4, 2, 2, ("u0", "u1", "v0", "v1"), (0, 1.0), (0, 1.0))
    scene = ks.Scene(
        mesh=mesh, thickness=0.01, material=ks.Isotropic(E=1.0, nu=0.3), supports=[ks.Clamped("u0")],
        loads=[ks.Pressure(-1e-6, follower=True)],
    )  # fmt: skip
    with pytest.raises(ks.InputError, match="not symmetric where the edge of the surface is free"):
        ks.buckling(scene, error="off")


def test_stretched_plate_says_that_it_does_not_buckle():
    result = ks.buckling(square("SSSS", loads=press(-1)))
    assert any("no factor is positive" in words for words in result.warnings)


def test_factors_without_intervals_say_so():
    result = ks.buckling(square("SSSS", n=4, loads=[*press(1), *press(0, 1, fixed=True)]), count=1)
    assert result.eigen[0]["kind"] == "none"
    assert any("with a tolerance finer ones" in reason for reason in result.model["reasons"])


def test_a_positive_factor_behind_negative_ones_is_told():
    """f (n^2 - 10 m^2) = (m^2 + n^2)^2: reversed loads for m = 1, 2, 3 and n = 1, as given first for 1 and 5."""
    result = ks.buckling(square("SSSS", n=12, loads=press(-10, 1)), count=3)
    assert factors(result) == pytest.approx([-4 / 9, -25 / 39, -100 / 89], rel=1e-5)
    words = [w for w in result.warnings if "the loads as given buckle the structure at the factor" in w]
    assert len(words) == 1
    assert float(words[0].split("factor ")[1].split(":")[0]) == pytest.approx(26**2 / 15, rel=1e-3)
    assert not any("no factor is positive" in w for w in result.warnings)


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        (square("SSSS"), {}, "there is no load"),
        (square("SSSS", loads=press(1, fixed=True)), {}, "no load grows"),
        (square("SSSS", loads=press(1)), {"prestress": True}, "prestress is for vibration"),
        (square("SSSS", loads=press(1)), {"range": (0, 1)}, "range is for vibration"),
        (square("CCCC", loads=press(1)), {}, 'acts along x, which support clamped on "x0" holds'),
        (
            square("SSSS", loads=[ks.LineForce("x1", (-1.0, 0, 0))]),
            {},
            "not in equilibrium.*translation along x",
        ),
    ],
)
def test_refused(scene, options, message):
    with pytest.raises(ks.InputError, match=message):
        ks.buckling(scene, **options)


def test_loads_across_the_plate_do_not_buckle_it():
    with pytest.raises(ks.SolveError, match="no membrane forces"):
        ks.buckling(square("CCCC", loads=[ks.Pressure(1.0)]))
