"""Natural frequencies of scenes: known values, intervals around them, rigid motions, prestress, and what is refused."""

import dataclasses
import re
from types import SimpleNamespace

import numpy as np
import pytest

import kshell as ks
from kshell.analysis.interval import Known
from kshell.analysis.models import model_of
from kshell.analysis.narrowing import Stage, _stalled
from kshell.analysis.run import Run
from kshell.plate.vibration import energies, energy_rounding
from kshell.solvers.eigen import smallest
from kshell.solvers.pencil import Pencil
from kshell.verify.cases import find
from tests.plate.plates import egg
from tests.shell.shell_scenes import cantilever_of_two

NU = 0.3
SIDES = ("x0", "x1", "y0", "y1")
KINDS = {"C": ks.Clamped, "S": ks.SimplySupported, "Y": ks.Symmetry}
CLAMPED = np.array([35.98519112, 73.39384552, 73.39384552, 108.2165017, 131.5807726, 132.2047902]) ** 2
FREE = np.array([13.46819742, 19.59613732, 24.27020109, 34.80089130]) ** 2


def square(held, n=8, more=(), loads=(), thickness=1.0, density=1.0, **options):
    """Unit square of bending stiffness 1 and mass 1 per area, held by letters in the order of SIDES."""
    mesh = ks.geometry.Plane().mesh(n, n, 1, SIDES, (0, 1), (0, 1), "alternate")
    material = ks.Isotropic(E=12 * (1 - NU**2) / thickness**3, nu=NU, density=density / thickness)
    supports = [KINDS[k](on) for on, k in zip(SIDES, held, strict=True) if k != "F"]
    return ks.Scene(
        mesh=mesh, thickness=thickness, material=material, supports=[*supports, *more], loads=list(loads), solve=options
    )  # fmt: skip


def values(result):
    return np.array([e["value"] for e in result.eigen if "name" not in e])


def test_entries_of_a_clamped_square():
    result = ks.modes(square("CCCC"))
    assert values(result) == pytest.approx(CLAMPED, rel=1e-4)
    first = result.eigen[0]
    assert set(first) == {"value", "frequency", "lower", "upper", "kind", "participation", "effective_mass"}
    assert first["frequency"] == pytest.approx(np.sqrt(first["value"]) / (2 * np.pi))
    for entry, known in zip(result.eigen, CLAMPED, strict=True):
        assert entry["kind"] == "guaranteed"
        assert entry["lower"] < known < entry["upper"]
        assert np.square(entry["participation"]) == pytest.approx(entry["effective_mass"])
    assert result.modal["total_mass"][:3] == pytest.approx([1.0, 1.0, 1.0])
    assert 0.6 < result.modal["effective_mass"][2] < 1.0
    assert result.fields["mode_1"].shape == (81, 3)
    assert result.to_dict()["eigen"][0] == first
    assert result.to_dict()["analysis"] == "modes"


def test_modes_have_unit_mass():
    """phi^T M phi = 1: for the first mode of a supported square, 2 sin(pi x) sin(pi y)."""
    result = ks.modes(square("SSSS"), count=1)
    w = result.fields["mode_1"][:, 2]
    assert np.abs(w).max() == pytest.approx(2.0, rel=1e-5)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_sharp_intervals(tolerance):
    result = ks.modes(square("CCCC"), tolerance=tolerance)
    for entry, known in zip(result.eigen, CLAMPED, strict=True):
        assert entry["kind"] == "guaranteed"
        assert entry["lower"] <= known * (1 + 2e-8)  # the last digit of the known value
        assert entry["upper"] >= known * (1 - 2e-8)
        assert entry["upper"] - entry["lower"] <= tolerance * entry["value"]
    assert result.error["estimate"] <= tolerance
    assert result.error["levels"][-1]["half_width"] <= 0.5 * tolerance


