"""Forces in cuts of curved shells by statics: N, Q and what the membrane strain works against."""

import meshio
import numpy as np
import pytest

import kshell as ks
from tests.shell.shapes import joined, panel, rectangle

A, B = 1.868, 1.0


def oval(element, n, thickness=0.05, young=1000.0, follower=False, **options):
    """A quarter of an endless elliptic tube under inner pressure 1, from the chart's parameter plane."""
    flat = rectangle(n, 1, 0, np.pi / 2, 0, 0.1)
    x = flat.points[flat.edges]
    sides = {"u0": (0, 0.0), "u1": (0, np.pi / 2), "v0": (1, 0.0), "v1": (1, 0.1)}
    groups = {k: flat.edges[(np.abs(x[:, :, i] - v) < 1e-9).all(axis=1)] for k, (i, v) in sides.items()}
    chart = ks.geometry.Chart.from_expressions(f"{A}*cos(u)", f"{B}*sin(u)", "v")
    scene = ks.Scene(
        mesh=ks.Mesh.from_arrays(flat.points, flat.triangles, groups), chart=chart, thickness=thickness,
        material=ks.Isotropic(E=young, nu=0.3), supports=[ks.Symmetry(name) for name in sides],
        loads=[ks.Pressure(1.0, follower=follower)],
        probes={"long": (A, 0, 0.05), "short": (0, B, 0.05), "between": (A * np.cos(0.7), B * np.sin(0.7), 0.05)},
    )  # fmt: skip
    return ks.solve(scene, model="shell", element=element, **options)


def around(probe, name):
    """Component along the tube's cross-section of a tensor or vector of a probe."""
    normal, first = probe["normal"], probe["axis_1"]
    hoop = np.cross([0, 0, 1.0], normal)
    c = np.array([first @ hoop, np.cross(normal, first) @ hoop])
    if len(probe[name]) == 2:
        return probe[name] @ c
    xx, yy, xy = probe[name]
    return c @ np.array([[xx, xy], [xy, yy]]) @ c


def by_statics(x):
    """N and |Q| at a place: the forces on the piece from the cut of the long axis, N = pressure times a there."""
    force = np.array([-x[1], x[0]])
    tangent = np.array([-A * x[1] / B, B * x[0] / A])
    tangent /= np.linalg.norm(tangent)
    return force @ tangent, abs(force @ np.array([tangent[1], -tangent[0]]))


@pytest.mark.parametrize(
    ("element", "options", "n"),
    [("koiter", {"order": 2}, 32), ("koiter", {"order": 3}, 16), ("argyris", {}, 16)],
)
def test_oval_tube(element, options, n):
    result = oval(element, n, large_deflection=False, **options)
    for name, probe in result.probes.items():
        force, shear = by_statics(probe["x"])
        assert around(probe, "N") == pytest.approx(force, rel=3e-4), name
        assert abs(around(probe, "Q")) == pytest.approx(shear, abs=0.03 if n == 32 else 1e-3), name
    # N_K is what stresses are made of, and what the strain works against
    k = around(result.probe("short"), "membrane_stress_resultant")
    bend, moment = B / A**2, around(result.probe("short"), "M")
    sign = 1.0 if result.probe("short")["normal"][1] < 0 else -1.0  # bends towards the inside
    assert around(result.probe("short"), "N") == pytest.approx(k - sign * bend * moment, rel=1e-3)
    assert abs(k - 1.0) > 0.1


def test_large_deflections_take_the_deformed_curvature():
    """The tube gets rounder; N at the axes is the pressure times the deformed half axis."""
    result = oval("koiter", 16, 0.02, 1e5, True, order=3, large_deflection=True)
    for name, axis in (("long", 0), ("short", 1)):
        probe = result.probe(name)
        half = probe["x"][axis] + probe["u"][axis]
        assert abs(probe["u"][axis]) > 0.2
        assert abs(around(probe, "N")) == pytest.approx(half, rel=2e-3)


