"""Strokes over surfaces: principal directions and values as in closed forms, lengths and colours, places, words."""

import io

import numpy as np
import pytest

import kshell as ks
from kshell.draw.drawn import Drawn
from kshell.draw.pictures import pictures, usual_pictures
from kshell.draw.plot import save_picture
from kshell.draw.shape import drawn_scale
from kshell.draw.strokes import (
    BEYOND,
    HALF,
    NEGATIVE,
    POSITIVE,
    full_length,
    principal_of,
    spread,
    strokes_of,
)
from tests.scene.fabricated import square_mesh
from tests.shell.shapes import joined, panel

STEEL = ks.Isotropic(E=200e9, nu=0.3)
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]


def twisted(element):
    """A square on three corners, pressed down at the fourth by 2 H: M_xy has the size H everywhere."""
    scene = ks.Scene(
        mesh=square_mesh(4),
        thickness=0.01,
        material=STEEL,
        supports=[ks.Fixed(at, "z") for at in ((0, 0, 0), (1, 0, 0), (0, 1, 0))],
        loads=[ks.PointForce((1, 1, 0), (0, 0, -2.0))],
    )
    return ks.solve(scene, error="off", element=element)


@pytest.mark.parametrize("element", ["morley", "argyris", "hhj"])
def test_a_twisted_plate_has_directions_at_45_degrees(element):
    """w = - x y F / (2 D (1 - nu)), M_xy = F / 2 > 0: pulled at the top along x + y (Timoshenko 11)."""
    result = twisted(element)
    x = spread(Drawn(result), 0.0).rest
    found = principal_of(result.at(x), "principal_moments")
    assert found.values == pytest.approx(np.tile([1.0, -1.0], (len(x), 1)), rel=1e-6)
    angle = np.degrees(np.arctan2(found.directions[..., 1], found.directions[..., 0])) % 180.0
    assert angle == pytest.approx(np.tile([45.0, 135.0], (len(x), 1)), abs=1e-4)


@pytest.fixture(scope="module", params=["argyris", "morley"])
def disk(request):
    scene = ks.Scene(
        mesh="meshes/disk.msh",
        thickness=0.01,
        material=STEEL,
        supports=[ks.Clamped("edge")],
        loads=[ks.Pressure(16.0)],
    )
    return ks.solve(scene, error="off", element=request.param)


def test_a_clamped_disk_has_radial_and_tangential_directions(disk):
    """M_r = p (R^2 (1 + nu) - r^2 (3 + nu)) / 16, M_t = p (R^2 (1 + nu) - r^2 (1 + 3 nu)) / 16 (Timoshenko 16)."""
    exactly = disk.model["element"] == "argyris"
    x = spread(Drawn(disk), 0.0).rest
    r = np.linalg.norm(x[:, :2], axis=1)
    found = principal_of(disk.at(x), "principal_moments")
    exact = np.stack([1.3 - 1.9 * r**2, 1.3 - 3.3 * r**2], axis=1)  # tangential, radial; the top is pulled
    assert found.values == pytest.approx(exact, abs=1e-3 if exactly else 0.25)
    away = r > 0.4  # in the middle both are the same
    radial = x[away] / r[away, None]
    along = np.abs(np.sum(found.directions[away, 1] * radial, axis=1))
    assert along.min() > (1 - 1e-6 if exactly else 0.98)


def test_shear_flows_to_the_rim_of_a_disk(disk):
    """Q_r = - p r / 2 with the signs of Q = div M for a pressure along z."""
    (arrows,) = strokes_of(Drawn(disk), "shear", 0.0)
    count = len(arrows.lines) // 3
    start, end = arrows.lines[:count, 0], arrows.lines[:count, 1]
    middle, along = 0.5 * (start + end), end - start
    r = np.linalg.norm(middle, axis=1)
    length = np.linalg.norm(along, axis=1)
    cos = np.sum(along * middle, axis=1) / (length * r)
    away = r > 0.3
    exactly = disk.model["element"] == "argyris"
    assert np.abs(cos[away]).min() > (1 - 1e-4 if exactly else 0.5)
    assert len(set(np.sign(cos[away]))) == 1
    if exactly:
        assert length[away] / r[away] == pytest.approx(np.full(away.sum(), length.max() / r.max()), rel=1e-2)
    heads = arrows.lines[count:]
    assert heads[:, 0] == pytest.approx(np.tile(end, (2, 1)))