def test_exact_values_lie_in_sharp_intervals_of_a_supported_square():
    exact = np.pi**4 * np.array([4.0, 25, 25, 64, 100, 100, 169, 169, 289, 289])
    result = ks.modes(square("SSSS"), count=10, tolerance=1e-5)
    for entry, known in zip(result.eigen, exact, strict=True):
        assert entry["lower"] < known < entry["upper"]


def test_free_square_has_three_rigid_motions():
    result = ks.modes(square("FFFF"), count=4, tolerance=1e-5)
    assert [e.get("name") for e in result.eigen[:4]] == [
        "translation along z", "rotation about x", "rotation about y", None
    ]  # fmt: skip
    assert [e["value"] for e in result.eigen[:3]] == [0.0, 0.0, 0.0]
    assert values(result) == pytest.approx(FREE, rel=1e-6)
    for entry, known in zip(result.eigen[3:], FREE, strict=True):
        assert entry["kind"] == "guaranteed"
        assert entry["lower"] < known * (1 + 3e-8)
        assert entry["upper"] > known * (1 - 3e-8)


def test_free_shell_has_six_rigid_motions_and_the_same_bending():
    result = ks.modes(square("FFFF", thickness=0.01), model="shell", order=3, count=4)
    assert [e["name"] for e in result.eigen[:6]] == [
        *(f"translation along {a}" for a in "xyz"), *(f"rotation about {a}" for a in "xyz")
    ]  # fmt: skip
    assert values(result) == pytest.approx(FREE, rel=2e-3)
    assert result.modal["effective_mass"] == pytest.approx(result.modal["total_mass"], rel=1e-9)
    assert {e["kind"] for e in result.eigen[6:]} == {"estimated"}


def test_thin_cylinder_keeps_its_digits():
    """Bending of a thin ring of width 1: omega^2 = n^2 (n^2 - 1)^2 / (n^2 + 1) D' / (mu R^4), at t / R = 1e-4.

    The ring is free and nu = 0, so that its cross-section does not warp.
    """
    t = 1e-4
    mesh = ks.geometry.Cylinder(R=1.0).mesh(48, 1, 2, ("a", "b", "c", "d"), (0, np.pi / 2), (0, 0.2))
    scene = ks.Scene(
        mesh=mesh, thickness=t, material=ks.Isotropic(E=12.0 / t**2, nu=0.0, density=1.0 / t),
        supports=[ks.Symmetry(["a"]), ks.Symmetry(["b"])],
    )  # fmt: skip
    result = ks.modes(scene, count=1, order=3, error="off")
    n = 2  # D = t, mu = 1: with E t^3 / 12 = t the unit of omega^2 is t
    expected = n**2 * (n**2 - 1) ** 2 / (n**2 + 1) * t
    elastic = values(result)
    assert elastic[0] == pytest.approx(expected, rel=1e-4)


def test_range_of_frequencies():
    low, high = np.sqrt(CLAMPED[0]) / (2 * np.pi) * 1.1, np.sqrt(CLAMPED[3]) / (2 * np.pi) * 1.01
    result = ks.modes(square("CCCC"), range=(low, high))
    assert values(result) == pytest.approx(CLAMPED[1:4], rel=1e-4)


def test_elastic_support_lets_a_plate_bounce():
    """A free plate on springs k per area: omega^2 = k / mu for the translation."""
    everywhere = ks.Elastic("plate", 1e-3)
    mesh = ks.geometry.Plane().mesh(4, 4, 1, SIDES, (0, 1), (0, 1), "alternate")
    mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"plate": mesh.triangles})
    scene = ks.Scene(
        mesh=mesh,
        thickness=1.0,
        material=ks.Isotropic(E=12 * (1 - NU**2), nu=NU, density=2.0),
        supports=[everywhere],
    )
    result = ks.modes(scene, count=3)
    assert values(result) == pytest.approx([5e-4] * 3, rel=1e-6)
    assert all("name" not in entry for entry in result.eigen)
    assert result.eigen[0]["kind"] == "estimated"


