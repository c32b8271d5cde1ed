"""Points on edges and at vertices: values do not depend on which of their triangles they are found in."""

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.mesh import Mesh
from tests.plate.plates import UNIT, disk, rectangle

ELEMENTS = [
    {"element": "argyris"},
    {"element": "morley"},
    {"element": "hhj", "order": 1},
    {"element": "hhj", "order": 3},
]
BASE = rectangle(4, 3, wobble=0.3)
INNER = np.flatnonzero(BASE.edge_counts == 2)
PLACES = {
    **{f"edge {e}": BASE.points[BASE.edges[e]].mean(axis=0) for e in INNER[::5].tolist()},
    "vertex": BASE.points[8],
    "corner": BASE.points[0],
    "inside": BASE.points[BASE.triangles[7]].mean(axis=0),
}


def probed(options, turn, size, numbering):
    """Probes of a turned plate of another size and numbering, in the axes and units of the plate as it was."""
    c, s = np.cos(turn), np.sin(turn)
    r = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    triangles = np.random.default_rng(numbering).permutation(BASE.triangles)
    named = {name: BASE.edges[group.members] for name, group in BASE.groups.items() if group.dimension == 1}
    scene = ks.Scene(
        Mesh.from_arrays(size * BASE.points @ r.T, triangles, named),
        thickness=size,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("left"), ks.SimplySupported("bottom")],
        loads=[ks.PointMoment(tuple(size * r @ BASE.points[8]), tuple(size**3 * r @ [1.0, 0.3, 0.0]))],
        probes={name: tuple(size * r @ place) for name, place in PLACES.items()},
    )
    result = ks.solve(scene, model="plate", large_deflection=False, **options)
    out = {}
    for name in PLACES:
        probe, known = result.probe(name), result.error["probes"].get(name)
        xx, yy, xy = probe["M"]
        moment = r[:2, :2].T @ np.array([[xx, xy], [xy, yy]]) @ r[:2, :2]
        parts = [probe["u"][2:] / size, r.T @ probe["rotation"], moment.ravel() / size**2]
        parts.append(r[:2, :2].T @ probe["Q"] / size)
        parts.append([0.0 if known is None else known["u"]["half_width"][2] / size])
        out[name] = np.concatenate(parts)
    return out


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("options", ELEMENTS, ids=str)
def test_values_do_not_depend_on_axes_units_and_numbering(options):
    reference = probed(options, 0.0, 1.0, 0)
    largest = np.abs(list(reference.values())).max(axis=0)
    for turn, size, numbering in ((0.7, 1.0, 1), (2.1, 1e-2, 2), (np.pi, 1e2, 3)):
        for name, values in probed(options, turn, size, numbering).items():
            assert values == pytest.approx(reference[name], abs=1e-7 * largest.max(), rel=1e-6), name


@pytest.mark.parametrize("options", ELEMENTS, ids=str)
def test_at_vertices_probes_are_the_fields_there(options):
    scene = ks.Scene(
        BASE,
        thickness=1.0,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("left")],
        loads=[ks.Pressure(1.0)],
    )
    result = ks.solve(scene, model="plate", large_deflection=False, error="off", **options)
    found = result.at(BASE.points)
    for key, field in (("u", "displacement"), ("rotation", "rotation"), ("M", "moment"), ("Q", "shear")):
        assert found[key] == pytest.approx(result.fields[field], abs=1e-9 * np.abs(found[key]).max()), key


def jumping(x, y, z):
    return np.where(x + 0.3 * y > 0.3, 1.0, 0.0)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("mesh", [BASE, disk(3), disk(3, 2)], ids=["straight", "chords", "curved"])
@pytest.mark.parametrize("order", [1, 2, 3, 7])
@pytest.mark.parametrize("load", ["pressure", "line"])
def test_what_jumps_is_balanced_by_the_points_it_is_integrated_at(mesh, order, load):
    on = "top" if mesh is BASE else "edge"
    clamped = [ks.Clamped("left")] if mesh is BASE else []
    supports = [*clamped, ks.Elastic(on, 1.0, "z")]
    loads = {
        "pressure": ks.Pressure(jumping),
        "line": ks.LineForce(on, lambda x, y, z: [0.0 * x, 0.0 * x, jumping(x, y, z)]),
    }
    scene = ks.Scene(
        mesh, thickness=1.0, material=ks.Isotropic(**UNIT), supports=supports, loads=[loads[load]]
    )
    options = {"element": "hhj", "order": order, "error": "off"}
    result = ks.solve(scene, model="plate", large_deflection=False, **options)
    assert result.balance < 1e-11
