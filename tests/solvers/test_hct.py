"""The reduced HCT triangle: exact for quadratics, C1 across edges."""

import numpy as np

from kshell.solvers.multigrid.hct import interpolation_weights


def test_hct_reproduces_quadratics_and_is_continuous():
    rng = np.random.default_rng(1)
    corners = np.array([[0, 0], [1, 0.1], [0.3, 0.9]]) + rng.uniform(-0.1, 0.1, (200, 3, 2))
    points = np.einsum("nc,ncx->nx", rng.dirichlet(np.ones(3), 200), corners)

    def quadratic(p):
        x, y = p[..., 0], p[..., 1]
        return np.stack([1 + x - 2 * y + 3 * x * x - x * y + y * y, 1 + 6 * x - y, -2 - x + 2 * y], axis=-1)

    found = np.einsum("ncrk,nck->nr", interpolation_weights(points, corners), quadratic(corners))
    assert np.allclose(found, quadratic(points), atol=1e-12)

    # two triangles that share an edge: value and gradient agree along it, whatever the freedoms
    left = np.array([[0.0, 0.0], [1.0, 0.2], [-0.3, 1.0]])
    right = np.array([[1.0, 0.2], [-0.3, 1.0], [1.4, 1.3]])
    freedoms = rng.standard_normal((4, 3))
    s = np.linspace(0.03, 0.97, 15)[:, None]
    edge = (1 - s) * left[1] + s * left[2]
    values = [
        np.einsum("ncrk,ck->nr", interpolation_weights(edge, np.tile(t, (15, 1, 1))), freedoms[ids])
        for t, ids in ((left, [0, 1, 2]), (right, [1, 2, 3]))
    ]
    assert np.allclose(*values, atol=1e-10)