def test_hinged_strip_turns_about_its_edge():
    result = ks.modes(square("SFFF"), count=1)
    assert result.eigen[0]["name"] == "rotation about y through (0, 0.5)"
    assert values(result)[0] == pytest.approx(6.643725662**2, rel=1e-5)


def test_tension_raises_frequencies_as_buckling_lowers_them():
    """Supported square under N_x: omega^2 = pi^4 (4 + N_x / (pi^2 D)) for the first mode."""
    for force in (5.0, -2.0, -3.9):
        pull = np.pi**2 * force
        loads = [ks.LineForce("x0", (-pull, 0, 0)), ks.LineForce("x1", (pull, 0, 0))]
        result = ks.modes(square("SSSS", loads=loads), count=1, prestress=True)
        assert values(result)[0] == pytest.approx(np.pi**4 * (4 + force), rel=1e-4)


def test_beyond_buckling_a_mode_has_no_frequency():
    push = 5 * np.pi**2
    loads = [ks.LineForce("x0", (push, 0, 0)), ks.LineForce("x1", (-push, 0, 0))]
    result = ks.modes(square("SSSS", loads=loads), count=2, prestress=True)
    assert result.eigen[0]["value"] == pytest.approx(-(np.pi**4), rel=1e-4)
    assert result.eigen[0]["frequency"] is None
    assert any("not stable" in words for words in result.warnings)


def test_mac_of_two_meshes():
    fine, coarse = ks.modes(square("CCCF", n=8), count=4), ks.modes(square("CCCF", n=5), count=4)
    alike = ks.mac(fine, coarse)
    assert np.diag(alike) == pytest.approx(1.0, abs=5e-2)
    assert np.abs(alike - np.diag(np.diag(alike))).max() < 0.05
    assert ks.mac(fine, fine) == pytest.approx(np.eye(4), abs=1e-2)


def test_warnings_say_what_does_not_act():
    result = ks.modes(square("YSSS", loads=[ks.Pressure(1.0)]), count=1)
    assert any("the loads do not act" in words for words in result.warnings)
    assert any("planes of symmetry" in words for words in result.warnings)


@pytest.mark.parametrize("options", [{"prestress": True}, {"model": "shell", "order": 3}])
def test_tolerance_without_a_proof_is_estimated_from_meshes(options):
    """4 pi^4 (1 + n / (2 pi^2)) under N_x = N_y = n; the shell without them."""
    loads = pulled(10.0) if "prestress" in options else []
    result = ks.modes(square("SSSS", n=4, loads=loads, thickness=0.01), count=1, tolerance=1e-4, **options)
    exact = 4 * np.pi**4 * (1 + 10.0 / (2 * np.pi**2) if loads else 1)
    entry = result.eigen[0]
    assert entry["kind"] == result.error["kind"] == "estimated"
    assert entry["upper"] - entry["lower"] <= 1e-4 * entry["value"]
    assert entry["lower"] <= exact * (1 + 1e-8)
    assert entry["upper"] >= exact * (1 - 1e-8)


def test_a_finer_mesh_that_cannot_be_solved_leaves_the_interval_of_the_last(monkeypatch):
    model, meshes = Run.model, []

    def folds_when_finer(run):
        meshes.append(len(run.structure.parameters.triangles))
        if meshes[-1] > meshes[0]:
            raise ks.InputError("a triangle folds over")
        return model(run)

    monkeypatch.setattr(Run, "model", folds_when_finer)
    result = ks.modes(square("SSSS", n=4), count=1, tolerance=1e-9)
    assert "is not reached" in result.error["why_not"]
    assert "the next mesh could not be solved (a triangle folds over)" in result.error["why_not"]
    assert result.eigen[0]["lower"] <= 4 * np.pi**4 <= result.eigen[0]["upper"] * (1 + 1e-9)
    assert len(result.error["levels"]) == 1