def tee(**changes):
    """A plating of two panels and a stiffener below them that meet in the line x = 1."""
    mesh = joined(
        panel((0, 0, 0), (1, 0, 0), (0, 1, 0), 4),
        panel((1, 0, 0), (1, 0, 0), (0, 1, 0), 4),
        panel((1, 0, -0.5), (0, 0, 0.5), (0, 1, 0), 4),
    )
    x = mesh.points[mesh.triangles].mean(axis=1)
    edge = mesh.points[mesh.edges]
    groups = {
        "plating": mesh.triangles[x[:, 2] > -1e-9],
        "stiffener": mesh.triangles[x[:, 2] < -1e-9],
        "left": mesh.edges[(edge[:, :, 0] < 1e-9).all(axis=1)],
        "right": mesh.edges[(edge[:, :, 0] > 2 - 1e-9).all(axis=1)],
    }
    data = {
        "mesh": ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups), "thickness": 0.02,
        "material": ks.Isotropic(E=210e9, nu=0.3), "supports": [ks.Clamped("left"), ks.Clamped("right")],
        "loads": [ks.Pressure(1e4, "plating")], "probes": {"root": (1, 0.5, 0)},
    }  # fmt: skip
    return ks.Scene(**{**data, **changes})


def test_rows_of_a_branch(tmp_path):
    """Where sheets branch a vertex has a row for each; extremes are over all of them, with face and group."""
    result = ks.solve(tee(), large_deflection=False)
    mesh, count = result.mesh, len(result.mesh.points)
    on_line = np.flatnonzero((np.abs(mesh.points - [1, 0, 0])[:, [0, 2]] < 1e-9).all(axis=1))
    assert np.array_equal(result.vertex[:count], np.arange(count))
    assert len(result.points) == count + 2 * len(on_line)
    assert result.points == pytest.approx(mesh.points[result.vertex])
    for vertex in on_line:
        rows = np.flatnonzero(result.vertex == vertex)
        assert sorted(result.group[rows]) == ["plating", "plating", "stiffener"]
        assert len(set(result.patch[rows])) == 3
        assert np.ptp(result.fields["displacement"][rows], axis=0).max() == 0.0
    size = np.stack([result.fields[f"von_mises_{face}"] for face in ("top", "middle", "bottom")])
    largest = result.extremes["von_mises"]
    assert largest["value"] == size.max()
    face, row = np.argwhere(size == size.max())[0]
    assert (largest["face"], largest["group"]) == (("top", "middle", "bottom")[face], result.group[row])
    # the middle of the stiffener has its own values at the root, not those of the bent plating
    root = np.flatnonzero(result.vertex == on_line[2])
    moments = dict(zip(result.group[root], np.abs(result.fields["moment"][root]).max(axis=1), strict=True))
    assert moments["stiffener"] < 0.05 * moments["plating"]
    result.save(tmp_path)
    file = meshio.read(tmp_path / "result.vtu")
    assert file.points == pytest.approx(result.points)
    assert file.point_data["moment"] == pytest.approx(result.fields["moment"])
    assert np.array_equal(file.point_data["vertex"], result.vertex)
    assert (
        "means over the triangles"
        in (tmp_path / "result.vtu").read_text(errors="replace", encoding="utf-8")[:800]
    )
    assert "means over the triangles" in result.to_dict()["nodal_values"]


@pytest.mark.parametrize("order", [1, 2])
def test_rows_of_a_step(order, tmp_path):
    """A strip of thickness 2, then 1, under a moment: the stresses of both sides, not their mean."""
    mesh = joined(panel((0, 0, 0), (1, 0, 0), (0, 1, 0), 2), panel((1, 0, 0), (1, 0, 0), (0, 1, 0), 2))
    edge, centre = mesh.points[mesh.edges], mesh.points[mesh.triangles].mean(axis=1)
    groups = {
        "thick": mesh.triangles[centre[:, 0] < 1], "thin": mesh.triangles[centre[:, 0] > 1],
        "root": mesh.edges[(edge[:, :, 0] < 1e-9).all(axis=1)],
        "tip": mesh.edges[(edge[:, :, 0] > 2 - 1e-9).all(axis=1)],
    }  # fmt: skip
    scene = ks.Scene(
        mesh=ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups), thickness={"thick": 0.02, "thin": 0.01},
        material=ks.Isotropic(E=210e9, nu=0.0), supports=[ks.Clamped("root")], loads=[ks.EdgeMoment("tip", 100.0)],
    )  # fmt: skip
    result = ks.solve(scene, model="shell", order=order, large_deflection=False)
    expected = np.where(result.group == "thin", 6 * 100 / 0.01**2, 6 * 100 / 0.02**2)
    assert result.fields["von_mises_top"] == pytest.approx(expected, rel=1e-7)
    assert result.extremes["von_mises"]["group"] == "thin"
    for what in ("von_mises_top", "moment_xx"):
        result.plot(what).savefig(tmp_path / f"{what}.png")


