"""The gallery of failures: each fails as it says, and kshell does what it says about it."""

import matplotlib as mpl
import numpy as np
import pytest

import kshell as ks
from kshell.verify.cases import find, meshes
from kshell.verify.cases.plate import plate
from verification.failures import (
    GALLERY,
    conditioning,
    corners,
    curved_support,
    discrete_curvature,
    measured,
    point_supports,
)
from verification.failures.failure import MOST_COLUMNS, deflection, solved, square, text_table
from verification.failures.thin_triangles import caps, needles
from verification.peers import scikit_fem

mpl.use("Agg")
pytestmark = pytest.mark.full  # the whole gallery is measured


@pytest.fixture
def numbers():
    """Of an entry, in the quick setting, measured once for all tests."""
    return lambda id: measured(id, True)


@pytest.mark.parametrize("id", GALLERY)
def test_every_entry_has_words_numbers_and_a_picture(id, numbers):
    entry = GALLERY[id]
    assert entry.id == id
    assert len(entry.what) > 100
    assert len(entry.kshell) > 100
    figure = entry.draw(numbers(id))
    assert figure.axes[0].get_title()
    table = text_table(numbers(id))
    rows = len(next(iter(numbers(id).values())))
    assert table.count("\n") == (rows if len(numbers(id)) <= MOST_COLUMNS else len(numbers(id)) - 1)
    mpl.pyplot.close(figure)


def test_bare_quintics_are_lost_far_from_the_origin_and_kshell_is_not(numbers):
    found = numbers("origin")
    far = found["shift"] >= 1e3
    assert not (found["scikit-fem alone"][far] < 1).any()
    assert np.ptp(found["kshell"]) < 1e-3 * found["kshell"].max() < 1e-8


def test_chords_lead_to_the_clamped_plate_and_kshell_to_the_disk(numbers):
    found = numbers("curved_support")
    chords = found["chords held (scikit-fem)"]
    assert (np.diff(chords) < 0).all()
    assert chords[-1] == pytest.approx(curved_support.CLAMPED, rel=0.07)
    errors = curved_support.off_by(found)
    assert abs(errors["kshell argyris"]) < 1e-6
    assert 0 < errors["kshell morley"] < 0.02


def test_true_polygons_tend_to_another_plate_than_the_disk():
    """Extrapolated with an error like 1 / sides^2 the deflections tend to 3 / 64, not to 0.0637."""
    exact = {n: find(f"polygon.ss.{n}").references["w_c"].value for n in (6, 8, 12)}
    ours = {
        n: deflection(solved(meshes.regular_polygon(n, 4, 12), {"edge": "S"}, "argyris"), 0.0, 0.0)
        for n in (6, 8)
    }
    for sides, found in ours.items():
        assert found == pytest.approx(exact[sides], rel=1e-3)
    assert (64 * ours[8] - 36 * ours[6]) / 28 == pytest.approx(curved_support.POLYGONS, rel=0.03)
    assert (144 * exact[12] - 64 * exact[8]) / 80 == pytest.approx(curved_support.POLYGONS, rel=6e-3)
    assert curved_support.POLYGONS < 0.74 * curved_support.DISK


def test_thin_triangles_cost_digits_and_the_last_ones_are_refused(numbers):
    found = numbers("thin_triangles")
    good, bad = 1, 2  # aspects 100 and 1e4
    for family in ("needles", "caps"):
        assert found[f"{family} argyris w"][good] < 4e-6
        assert found[f"{family} argyris balance"][good] > 1e3 * found[f"{family} argyris balance"][0]
        assert np.isnan(found[f"{family} argyris w"][bad])
    with pytest.raises(ks.SolveError, match="singular"):
        solved(square(*caps(8, 1e4)), {"edge": "C"}, "argyris")
    with pytest.warns(ks.KshellWarning, match="look for very small or very thin triangles"):
        ks.solve(plate(square(*needles(24, 1e4)), {"edge": "C"}, [ks.Pressure(1.0)]), element="morley")


def test_corners_take_the_rate_and_layers_give_digits_back(numbers):
    found = numbers("corners")
    rates = corners.rates(found)
    assert rates["skew, without layers"] == pytest.approx(0.4, abs=0.1)
    assert rates["L-shape, without layers"] == pytest.approx(1.09, abs=0.1)
    for name in ("skew", "L-shape"):
        assert found[f"{name}, with layers"][-1] < 0.02 * found[f"{name}, without layers"][-1]
    with pytest.warns(ks.KshellWarning, match="150 degrees"):
        ks.solve(plate(meshes.rhombus(30, 4), {"edge": "S"}, [ks.Pressure(1.0)]))


