"""Every case with every element: values within what is allowed, balance, energy, and no warnings but the expected
ones. Plates on all their meshes, shells once with each element and degree; their finer meshes in the full run."""

import json

import pytest

import kshell as ks
from kshell.verify.cases import all_cases, find
from kshell.verify.cases.case import HERE
from kshell.verify.cases.collected import collected

SHELLS = ("shell", "gmsh", "large")
RUNS = [
    pytest.param(
        one,
        run,
        id=f"{one.id}-{run.name}",
        marks=pytest.mark.full if one.family in SHELLS and run not in one.quick_runs else (),
    )
    for one in all_cases()
    for run in one.runs
]
UNBALANCED = 1e-6
# Argyris elements on a chart know rigid rotations up to their interpolation only
UNBALANCED_ON_CHART = 2e-3
# bending is 1e10 times softer than stretching there: with SuperLU a few more digits are lost, and said to be
VERY_THIN, UNBALANCED_VERY_THIN = "shell.quarter_circle.t1e-05", 1e-5
# the iteration stops by work, at 1e-13 of the load's: forces that do little of it may be off by the root
UNBALANCED_LARGE = 1e-5
EXPECTED_WARNINGS = (
    "moments grow without bound",
    "stresses grow without bound",
    "flat triangles were curved",
    "the mesh has flat triangles (order 1) on a curved surface",
    "membrane locking",
    "a cluster: each of its shapes",
    "planes of symmetry hold the motion",
    "beyond any linear theory",  # unit loads on unit moduli
    "more than any material bears",
    "too thick for this theory",  # NAFEMS FV22, which says by how much
    "the load passes a limit point",  # shells that snap through, beyond which the references lie
    "that none was missed is not checked",  # where no back end that counts eigenvalues is installed
)


@pytest.mark.parametrize(("case", "run"), RUNS)
def test_case(case, run):
    result = case.solve(run)
    wrong = [
        f"{one.quantity} = {one.value:.10g}, reference {one.reference:.10g}: error {one.error:.2e} > {one.allowed:.2e}"
        for one in case.compare(run, result)
        if not one.passed
    ]
    assert not wrong, "\n".join(wrong)
    on_chart = run.element == "argyris" and case.family in SHELLS
    unbalanced = UNBALANCED_VERY_THIN if case.id == VERY_THIN else UNBALANCED
    if case.family == "large":
        unbalanced = UNBALANCED_LARGE
    assert result.balance < (UNBALANCED_ON_CHART if on_chart else unbalanced)
    said = any("loads and reactions differ" in warning for warning in result.warnings)
    assert said == (result.balance > UNBALANCED)
    # nothing moves by itself: the loads do as much work as is stored, but heat stores energy without any
    # and large deflections store less than the final load times the way
    heated = any(isinstance(load, ks.Temperature) for load in result.scene.loads)
    if not heated and not result.model["large_deflection"]:
        assert result.strain_energy == pytest.approx(result.external_work, rel=1e-7)
    if not on_chart and case.id != VERY_THIN:
        known = EXPECTED_WARNINGS + (("loads and reactions differ",) if case.family == "large" else ())
        unexpected = [w for w in result.warnings if not any(words in w for words in known)]
        assert unexpected == []


def test_every_quantity_has_a_reference_and_an_allowance():
    for case in all_cases():
        for run in case.runs:
            names = {name for name, quantity in case.quantities.items() if run.element in quantity.elements}
            assert set(case.allowed[run.name]) == names, f"{case.id} {run.name}"
        assert set(case.quantities) == set(case.references)
        assert set(case.most_unknowns) == {run.name for run in case.runs}
        assert all(reference.uncertainty < 1e-2 for reference in case.references.values())


def test_enough_cases():
    ids = [case.id for case in all_cases()]
    assert len(set(ids)) == len(ids) >= 183
    for case in all_cases():
        methods = {run.method for run in case.runs}
        if case.family in SHELLS:
            assert "koiter3" in methods
        elif (
            case.id != "buckling.strip.tip"
        ):  # held against turning at a point, which Morley elements are not
            assert methods >= {"argyris", "morley"}


def test_no_reference_is_left_out_silently():
    ids = {case.id for case in all_cases()}
    for one in collected():
        assert set(one.cases) <= ids
        assert bool(one.cases) != bool(one.reason), one.id
    recorded = json.loads((HERE / "references.json").read_text(encoding="utf-8"))
    assert set(recorded) == {case.like for case in all_cases()}
    assert set(json.loads((HERE / "allowed.json").read_text(encoding="utf-8"))) == ids


@pytest.mark.parametrize("sides", [8, 12])
def test_polygons_do_not_tend_to_the_disk(sides):
    """Simply supported: the corners of a polygon hold it stiffer than a circle, whose mesh has sides, too."""
    polygon, disk = find(f"polygon.ss.{sides}"), find("disk.ss.uniform")
    of_polygon = polygon.quantities["w_c"].of(polygon.solve(polygon.runs[0]))
    ring = next(run for run in disk.runs if run.name == "argyris-4")
    of_disk = disk.quantities["w_c"].of(disk.solve(ring))  # 24 straight mesh edges around
    assert of_polygon == pytest.approx(polygon.references["w_c"].value, rel=5e-3)
    assert of_disk == pytest.approx(disk.references["w_c"].value, rel=1e-4)
    assert of_polygon < 0.7 * of_disk


@pytest.mark.parametrize(
    "id",
    ["ssss.uniform.ba1", "clamped.uniform.ba1", "clamped.point.ba1", "disk.ss.uniform", "annulus.FC.q.b0.2"],
)
@pytest.mark.parametrize("element", ["argyris", "morley"])
def test_quarters_store_a_quarter(id, element):
    """Compliance and reactions of a quarter between planes of symmetry, four times, against the whole plate."""
    whole, quarter = find(id), find(f"{id}.quarter")
    of_whole, of_quarter = (
        case.solve(next(run for run in case.runs if run.element == element)) for case in (whole, quarter)
    )
    close = 5e-4 if element == "argyris" else 0.02
    assert 4 * of_quarter.strain_energy == pytest.approx(of_whole.strain_energy, rel=close)
    area = 1e-5 if element == "argyris" else 1e-3  # Morley's plate ends at the chords of curved edges
    total = [sum(group["force"][2] for group in r.reactions.values()) for r in (of_whole, of_quarter)]
    assert 4 * total[1] == pytest.approx(total[0], rel=area)