@pytest.mark.parametrize(
    "options", [{}, {"model": "shell", "order": 2, "large_deflection": True, "error": "off"}]
)
def test_prestress_at_a_factor(options):
    """Half of a load is the load halved; fixed loads act whole."""
    half = ks.modes(square("SSSS", n=4, loads=pulled(4.0), thickness=0.1), count=1, prestress=0.5, **options)
    whole = ks.modes(
        square("SSSS", n=4, loads=pulled(2.0), thickness=0.1), count=1, prestress=True, **options
    )
    assert values(half) == pytest.approx(values(whole), rel=1e-9)
    assert any("load factor 0.5" in words for words in half.model["reasons"])
    fixed = ks.modes(
        square("SSSS", n=4, loads=pulled(2.0, fixed=True), thickness=0.1), count=1, prestress=0.5, **options
    )
    assert values(fixed) == pytest.approx(values(whole), rel=1e-9)


def pulled(force, **more):
    """N_x = N_y = force."""
    sides = {"x0": (-1, 0, 0), "x1": (1, 0, 0), "y0": (0, -1, 0), "y1": (0, 1, 0)}
    return [ks.LineForce(on, tuple(force * c for c in way), **more) for on, way in sides.items()]


def test_pressure_on_a_flat_plate_is_no_prestress():
    result = ks.modes(square("CCCC", loads=[ks.Pressure(1.0)]), count=1, prestress=True)
    assert any("cause no membrane forces" in words for words in result.warnings)
    assert values(result)[0] == pytest.approx(CLAMPED[0], rel=1e-4)


def flap():
    """A strip clamped at one end, with a hinge across its middle."""
    material = ks.Isotropic(E=1e6, nu=NU, density=1.0)
    held = cantilever_of_two(supports=[ks.Clamped("a"), ks.Hinge("b")])
    return dataclasses.replace(held, material=material, loads=[])


def test_a_range_without_modes_says_so():
    result = ks.modes(square("CCCC", n=4), range=(0, 1))
    assert result.eigen == []
    assert "range: no mode lies between 0 and 1" in result.warnings


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        (square("CCCC", density=0.0), {}, "no density"),
        (square("CCCC", density=0.0), {"model": "shell"}, "no density"),
        (square("CCCC"), {"count": 5000}, "there are only"),
        (square("CCCC"), {"count": 3, "range": (0, 1)}, "count and range given"),
        (square("CCCC"), {"count": 0}, "must be a whole number > 0"),
        (square("CCCC"), {"range": (3, 1)}, "two frequencies that rise"),
        (square("CCCC"), {"prestress": True}, "prestress = true needs loads"),
        (flap(), {"order": 1}, r"can move freely, and not as a rigid body \(it moves most near \(2, "),
        (flap(), {"order": 2, "count": 2}, "a mechanism has no frequency"),
        (square("FFFF"), {"prestress": True}, "not held|needs loads"),
    ],
)
def test_refused(scene, options, message):
    with pytest.raises(ks.InputError, match=message):
        ks.modes(scene, **options)


def test_mac_needs_modes():
    static = ks.solve(square("CCCC", n=4, loads=[ks.Pressure(1.0)]), large_deflection=False)
    with pytest.raises(ks.InputError, match="the second result has no modes"):
        ks.mac(ks.modes(square("CCCC", n=4), count=1), static)


@pytest.mark.parametrize(("key", "value"), [("count", 3), ("range", (0, 1)), ("prestress", True)])
def test_options_of_modes_are_refused_elsewhere(key, value):
    with pytest.raises(ks.InputError, match=f"{key} is for analysis"):
        ks.solve(square("CCCC", n=2, loads=[ks.Pressure(1.0)]), **{key: value})