def test_poissons_ratio_near_its_limits(numbers):
    found = numbers("poisson")
    closest = -1  # 1e-9 from the limit
    assert found["1/2 textbook stiffness"][closest] > 1e-9
    assert found["1/2 kshell stiffness"].max() < 1e-15
    assert found["1/2 kshell disk"].max() < 1e-6
    assert found["-1 kshell disk"][0] < 1e-6 < 1e-4 < found["-1 kshell disk"][closest] < 0.1
    for nu in (0.5, -1.0):
        with pytest.raises(ks.InputError, match="nu"):
            ks.Isotropic(E=1.0, nu=nu)


def test_fine_meshes_lose_digits_without_refinement_through_strains(numbers):
    found = numbers("conditioning")
    assert found["kshell"][-1] < 1e-8
    case = conditioning.find(conditioning.CASE)
    exact = case.references["w_c"].value
    scene = case.build(64, 1)
    once = abs(conditioning.factorised_once(scene) / exact - 1)
    refined = abs(ks.solve(scene, element="argyris").at((0.5, 0.5, 0.0))["u"][0, 2] / exact - 1)
    assert refined < 1e-10
    assert once > 2 * refined


def test_over_a_point_support_forces_converge_and_moments_grow(numbers):
    found = numbers("point_supports")
    for name in ("force, error", "compliance, error"):
        assert np.log2(found[name][:-1] / found[name][1:]) == pytest.approx(2, abs=0.1)
    grows = -point_supports.exact_force() * 1.3 / (4 * np.pi) * np.log(2)
    assert point_supports.growth(found) == pytest.approx(grows, rel=0.02)


def test_angle_defects_stay_wrong_where_fitted_polynomials_converge(numbers):
    gains = discrete_curvature.gains(numbers("discrete_curvature"))
    assert gains["valence 6: K, angle defect"] > 3
    assert gains["valence 4 and 8: K, angle defect"] < 1.2
    assert gains["valence 4 and 8: H, cotangent formula"] < 1.2
    for family in ("valence 6", "valence 4 and 8", "irregular"):
        assert gains[f"{family}: k, fitted polynomial"] > 3


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize("kind", ["clamped", "supported"])
def test_scikit_fem_alone_is_a_fair_peer(element, kind):
    """Near the origin, on straight edges, its answers are those of kshell with the same element."""
    points, triangles = meshes.grid(6, 6)
    bare = scikit_fem.solve(points, triangles, element, kind)
    ours = solved(square(points, triangles), {"edge": {"clamped": "C", "supported": "S"}[kind]}, element)
    values = ours.at((0.5, 0.5, 0.0))
    assert bare.unknowns == ours.unknowns
    assert bare.compliance == pytest.approx(2 * ours.strain_energy, rel=1e-8)
    assert bare.deflection(0.5, 0.5) == pytest.approx(values["u"][0, 2], rel=1e-8)
    if element == "argyris":
        assert bare.moment_xx(0.5, 0.5) == pytest.approx(values["M"][0, 0], rel=1e-6)


def test_averages_see_the_error_of_morley_and_not_of_argyris(numbers):
    found = numbers("averages")
    assert (found["Argyris: averages"] < 0.1 * found["Argyris: error"]).all()
    assert (2.0 * found["Argyris: residuals"] > found["Argyris: error"])[1:].all()
    # the middle of a guaranteed interval is off by no more than its half width
    assert (2.0 * found["Argyris: guaranteed"] > found["Argyris: error"]).all()
    assert (found["Morley: averages"][-1:] > 0.3 * found["Morley: error"][-1:]).all()


def test_the_shape_of_the_first_mesh_stays(numbers):
    found = numbers("frozen_shape")
    assert found["without geometry"][-1] == pytest.approx(found["without geometry"][-2], rel=0.05)
    assert found["on the chart"][-1] < 1e-3 * found["without geometry"][-1]


def test_richardson_is_off_where_bounds_are_not(numbers):
    found = numbers("richardson")
    assert (found["Richardson"] > 100 * found["graded, guaranteed"]).all()
    assert (found["graded, guaranteed"] <= 1e-4).all()


def test_guaranteed_intervals_need_residuals_through_strains(numbers):
    found = numbers("rounding")
    low, high = found["f - K x: from"], found["f - K x: to"]
    assert low.max() > high.min()  # two of them have nothing in common
    low, high = found["through strains: from"], found["through strains: to"]
    assert low.max() <= high.min()
    assert (np.diff(high - low) < 0.0).all()
