"""What every model must keep: the frame that analyses stand on, for the plate, the Koiter shell and the chart."""

import numpy as np
import pytest

import kshell as ks
from kshell.analysis.models import build_model, model_of
from kshell.equilibrium.bifurcation import buckling_modes
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.linear import LinearSolver
from kshell.scene.loads import Load, Traction
from kshell.scene.structure import resolve
from tests.plate.plates import disk, rectangle

MATERIAL = ks.Isotropic(E=1e4, nu=0.3, density=2.0)
HELD = [ks.Clamped("left"), ks.Elastic("right", 3.0), ks.Fixed("top", "z", value="0.01*x**2")]
LOADS = [
    ks.Pressure("1 + x"),
    ks.LineForce("right", (0, 0, 2.0)),
    ks.PointForce((1, 1, 0), (0, 0, 0.5)),
    ks.Gravity((0, 0, -9.81)),
    ks.Temperature(gradient=2.0, expansion=1e-3),
]


def scene(**changes):
    given = {"mesh": rectangle(3), "thickness": 0.1, "material": MATERIAL, "supports": HELD, "loads": LOADS}
    return ks.Scene(**{**given, **changes})


def on_chart(**changes):
    held = [ks.Clamped("left", value=(0, 0, 0.01)), ks.Elastic("right", 3.0)]
    corner = (2 * np.cos(1), 2 * np.sin(1), 0.0)
    loads = [ks.PointForce(corner, load.value) if isinstance(load, ks.PointForce) else load for load in LOADS]
    return scene(**{"chart": ks.geometry.Cylinder(R=2.0), "supports": held, "loads": loads, **changes})


MODELS = {
    "morley": lambda **changes: model_of(scene(**changes), element="morley"),
    "argyris": lambda **changes: model_of(scene(**changes), element="argyris"),
    "rim": lambda **changes: model_of(
        scene(
            **{
                "mesh": disk(3, 2),
                "supports": [ks.Clamped("edge", value=(0, 0, 0.02))],
                "loads": [ks.Pressure(1.0), ks.InitialCurvature((0.1, 0, 0))],
                **changes,
            }
        )
    ),
    "koiter": lambda **changes: model_of(scene(**changes), model="shell", order=2),
    "chart": lambda **changes: model_of(on_chart(**changes), element="argyris"),
}
every_model = pytest.mark.parametrize("make", MODELS.values(), ids=MODELS)


@every_model
def test_vectors_of_the_loads_add_up_to_the_solution(make):
    model = make()
    f, count = model.load_vectors(), len(model.structure.loads)
    assert f.shape == (count, model.unknowns)
    q = np.linalg.solve(model.stiffness().toarray(), f.sum(axis=0))
    alone = model.under([0.0] * count).solve().x  # of the prescribed motion
    found = model.solve().x - alone
    assert model.expand(q) == pytest.approx(found, abs=1e-6 * np.abs(found).max())


@pytest.mark.parametrize("name", ["morley", "koiter", "chart"])
def test_vector_of_the_prescribed_motion(name):
    model = MODELS[name]()
    x = model.under([0.0] * len(LOADS)).solve().x
    columns = model.expand(
        np.eye(model.unknowns)
    )  # those of these models are orthogonal to the prescribed motion
    q = np.linalg.lstsq(columns, x, rcond=None)[0]
    g = model.motion_vector()
    assert model.stiffness() @ q == pytest.approx(g, abs=1e-6 * np.abs(g).max())


@every_model
def test_product_through_strains_is_that_of_the_matrix(make):
    model = make()
    q = np.random.default_rng(0).standard_normal(model.unknowns)
    expected = model.stiffness() @ q
    assert model.product()(q) == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


@every_model
def test_loads_and_motion_times_factors_superpose(make):
    model = make()
    count = len(model.structure.loads)
    factors = np.arange(1.0, count + 1.0)
    whole = model.under(factors, -0.5)
    total = whole.solve().x
    parts = [model.under(np.eye(count)[k], 0.0).solve().x for k in range(count)]
    expected = factors @ np.array(parts) - 0.5 * model.under(np.zeros(count)).solve().x
    assert total == pytest.approx(expected, abs=1e-7 * np.abs(total).max())
    once, twice = model.recover(model.solve()), model.under([2.0] * count, 2.0)
    double = twice.recover(twice.solve())
    assert double.strain_energy == pytest.approx(4.0 * once.strain_energy, rel=1e-6)
    assert double.external_work == pytest.approx(4.0 * once.external_work, rel=1e-6)
    assert double.balance < 1e-6
    for name, reaction in once.reactions.items():
        force = double.reactions[name]["force"]
        assert force == pytest.approx(2.0 * reaction["force"], abs=1e-5 * np.abs(force).max() + 1e-9)
    peak = np.abs(double.fields["moment"]).max()
    assert double.fields["moment"] == pytest.approx(2.0 * once.fields["moment"], abs=1e-6 * peak)