def test_tapered_membrane_in_its_plane():
    """NAFEMS FV32: 44.623, 130.03, 162.70, 246.05, 379.90, 391.44 Hz."""
    grid = ks.geometry.Plane().mesh(16, 8, 1, SIDES, (0, 1), (-1, 1), "alternate")
    x, y = grid.points[:, 0], grid.points[:, 1]
    points = np.column_stack([10 * x, y * (2.5 - 2 * x)])
    mesh = ks.Mesh.from_arrays(
        points, grid.triangles, {"root": grid.edges[grid.groups["x0"].members], "all": grid.triangles}
    )
    scene = ks.Scene(
        mesh=mesh, thickness=0.05, material=ks.Isotropic(E=200e9, nu=0.3, density=8000),
        supports=[ks.Fixed("root", "xyz"), ks.Fixed("all", "zr")],
    )  # fmt: skip
    result = ks.modes(scene, model="shell", order=3, count=6, error="off")
    known = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44]
    assert [e["frequency"] for e in result.eigen] == pytest.approx(known, rel=6e-4)


@pytest.mark.parametrize(
    ("held", "known"),
    [
        ("FFFF", [1.622, 2.360, 2.922, 4.233, 4.233, 7.416]),
        ("CFFF", [0.421, 1.029, 2.582, 3.306, 3.753, 6.555]),
    ],
)
def test_thin_square_plates_of_nafems(held, known):
    """FV12 (free) and FV16 (cantilevered): 10 m x 10 m x 0.05 m of steel, E = 200e9, nu = 0.3, density 8000.

    The targets are up to 1 % above the limit of thin theory, which the cases of `kshell verify` hold to 1e-6.
    """
    flexural, area = 200e9 * 0.05**3 / (12 * (1 - NU**2)), 8000 * 0.05
    unit = np.sqrt(flexural / area) / (2 * np.pi * 100)
    result = ks.modes(square(held, n=10), count=6, error="off")
    found = np.sqrt(values(result)) * unit
    assert found == pytest.approx(known, rel=1.2e-2)


@pytest.mark.parametrize("kind", [ks.Clamped, pytest.param(ks.SimplySupported, marks=pytest.mark.full)])
def test_intervals_of_an_l_shape_close_at_its_corner(kind):
    """The mesh is refined where the intervals come from; narrower ones lie within wider ones."""
    from kshell.verify.cases import meshes

    mesh = meshes.l_shape(8, 0)
    material = ks.Isotropic(E=12 * (1 - NU**2), nu=NU, density=1.0)
    scene = ks.Scene(mesh=mesh, thickness=1.0, material=material, supports=[kind("edge")])
    wide, narrow = (ks.modes(scene, count=3, tolerance=t) for t in (0.05, 0.01))
    for a, b in zip(wide.eigen, narrow.eigen, strict=True):
        assert a["kind"] == b["kind"] == "guaranteed"
        assert b["upper"] - b["lower"] <= 0.01 * b["value"]
        assert a["lower"] <= b["upper"]
        assert b["lower"] <= a["upper"]
        assert b["upper"] <= a["upper"] * (1 + 1e-9)
    # fewer than halving everywhere would take
    assert len(narrow.mesh.triangles) < 0.5 * 4 ** (len(narrow.error["levels"]) - 1) * len(mesh.triangles)


@pytest.mark.full
def test_intervals_close_at_sharp_corners_whose_triangles_are_tiny():
    """A cantilever rhombus of 30 degrees: rounding of its energies is that of curvatures, not of entries."""
    case = find("vibration.rhombus.CFFF.30")
    result = ks.solve(case.build(4, 1), element="argyris", error="auto", tolerance=5e-6, count=6)
    assert result.error["kind"] == "guaranteed"
    assert result.error["estimate"] <= 5e-6
    for entry, known in zip(result.eigen, case.references.values(), strict=True):
        # the references are Ritz values whose distance from the limit was estimated
        assert entry["lower"] <= (known.value * (1 + known.uncertainty)) ** 2
        assert entry["upper"] >= (known.value * (1 - 1.5 * known.uncertainty)) ** 2


