"""Values of shells at many points at once."""

import warnings

import numpy as np

import kshell as ks
from tests.shell.shell_scenes import MESHES


def test_many_points_have_the_values_of_each():
    """Inside triangles, at vertices and on folds, where two sheets meet."""
    scene = ks.Scene.load(MESHES / "box_girder.toml")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = ks.solve(scene, large_deflection=False, error="off")
    mesh = result.mesh
    random = np.random.default_rng(0)
    corners = mesh.points[mesh.triangles[random.integers(0, len(mesh.triangles), 40)]]
    inside = (random.dirichlet([1, 1, 1], 40)[:, :, None] * corners).sum(axis=1)
    points = np.concatenate([inside, mesh.points[::25], mesh.points[mesh.edges[::60]].mean(axis=1)])
    assert result.rows.extra
    together = result.at(points)
    alone = [result.at(point[None]) for point in points]
    assert together.pop("distance").max() < 1e-12 * mesh.size
    for name, values in together.items():
        each = np.concatenate([one[name] for one in alone])
        np.testing.assert_allclose(values, each, atol=1e-10 * np.abs(each).max(), err_msg=name)