def test_one_factorisation_serves_all_loads(monkeypatch):
    made = []
    first = LinearSolver.__init__

    def counted(self, *arguments):
        made.append(self)
        first(self, *arguments)

    monkeypatch.setattr(LinearSolver, "__init__", counted)
    model = MODELS["koiter"]()
    for k in range(len(LOADS)):
        model.under(np.eye(len(LOADS))[k]).solve()
    assert len(made) == 1


@pytest.mark.parametrize("name", ["argyris", "morley", "koiter", "chart"])
def test_mass_moves_as_a_whole(name):
    model = MODELS[name](supports=[ks.Elastic("plate", 1.0, "xyz")], loads=[])
    if isinstance(model, FiniteModel):
        mass = model.full_mass()
        lift = model.problem.discretisation.rigid_motions(np.zeros(3), 1.0)[:, 2]
        area = 1.0 if name == "koiter" else 2.0  # a cylinder of radius 2 over one radian and a height of 1
        assert lift @ mass @ lift == pytest.approx(2.0 * 0.1 * area, rel=1e-9)
    matrix = model.mass()
    assert abs(matrix - matrix.T).max() < 1e-12 * abs(matrix).max()
    assert np.linalg.eigvalsh(matrix.toarray())[0] > -1e-12 * abs(matrix).max()


@pytest.mark.parametrize("name", ["argyris", "koiter", "chart"])
def test_without_density_there_is_no_mass(name):
    model = MODELS[name](material=ks.Isotropic(E=1.0, nu=0.0), loads=[])
    with pytest.raises(ks.InputError, match="no density"):
        model.mass()


def test_geometric_stiffness_gives_the_buckling_load():
    pressed = {"supports": [ks.Clamped("left")], "loads": [ks.LineForce("right", (-1.0, 0, 0))]}
    model = MODELS["koiter"](**pressed)
    geometric = model.geometric_stiffness(model.solve()).toarray()
    values = np.linalg.eigvals(np.linalg.solve(model.stiffness().toarray(), -geometric))
    factor = 1.0 / values.real.max()
    (mode,) = buckling_modes(model.equilibrium(), model.problem.load, 1)
    assert factor == pytest.approx(mode.factor, rel=1e-6)
    assert factor == pytest.approx(np.pi**2 / 4 * 1e4 * 0.1**3 / 12, rel=0.1)  # Euler's strut


def test_plates_have_no_membrane_forces_and_say_so():
    model = MODELS["argyris"]()
    with pytest.raises(ks.InputError, match="no membrane forces"):
        model.geometric_stiffness(model.solve())


class Snow(Traction):
    """What `Traction` says, otherwise: found by the class it derives from."""

    kind = "snow"


class Wind(Load):
    """What no model knows."""

    kind = "wind"
    on, value = None, 0.0


@pytest.mark.parametrize("model", ["plate", "shell"])
def test_a_load_that_derives_from_another_needs_no_handler(model):
    values = []
    for load in (Traction((0, 0, -2.0)), Snow((0, 0, -2.0))):
        made = model_of(scene(loads=[load]), model=model)
        values.append(made.solve().x)
    assert np.array_equal(*values)


@pytest.mark.parametrize("model", ["plate", "shell"])
def test_what_a_model_does_not_know_is_refused(model):
    with pytest.raises(ks.InputError, match="load wind everywhere is"):
        model_of(scene(loads=[Wind()]), model=model)


def test_a_structure_is_resolved_once_and_serves_several_models():
    one = scene(probes={"p": (0.5, 0.5, 0)}, supports=[ks.Clamped(["left", "top"])])
    structure = resolve(one, one.read_mesh())
    assert [placed.place.label for placed in structure.supports] == ["left", "top"]
    assert len(structure.loads) == len(LOADS)
    kinds = [
        build_model(structure, one.solve.updated(model=kind, large_deflection=False)).kind
        for kind in ("plate", "shell")
    ]
    assert kinds == ["plate", "shell"]


def test_thickness_on_a_chart_counts_at_points_in_space():
    # x^2 + y^2 + z^2 is at most 2 on the parameters, at least 4 on the cylinder
    thin = on_chart(thickness="x**2 + y**2 + z**2 - 3.9")
    assert model_of(thin).element == "argyris"
