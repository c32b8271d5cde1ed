"""Curves: arc length, Frenet frames, inflections, rotation-minimising frames, rebuilding."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import kshell.geometry as g
from kshell.errors import InputError

few = settings(max_examples=12, deadline=None, derandomize=True)

HELIX = g.Curve.from_expressions("3*cos(t)", "3*sin(t)", "4*t")  # curvature 3/25, torsion 4/25, speed 5
TWISTED = g.Curve.from_expressions("t", "t**2", "t**3")
S_CURVE = g.Curve.from_expressions("t", "t**3", "0", domain=(-1, 1))


def test_helix() -> None:
    f = HELIX.at(np.linspace(0, 9, 5))
    np.testing.assert_allclose(f.curvature, 3 / 25, rtol=1e-13)
    np.testing.assert_allclose(f.torsion, 4 / 25, rtol=1e-13)
    np.testing.assert_allclose(f.speed, 5.0, rtol=1e-14)
    np.testing.assert_allclose(f.normal[:, :2], -f.point[:, :2] / 3, atol=1e-14)
    np.testing.assert_allclose(f.binormal, np.cross(f.tangent, f.normal), atol=1e-14)
    np.testing.assert_allclose(
        f.frame @ np.swapaxes(f.frame, 1, 2), np.broadcast_to(np.eye(3), (5, 3, 3)), atol=1e-14
    )
    assert HELIX.length(1.0, 4.0) == pytest.approx(15.0, rel=1e-13)


def test_left_handed_helix_has_negative_torsion() -> None:
    assert g.Curve.from_expressions("3*cos(t)", "-3*sin(t)", "4*t").at(0.7).torsion == pytest.approx(-4 / 25)


def test_twisted_cubic() -> None:
    t = np.linspace(-1, 1, 5)
    f = TWISTED.at(t)
    np.testing.assert_allclose(
        f.curvature, 2 * np.sqrt(9 * t**4 + 9 * t**2 + 1) / (9 * t**4 + 4 * t**2 + 1) ** 1.5
    )
    np.testing.assert_allclose(f.torsion, 3 / (9 * t**4 + 9 * t**2 + 1), rtol=1e-13)
    np.testing.assert_allclose(f.curvature_vector, f.curvature[:, None] * f.normal, atol=1e-14)


def test_frenet_equations_by_arc_length() -> None:
    curve = TWISTED.by_arc_length(-1.0, 1.5)
    length = TWISTED.length(-1.0, 1.5)
    assert curve.domain == (0.0, pytest.approx(length, rel=1e-13))
    s = np.linspace(0.1, length - 0.1, 9)
    f = curve.at(s)
    np.testing.assert_allclose(f.speed, 1.0, atol=1e-13)
    np.testing.assert_allclose(np.sum(f.velocity * f.acceleration, axis=1), 0.0, atol=1e-12)
    step = 1e-4
    slope = (curve.at(s + step).frame - curve.at(s - step).frame) / (2 * step)
    k, t, o = f.curvature, f.torsion, np.zeros_like(s)
    matrix = np.stack([np.stack(row, -1) for row in [[o, k, o], [-k, o, t], [o, -t, o]]], axis=-2)
    np.testing.assert_allclose(slope, matrix @ f.frame, atol=1e-6)


@given(st.integers(0, 10**6))
@few
def test_motion_and_parameter_change_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rotation = Rotation.random(rng=seed).as_matrix()
    t = rng.uniform(0.1, 2.0, 5)
    f, moved = TWISTED.at(t), TWISTED.moved(rotation, rng.normal(size=3)).at(t)
    a, b = rng.uniform(0.5, 2.0, 2)
    inner = g.Curve(lambda s: (a * s + b * s**3, 0.0 * s, 0.0 * s))
    s = rng.uniform(0.1, 1.0, 5)
    new, old = TWISTED.reparametrised(inner).at(s), TWISTED.at(a * s + b * s**3)
    for p, q in ((moved, f), (new, old)):
        np.testing.assert_allclose(p.curvature, q.curvature, rtol=1e-10)
        np.testing.assert_allclose(p.torsion, q.torsion, rtol=1e-9)
    np.testing.assert_allclose(moved.frame, f.frame @ rotation.T, atol=1e-11)
    np.testing.assert_allclose(new.frame, old.frame, atol=1e-10)


def test_arc_length_of_a_parabola_and_inversion() -> None:
    parabola = g.Curve.from_expressions("t", "t**2")
    exact = np.sqrt(5) / 2 + np.arcsinh(2) / 4
    assert parabola.length(0, 1) == pytest.approx(exact, rel=1e-13)
    by_length = parabola.by_arc_length(0, 1)
    np.testing.assert_allclose(by_length([0.0, exact]), [[0, 0, 0], [1, 1, 0]], atol=1e-13)
    middle = by_length(exact / 3)
    assert parabola.length(0, float(middle[0])) == pytest.approx(exact / 3, rel=1e-13)
    with pytest.raises(InputError, match="outside"):
        by_length(exact + 0.01)


def test_frenet_frame_is_refused_at_an_inflection_with_its_place() -> None:
    f = S_CURVE.at([-0.5, 0.0, 0.5])
    assert f.inflection.tolist() == [False, True, False]
    np.testing.assert_array_equal(f.curvature[1], 0.0)
    np.testing.assert_allclose(f.curvature_vector[1], 0.0)
    for name in ("normal", "binormal", "torsion", "frame"):
        with pytest.raises(InputError, match=r"inflection.* at t = 0: .*rotation_minimising"):
            getattr(f, name)
    line = g.Curve.from_expressions("t", "2*t", "3*t")
    with pytest.raises(InputError, match=r"inflection.*and at 2 other points"):
        line.at([0.0, 1.0, 2.0]).normal  # noqa: B018


def test_rotation_minimising_frame_passes_inflections() -> None:
    t = np.linspace(-1, 1, 9)
    frames = S_CURVE.rotation_minimising(t, start=(0, 0, 1))
    np.testing.assert_allclose(
        frames[:, 1], np.broadcast_to([0, 0, 1.0], (9, 3)), atol=1e-12
    )  # plane: never turns
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-12)
    line = g.Curve.from_expressions("t", "2*t", "3*t").rotation_minimising([0.0, 5.0])
    np.testing.assert_allclose(line[0], line[1], atol=1e-14)


def test_rotation_minimising_frame_turns_against_frenet_by_the_torsion() -> None:
    t = np.linspace(0, 3, 7)
    f = HELIX.at(t)
    frames = HELIX.rotation_minimising(t, start=f.normal[0])
    angle = np.unwrap(np.arctan2(np.sum(frames[:, 1] * f.binormal, 1), np.sum(frames[:, 1] * f.normal, 1)))
    np.testing.assert_allclose(angle, -f.torsion[0] * f.speed * t, atol=1e-9)


def test_rotation_minimising_frame_checks_its_input() -> None:
    with pytest.raises(InputError, match="increasing"):
        HELIX.rotation_minimising([0.0, 0.0])
    with pytest.raises(InputError, match="along the tangent"):
        S_CURVE.rotation_minimising([0.0, 1.0], start=(1, 0, 0))


def matched(curve: g.Curve, other: g.Curve, s: np.ndarray) -> float:
    """Largest distance of two curves after the rigid motion that takes the first frames to each other."""
    a, b = curve.at(s), other.at(s)
    moved = (a.point - a.point[0]) @ a.frame[0].T @ b.frame[0] + b.point[0]
    return float(np.abs(moved - b.point).max())


def test_rebuilt_helix() -> None:
    rebuilt = g.rebuild(3 / 25, 4 / 25, 100.0)
    s = np.linspace(0, 100, 501)
    assert matched(HELIX.by_arc_length(0, 20), rebuilt, s) < 1e-9
    f = rebuilt.at(s)
    np.testing.assert_allclose(f.curvature, 3 / 25, rtol=1e-12)
    np.testing.assert_allclose(f.torsion, 4 / 25, rtol=1e-12)


@pytest.mark.parametrize("form", ["formula", "function", "pair", "spline"])
def test_rebuilt_curve_of_varying_curvature(form: str) -> None:
    knots = np.linspace(0, 2, 200)
    curvature = {
        "formula": "1 + s/2",
        "function": lambda s: 1 + s / 2,
        "pair": (lambda s: 1 + s / 2, lambda s: 0.5 + 0 * s),
        "spline": CubicSpline(knots, 1 + knots / 2),
    }[form]
    rebuilt = g.rebuild(curvature, "s*cos(s)", 2.0, start=(1, 2, 3))
    s = np.linspace(0, 2, 11)
    f = rebuilt.at(s)
    np.testing.assert_allclose(f.curvature, 1 + s / 2, rtol=1e-10)
    np.testing.assert_allclose(f.torsion, s * np.cos(s), atol=1e-10)
    np.testing.assert_allclose(f.point[0], [1, 2, 3])
    assert rebuilt.length(0, 2) == pytest.approx(2.0, rel=1e-12)
    step = 1e-4  # the frame belongs to the points
    np.testing.assert_allclose(
        (rebuilt(s[1:-1] + step) - rebuilt(s[1:-1] - step)) / (2 * step), f.tangent[1:-1], atol=1e-7
    )


def test_rebuilt_from_its_own_curvature_and_torsion() -> None:
    curve = TWISTED.by_arc_length(0.2, 1.5)
    length = curve.domain[1]
    nodes = 0.5 * length * (1 - np.cos(np.pi * np.arange(400) / 399))
    f = curve.at(nodes)
    rebuilt = g.rebuild(CubicSpline(nodes, f.curvature), CubicSpline(nodes, f.torsion), length)
    assert matched(curve, rebuilt, np.linspace(0, length, 50)) < 1e-8


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1.0, 0.0, 0.0), "length = 0.0 must be a positive"),
        ((1.0, 0.0, np.nan), "length"),
        (("s - 1", 0.0, 2.0), "curvature is -1 at s = 0"),
        ((1.0, "1/(s - 1)", 2.0), "torsion is not finite at s = 1"),
        ((None, 0.0, 2.0), "curvature must be a number"),
        ((1.0, 0.0, 1.0, (0, 0)), "start"),
        ((1.0, 0.0, 1.0, (0, 0, 0), np.diag([1, 1, -1])), "rotation"),
    ],
)
def test_rebuild_checks_its_input(arguments, message) -> None:
    with pytest.raises(InputError, match=message):
        g.rebuild(*arguments)


def test_curves_that_stand_still_or_have_no_length_are_refused() -> None:
    with pytest.raises(InputError, match=r"stands still.* at t = 0"):
        g.Curve.from_expressions("t**2", "t**3").at([1.0, 0.0])
    point = g.Curve.from_expressions("1", "2", "3")
    with pytest.raises(InputError, match="length zero from t = 0 to t = 2"):
        point.length(0, 2)
    with pytest.raises(InputError, match="length zero"):
        point.by_arc_length(0, 2)
    with pytest.raises(InputError, match="empty"):
        HELIX.length(1.0, 1.0)
    with pytest.raises(InputError, match="parameter t is nan"):
        HELIX.at([0.0, np.nan])
    with pytest.raises(InputError, match="not finite at t = -1"):
        g.Curve.from_expressions("t", "sqrt(t)").at([1.0, -1.0])


def test_length_across_a_corner() -> None:
    corner = g.Curve(
        lambda t: (t, np.abs(t), 0 * t), [lambda t: (1 + 0 * t, np.sign(t), 0 * t)] + [lambda t: (0 * t,) * 3] * 2,
        domain=(-1, 1),
    )  # fmt: skip
    assert corner.length(-1, 2) == pytest.approx(3 * np.sqrt(2), rel=1e-12)


def test_curves_given_by_functions() -> None:
    traced = g.Curve(lambda t: (3 * np.cos(t), 3 * np.sin(t), 4 * t))
    given = g.Curve(
        lambda t: (t, t**2, t**3),
        [lambda t: (1.0, 2 * t, 3 * t**2), lambda t: (0.0, 2.0, 6 * t), lambda t: (0.0, 0.0, 6.0)],
    )
    t = np.linspace(0.1, 1, 4)
    np.testing.assert_allclose(traced.at(t).torsion, HELIX.at(t).torsion, rtol=1e-12)
    np.testing.assert_allclose(given.at(t).torsion, TWISTED.at(t).torsion, rtol=1e-12)
    with pytest.raises(InputError, match="mend the derivative"):
        g.Curve(lambda t: (t, t**2, t**3), [lambda t: (1.0, 2 * t, 2 * t**2)])
    with pytest.raises(InputError, match=r"order 2.*up to order 1"):
        g.Curve(lambda t: (t, t**2, t**3), [lambda t: (1.0, 2 * t, 3 * t**2)]).at(t).curvature  # noqa: B018