@pytest.mark.parametrize(("rings", "order", "reached"), [(3, 1, False), (3, 2, True)])
def test_edges_known_by_few_nodes_widen_the_intervals(rings, order, reached):
    """A clamped egg: values of 20 rings, the difference is that of the edges."""
    known = np.array([104.07405202, 441.2614186, 450.5337086])
    material = ks.Isotropic(E=12 * (1 - NU**2), nu=NU, density=1.0)
    scene = ks.Scene(mesh=egg(rings, order), thickness=1.0, material=material, supports=[ks.Clamped("edge")])
    result = ks.modes(scene, count=3, tolerance=1e-3)
    lower, upper = (np.array([e[end] for e in result.eigen]) for end in ("lower", "upper"))
    assert ((lower < known) & (known < upper)).all()
    assert result.error["budget"]["geometry"] > 1e-5
    assert ("more nodes along its curved edges" not in result.error.get("why_not", "")) == reached


def test_rounding_of_energies_bounds_what_is_seen():
    """On a mesh graded by 1e-3: entries of the matrix lose what curvatures keep, within the bound of both."""
    model = model_of(find("vibration.rhombus.CFFF.30").build(4, 1), element="argyris")
    mass = model.mass()
    found = smallest(Pencil(model.stiffness(), mass, np.zeros((model.unknowns, 0)), model.energies), 4)
    bound = energy_rounding(model.problem, found.vectors, 16 * np.finfo(float).eps)
    by_entries, by_strains = (
        np.diag(energies(model.problem, found.vectors, strains=strains)) for strains in (False, True)
    )
    assert np.all(bound < 1e-7)
    assert np.all(bound > 1e-15)
    whole = (np.abs(found.vectors) * (abs(model.stiffness()) @ np.abs(found.vectors))).sum(axis=0)
    assert np.all(np.abs(by_entries - by_strains) <= bound * by_strains + 1e-15 * 16 * whole)


@pytest.mark.full
@pytest.mark.parametrize("kind", [ks.Clamped, ks.SimplySupported])
def test_ten_intervals_of_an_l_shape_to_1e_4(kind):
    """Those of two runs overlap; the narrower ones lie within the wider ones but for rounding."""
    from kshell.verify.cases import meshes

    material = ks.Isotropic(E=12 * (1 - NU**2), nu=NU, density=1.0)
    scene = ks.Scene(mesh=meshes.l_shape(8, 0), thickness=1.0, material=material, supports=[kind("edge")])
    wide, narrow = (ks.modes(scene, count=10, tolerance=t) for t in (1e-2, 1e-4))
    assert narrow.error["kind"] == "guaranteed"
    assert narrow.error["estimate"] <= 1e-4
    for a, b in zip(wide.eigen, narrow.eigen, strict=True):
        assert a["lower"] <= b["upper"]
        assert b["lower"] <= a["upper"]


@pytest.mark.parametrize(
    ("misfit", "widths", "words"),
    [
        ([1e-3, 9e-3], [1e-2] * 4, r"largest near \(0\.6"),
        ([1e-9, 9e-9], [1e-2] * 4, "rounding sets the limit"),
        ([1.0, 1.0], [1e-2] * 4, "a gap above"),
        (None, [1e-2] * 4, "still move"),
        ([1e-3, 9e-3], [1e-2, 1e-2, 1e-2, np.inf], "no intervals"),
        ([1e-3, 9e-3], [8e-2, 4e-2, 2e-2, 1e-2], "^$"),
        ([1e-3, 9e-3], [1e-2] * 3, "^$"),
    ],
)
def test_why_finer_meshes_gain_nothing_is_what_holds(misfit, widths, words):
    """Rounding where little of the width comes from the mesh; else where most of it comes from."""
    mesh = ks.Mesh.from_arrays(np.array([[0, 0], [1, 0], [1, 1.0], [0, 1]]), np.array([[0, 2, 3], [0, 1, 2]]))
    structure = SimpleNamespace(space=mesh)
    stage = Stage(SimpleNamespace(structure=structure), None, None, None)
    known = Known([], misfit=None if misfit is None else np.array(misfit))
    assert re.search(words, _stalled(widths, stage, known))
