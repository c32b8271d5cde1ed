"""What `on` may be, and what is said when it cannot be that."""

from __future__ import annotations

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import Group, Mesh, read_mesh, select
from tests.mesh.mesh_samples import msh2_text, square


@pytest.fixture(scope="module")
def mesh():
    return square(4)


@pytest.mark.parametrize(
    ("name", "dimension", "number"), [("plate", 2, 32), ("bottom", 1, 4), ("origin", 0, 1)]
)
def test_a_name(mesh, name, dimension, number):
    found = select(mesh, name)
    assert (found.dimension, len(found.members), found.label) == (dimension, number, name)
    assert found.warning is None


def test_a_list_is_a_union(mesh):
    found = select(mesh, ["bottom", "two sides", "left"])
    assert len(found.members) == 8
    assert (np.diff(found.members) > 0).all()
    assert found.label == "bottom, two sides, left"


@pytest.mark.parametrize(
    "point", [(0.5, 0.25), [0.5, 0.25, 0.0], np.array([0.5, 0.25, 0.0]), (0.5, 0.25, 1e-9)]
)
def test_a_point_on_a_vertex(mesh, point):
    found = select(mesh, point)
    np.testing.assert_array_equal(mesh.points[found.members], [[0.5, 0.25, 0.0]])
    assert found.dimension == 0
    assert found.warning is None


def test_a_point_off_the_vertices(mesh):
    found = select(mesh, (0.3, 0.25), what="point force")
    np.testing.assert_array_equal(mesh.points[found.members], [[0.25, 0.25, 0.0]])
    assert found.distance == pytest.approx(0.05)
    assert found.warning.startswith(
        "point force at (0.3, 0.25): no vertex there; the nearest one, (0.25, 0.25), 0.05 away"
    )


WRONG = {
    "unknown": (
        "botom",
        {},
        r"no group 'botom' in mesh\. Did you mean 'bottom'\? Groups there: 'plate' \(surface\), 'lower'",
    ),
    "case": ("Bottom", {}, "Did you mean 'bottom'"),
    "far off": ("xyzzy", {}, r"no group 'xyzzy' in mesh\. Groups there"),
    "kind": (
        "plate",
        {"dimensions": (1,)},
        "'plate' is a surface group, but a curve is needed.*'bottom', 'left', 'two sides'",
    ),
    "kinds": ("plate", {"dimensions": (0, 1)}, "but a point or curve is needed"),
    "mixed list": (
        ["bottom", "plate"],
        {},
        "of one kind, but 'bottom' is a curve group, 'plate' is a surface group",
    ),
    "mixed types": (["bottom", 3.0], {}, "mixes names and numbers"),
    "empty list": ([], {}, "empty list"),
    "one number": ([0.5], {}, "is no point"),
    "four numbers": ([0, 0, 0, 0], {}, "is no point"),
    "nan": ([0.0, float("nan"), 0.0], {}, "is no point"),
    "no number": ([None, None], {}, "is no point"),
    "point for a curve": (
        (0, 0),
        {"dimensions": (1,)},
        r"the point \(0, 0\) is given, but a curve group is needed",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_words(mesh, case):
    on, options, message = WRONG[case]
    with pytest.raises(InputError, match=message) as caught:
        select(mesh, on, what="clamped", **options)
    assert str(caught.value).startswith("clamped: ")


def test_no_groups_at_all():
    mesh = Mesh.from_arrays([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    with pytest.raises(InputError, match=r"has no groups: name parts of it.*Physical Curve"):
        select(mesh, "left")


def test_an_empty_group(mesh):
    groups = {**mesh.groups, "nothing": Group(1, np.empty(0, np.int32))}
    with pytest.raises(InputError, match="group 'nothing' in mesh is empty"):
        select(Mesh(mesh.points, mesh.triangles, groups=groups), "nothing")


@pytest.fixture
def shared_names(tmp_path):
    """ "rim" names a curve and a surface, tags 5 and 1."""
    names = '$PhysicalNames\n3\n1 5 "rim"\n2 1 "rim"\n1 6 "other"\n$EndPhysicalNames\n'
    path = tmp_path / "names.msh"
    path.write_text(
        msh2_text([(0, 0, 0), (1, 0, 0), (0, 1, 0)], ["2 1 1 2 3", "1 5 1 2", "1 6 2 3"], names),
        encoding="utf-8",
    )
    return read_mesh(path)


def test_a_shared_name_means_the_kind_that_is_needed(shared_names):
    assert select(shared_names, "rim", dimensions=(1,)).dimension == 1
    assert select(shared_names, "rim", dimensions=(0, 2)).dimension == 2
    assert select(shared_names, "rim (surface)").dimension == 2
    with pytest.raises(
        InputError, match=r"several groups: say which one of 'rim \(curve\)', 'rim \(surface\)'"
    ):
        select(shared_names, "rim")


def test_dimension_and_tag(shared_names):
    assert select(shared_names, "1:6").members.tolist() == select(shared_names, "other").members.tolist()
    assert select(shared_names, "2:1").dimension == 2
    with pytest.raises(InputError, match="no group '1:9'"):
        select(shared_names, "1:9")