@pytest.mark.parametrize("place", [(1, 0.5, 0), (1, 0.4, 0)], ids=["vertex", "edge"])
def test_probes_where_sheets_meet(place, tmp_path):
    """Each sheet by its group; `on` chooses one, in scene files too, and must be a surface group."""
    result = ks.solve(tee(probes={"root": place}), large_deflection=False)
    sheets = result.sheets["root"]
    assert sorted(sheets) == ["plating", "plating (2)", "stiffener"]
    assert any("meet at" in words and '"stiffener"' in words for words in result.warnings)
    faces = [f"von_mises_{face}" for face in ("top", "middle", "bottom")]
    largest = max(sheet[face] for sheet in sheets.values() for face in faces)
    assert max(result.probe("root")[face] for face in faces) == pytest.approx(largest, rel=1e-6)
    assert result.to_dict()["sheets"]["root"]["stiffener"]["u"] == pytest.approx(result.probe("root")["u"])
    chosen = ks.solve(tee(probes={"root": {"at": place, "on": "stiffener"}}), large_deflection=False)
    assert not chosen.sheets
    assert not any("meet at" in words for words in chosen.warnings)
    expected = sheets["stiffener"]["M"]
    assert chosen.probe("root")["M"] == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())
    with pytest.raises(ks.InputError, match='probe "root"'):
        ks.solve(tee(probes={"root": {"at": place, "on": "left"}}))


def test_a_probe_on_a_step_of_a_plate():
    """The side that is asked for, and both where none is."""
    edge = panel((0, 0, 0), (1, 0, 0), (0, 1, 0), 4)
    mesh = ks.Mesh(edge[0], edge[1])
    sides, centre = mesh.points[mesh.edges], mesh.points[mesh.triangles].mean(axis=1)
    groups = {
        "thick": mesh.triangles[centre[:, 0] < 0.5],
        "thin": mesh.triangles[centre[:, 0] > 0.5],
        "root": mesh.edges[(sides[:, :, 0] < 1e-9).all(axis=1)],
        "tip": mesh.edges[(sides[:, :, 0] > 1 - 1e-9).all(axis=1)],
    }
    scene = {
        "mesh": ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups),
        "thickness": {"thick": 0.02, "thin": 0.01}, "material": ks.Isotropic(E=210e9, nu=0.0),
        "supports": [ks.Clamped("root")], "loads": [ks.EdgeMoment("tip", 100.0)],
    }  # fmt: skip
    probes = {
        "p": (0.5, 0.5, 0),
        "a": {"at": (0.5, 0.5, 0), "on": "thick"},
        "b": {"at": (0.1, 0.5, 0), "on": "thin"},
    }
    result = ks.solve(ks.Scene(**scene, probes=probes), model="plate", large_deflection=False)
    assert sorted(result.sheets["p"]) == ["thick", "thin"]
    assert abs(result.probe("a")["stress_top"][0]) == pytest.approx(600 / 0.02**2, rel=1e-8)
    assert abs(result.probe("p")["stress_top"][0]) == pytest.approx(600 / 0.01**2, rel=1e-8)
    assert result.probe("b")["x"] == pytest.approx([0.5, 0.5, 0.0])
    assert abs(result.probe("b")["stress_top"][0]) == pytest.approx(600 / 0.01**2, rel=1e-8)


def test_a_probe_off_its_group():
    """Its value is that of the nearest point of the group, and so is its interval."""
    given = {"at": (0.0, 0.5, 0.9), "on": "plating"}
    result = ks.solve(tee(probes={"a": given, "b": (0.0, 0.5, 0.0)}), large_deflection=False)
    a, b = (result.error["probes"][name]["u"]["half_width"] for name in "ab")
    assert result.probe("a")["u"] == pytest.approx(result.probe("b")["u"], rel=1e-9)
    assert a == pytest.approx(b, rel=1e-6)
