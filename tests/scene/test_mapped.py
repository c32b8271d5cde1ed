"""Fields of files as values of loads: their resultants, how far they reach, and what is wrong with a file."""

from pathlib import Path

import numpy as np
import pytest

import kshell as ks

ROOT = Path(__file__).parents[2]

PLATE = {
    "mesh": "meshes/plate.msh",
    "thickness": 0.02,
    "material": ks.Isotropic(E=210e9, nu=0.3),
    "supports": [ks.Clamped("left")],
}


def lifted(load, **given):
    result = ks.solve(ks.Scene(**{**PLATE, **given}, loads=[load]), large_deflection=False, error="off")
    return -result.reactions["left"]["force"][2], result.model["reasons"]


def table(path, n, head="x, y, z, p", field=lambda x, y: 100.0 + 50.0 * x + 20.0 * y):
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 2, 2 * n + 1), np.linspace(0, 1, n + 1)))
    rows = np.c_[x, y, 0 * x, field(x, y)]
    path.write_text(
        "\n".join([head, *(", ".join(f"{v:.12g}" for v in row) for row in rows)]), encoding="utf-8"
    )
    return path


def surface(path, n, field=lambda x, y: 100.0 + 50.0 * x + 20.0 * y):
    """Triangles on 2 by 1, with a field, as .vtu."""
    import meshio

    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 2, 2 * n + 1), np.linspace(0, 1, n + 1)))
    at = (np.arange(n)[:, None] * (2 * n + 1) + np.arange(2 * n)).ravel()
    quads = np.c_[at, at + 1, at + 2 * n + 2, at + 2 * n + 1]
    meshio.write_points_cells(path, np.c_[x, y, 0 * x], [("quad", quads)], point_data={"p": field(x, y)})
    return path


def test_points_of_a_table_tend_to_the_field(tmp_path):
    exact, _ = lifted(ks.Pressure("100 + 50*x + 20*y"))
    errors = []
    for n in (4, 16, 64):
        force, reasons = lifted(ks.Pressure(ks.Mapped(table(tmp_path / f"p{n}.csv", n), "p")))
        errors.append(abs(force / exact - 1.0))
        assert any("its integral over" in words for words in reasons)
    assert errors[-1] < 2e-3
    assert errors[-1] < errors[0]


def test_columns_without_a_head(tmp_path):
    file = table(tmp_path / "p.csv", 32, head="# by hand")
    named = table(tmp_path / "named.csv", 32)
    assert lifted(ks.Pressure(ks.Mapped(file)))[0] == lifted(ks.Pressure(ks.Mapped(named, "p")))[0]


def test_a_linear_field_on_triangles_is_exact(tmp_path):
    file = surface(tmp_path / "p.vtu", 3)
    exact, _ = lifted(ks.Pressure("100 + 50*x + 20*y"))
    force, reasons = lifted(ks.Pressure(ks.Mapped(file, "p")))
    # the plate has a hole, which the file has not: the field is taken as it is, and that is said
    assert force == pytest.approx(exact, rel=1e-10)
    assert any("it is taken as it is" in words for words in reasons)


def test_the_resultant_of_the_file_is_kept(tmp_path):
    file = surface(tmp_path / "p.vtu", 2, lambda x, y: 100.0 * np.exp(2 * x))
    known = 100.0 * np.exp(2 * np.linspace(0, 2, 5))
    resultant = 0.5 * (0.5 * known[0] + known[1:-1].sum() + 0.5 * known[-1])
    square = {"mesh": ks.geometry.Plane().mesh(7, 5, order=1, u_range=(0, 2), v_range=(0, 1))}
    square["supports"] = [ks.Clamped("u0")]
    scene = ks.Scene(**{**PLATE, **square}, loads=[ks.Pressure(ks.Mapped(file, "p"))])
    result = ks.solve(scene, large_deflection=False, error="off")
    assert -result.reactions["u0"]["force"][2] == pytest.approx(resultant, rel=3e-4)
    assert any("so that its integral is" in words for words in result.model["reasons"])
    plain = ks.solve(
        ks.Scene(**{**PLATE, **square}, loads=[ks.Pressure(lambda x, y, z: 100.0 * np.exp(2 * x))]),
        large_deflection=False,
        error="off",
    )
    assert -plain.reactions["u0"]["force"][2] == pytest.approx(100.0 * (np.exp(4) - 1) / 2, rel=1e-6)