def cylinder(kind):
    """A quarter of a tube that is free to grow along z, under a pressure of 3 from inside, of radius 2."""
    chart = ks.geometry.Cylinder(R=2.0)
    if kind == "chart":
        x = square_mesh(4).points * [np.pi / 2, 1.0, 0.0]
        flat = ks.Mesh.from_arrays(x, square_mesh(4).triangles)
        at = flat.points[flat.edges]
        names = {"u0": (0, 0.0), "u1": (0, np.pi / 2), "v0": (1, 0.0)}
        sides = {n: flat.edges[(np.abs(at[:, :, k] - v) < 1e-9).all(axis=1)] for n, (k, v) in names.items()}
        mesh, more = ks.Mesh.from_arrays(flat.points, flat.triangles, sides), {"chart": chart}
    else:
        mesh, more = chart.mesh(6, 3, order=2, u_range=(0, np.pi / 2), v_range=(0, 1)), {}
    outwards = ["3*x/2", "3*y/2", 0]
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=STEEL,
        supports=[ks.Symmetry(name) for name in ("u0", "u1", "v0")],
        loads=[ks.Traction(outwards)],
        **more,
    )
    return ks.solve(scene, error="off", large_deflection=False)


@pytest.mark.parametrize("kind", ["koiter", "chart"])
def test_a_cylinder_under_pressure_is_pulled_around(kind):
    """N = p R around and 0 along."""
    result = cylinder(kind)
    x = spread(Drawn(result), 0.0).rest
    found = principal_of(result.at(x), "principal_forces")
    assert found.values == pytest.approx(np.tile([6.0, 0.0], (len(x), 1)), abs=0.02)
    around = np.stack([-x[:, 1], x[:, 0], 0 * x[:, 0]], axis=1) / np.linalg.norm(x[:, :2], axis=1)[:, None]
    assert np.abs(np.sum(found.directions[:, 0] * around, axis=1)).min() > 1 - 1e-4
    assert np.abs(found.directions[:, 1, 2]).min() > 1 - 1e-4


@pytest.fixture(scope="module")
def profile():
    """Two strips that meet at a right angle along their length, pulled along it by 5 per length, turned; nu = 0."""
    along, side, up = 2 * TURN[:, 0], TURN[:, 1], TURN[:, 2]
    plain = joined(
        panel((0, 0, 0), tuple(along), tuple(side), 4), panel((0, 0, 0), tuple(along), tuple(up), 4)
    )
    x = plain.points[plain.edges] @ TURN[:, 0]
    ends = {n: plain.edges[(np.abs(x - v) < 1e-9).all(axis=1)] for n, v in (("start", 0.0), ("end", 2.0))}
    scene = ks.Scene(
        mesh=ks.Mesh.from_arrays(plain.points, plain.triangles, ends),
        thickness=0.01,
        material=ks.Isotropic(E=200e9, nu=0.0),
        supports=[ks.Clamped("start")],
        loads=[ks.LineForce("end", tuple(5.0 * TURN[:, 0]), name="pull"), ks.Pressure(1.0, name="press")],
        cases=[ks.Case("pulled", ["pull"]), ks.Case("pushed", ["pull"], [-1.0]), ks.Case("bent", ["press"])],
    )
    return ks.solve(scene, error="off", large_deflection=False)


def test_a_folded_profile_is_pulled_along_its_fold_in_both_planes(profile):
    x = spread(Drawn(profile), 0.0).rest
    found = principal_of(profile.at(x), "principal_forces")
    assert found.values == pytest.approx(np.tile([5.0, 0.0], (len(x), 1)), abs=1e-6)
    assert np.abs(found.directions[:, 0] @ TURN[:, 0]).min() > 1 - 1e-9
    in_plane = np.where((np.abs(x @ TURN[:, 2]) < 1e-9)[:, None], TURN[:, 1], TURN[:, 2])
    assert np.abs(np.sum(found.directions[:, 1] * in_plane, axis=1)).min() > 1 - 1e-9


def test_colours_tell_the_sign_and_lengths_the_size_of_every_case(profile):
    pulled, pushed = (
        strokes_of(Drawn(profile.cases[name]), "principal_forces", 0.0) for name in ("pulled", "pushed")
    )
    apart = spread(Drawn(profile), 0.0).apart
    assert [each.colour for each in pulled] == [POSITIVE]
    assert [each.colour for each in pushed] == [NEGATIVE]
    assert [each.words for each in (*pulled, *pushed)] == ["tension", "compression"]
    for (each,) in (pulled, pushed):
        length = np.linalg.norm(each.lines[:, 1] - each.lines[:, 0], axis=1)
        assert length == pytest.approx(np.full(len(length), 2 * HALF * apart), rel=1e-6)
        assert float(each.longest) == pytest.approx(5.0)


def test_strokes_lie_in_the_deformed_triangles(profile):
    bent = profile.cases["bent"]
    scale = drawn_scale(bent)
    assert scale > 0.0
    places = spread(Drawn(bent), scale)
    assert np.linalg.norm(places.drawn - places.rest, axis=1).max() > 0.02 * bent.mesh.size
    for each in strokes_of(Drawn(bent), "principal_moments", scale):
        along = each.lines[:, 1] - each.lines[:, 0]
        assert np.abs(np.sum(along * each.normals, axis=1)).max() < 1e-9 * np.abs(along).max()


def test_places_are_spread_evenly(profile):
    for result in (profile, twisted("argyris")):
        places = spread(Drawn(result), 0.0)
        gaps = np.linalg.norm(places.rest[:, None] - places.rest, axis=2) + 1e9 * np.eye(len(places.rest))
        assert gaps.min() > 0.6 * places.apart
        assert gaps.min(axis=1).max() < 2.0 * places.apart  # none is alone


def test_a_peak_does_not_make_dots_of_all_others():
    sizes = np.append(np.linspace(0.5, 1.0, 200), 1000.0)
    assert 1.0 < full_length(sizes) < 1.01 * BEYOND
    assert full_length(sizes[:-1]) == 1.0
    assert full_length(np.zeros(5)) > 0.0
    assert full_length(np.append(np.zeros(99), 3.0)) == 3.0


def test_which_pictures_there_are(disk, profile):
    assert {"principal_moments", "principal_stress_top", "shear", "shear_x", "stress_bottom_xy"} <= set(
        pictures(disk)
    )
    assert "principal_forces" not in pictures(disk)
    assert {"principal_forces", "principal_stress_middle", "stress_middle_xx"} <= set(pictures(profile))
    usual = usual_pictures(disk)
    assert {"principal_moments", "shear"} <= set(usual)
    assert not {"principal_stress_top", "shear_x", "stress_top_xx"} & set(usual)
    modes = ks.modes(ks.Scene.load("meshes/plate_modes.toml"), count=2)
    assert not [name for name in pictures(modes) if name.startswith(("principal", "shear", "stress"))]
    with pytest.raises(ks.InputError, match='did you mean "principal_moments"'):
        disk.plot("principal_moment")


def test_what_stands_below_a_picture(profile):
    words = [profile.plot("principal_forces").legends[0].get_title().get_text()]
    words += [text.get_text() for text in profile.plot("principal_forces").legends[0].get_texts()]
    assert "principal membrane forces per length, from 0 to 5" in words[0]
    assert "longest stroke: 5" in words[0]
    assert words[1:] == ["tension"]


def test_a_result_from_files_has_the_same_crosses(profile, tmp_path):
    profile.save(tmp_path)
    again = ks.Result.load(tmp_path)
    x = spread(Drawn(profile), 0.0).rest
    one, other = (principal_of(result.at(x), "principal_forces") for result in (profile, again))
    assert other.values == pytest.approx(one.values, abs=1e-6)
    assert np.abs(np.sum(one.directions * other.directions, axis=2)).min() > 1 - 1e-6


@pytest.mark.parametrize(
    "what", ["principal_moments", "principal_forces", "shear", "stress_top_xx", "shear_y"]
)
def test_pictures_are_drawn(profile, disk, what):
    for result in (profile, disk):
        if what in pictures(result):
            stream = io.BytesIO()
            save_picture(result, what, stream, 60)
            assert len(stream.getvalue()) > 4000