def test_scene_file_shell_and_temperature(tmp_path):
    (tmp_path / "scene.toml").write_text(
        f"""
mesh = "{(ROOT / "meshes/scordelis_lo.msh").as_posix()}"
thickness = 0.25
material = {{E = 4.32e8, nu = 0, expansion = 1e-5}}

[[support]]
on = "wall"
fix = "xz"

[[support]]
on = ["middle", "crown"]
kind = "symmetry"

[[load]]
kind = "temperature"
mean = {{file = "warm.csv", field = "T", within = 5.0}}

[solve]
large_deflection = false
error = "off"
""",
        encoding="utf-8",
    )
    mesh = ks.Scene.load(tmp_path / "scene.toml").read_mesh()
    rows = [", ".join(f"{v:.12g}" for v in (*point, 30.0)) for point in mesh.points]
    (tmp_path / "warm.csv").write_text("\n".join(["x, y, z, T", *rows]), encoding="utf-8")
    scene = ks.Scene.load(tmp_path / "scene.toml")
    found = ks.solve(scene)
    scene.save(tmp_path / "other" / "scene.toml")
    again = ks.solve(ks.Scene.load(tmp_path / "other" / "scene.toml"))
    known = ks.solve(ks.Scene.load(tmp_path / "scene.toml", overrides=["load.0.mean=30"]))
    np.testing.assert_allclose(found.fields["displacement"], known.fields["displacement"], atol=1e-12)
    np.testing.assert_allclose(again.fields["displacement"], known.fields["displacement"], atol=1e-12)


def test_too_far_away(tmp_path):
    file = tmp_path / "p.csv"
    rows = [(x, y, 0.0, 1.0) for x in np.linspace(0, 1, 11) for y in np.linspace(0, 1, 11)]
    file.write_text("\n".join(["x,y,z,p", *(",".join(map(str, row)) for row in rows)]), encoding="utf-8")
    with pytest.raises(ks.InputError, match="away from all that the file knows"):
        lifted(ks.Pressure(ks.Mapped(file, "p")))
    force, _ = lifted(ks.Pressure(ks.Mapped(file, "p", within=1.5)))
    assert force > 0.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x,y,z,q\n0,0,0,1", 'no column "p"'),
        ("x,y,z,p\n0,0,zero,1", "no numbers"),
        ("x,y,z,p\n0,0,0", "no numbers"),
        ("x,y,z,p\n0,0,0,nan", "not a finite number"),
        ("x,y,z,p\n", "no values"),
        ("", "no values"),
    ],
)
def test_wrong_tables(tmp_path, text, words):
    file = tmp_path / "p.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ks.InputError, match=words):
        lifted(ks.Pressure(ks.Mapped(file, "p")))


def test_wrong_files(tmp_path):
    with pytest.raises(ks.InputError, match="no such file"):
        lifted(ks.Pressure(ks.Mapped(tmp_path / "none.csv", "p")))
    with pytest.raises(ks.InputError, match="no point data"):
        lifted(ks.Pressure(ks.Mapped(surface(tmp_path / "p.vtu", 2), "q")))
    (tmp_path / "bad.vtu").write_text("<no>", encoding="utf-8")
    with pytest.raises(ks.InputError, match="meshio cannot read it"):
        lifted(ks.Pressure(ks.Mapped(tmp_path / "bad.vtu", "q")))
    with pytest.raises(ks.InputError, match="within"):
        ks.Mapped("p.csv", within=-1.0)
    with pytest.raises(ks.InputError, match="unknown key"):
        ks.Pressure({"file": "p.csv", "column": "p"})
