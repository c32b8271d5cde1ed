"""Values at a vertex are means over the triangles around it, and few of them are looked at for a few places."""

import numpy as np
import pytest

import kshell as ks


@pytest.fixture(scope="module")
def roof():
    chart = ks.geometry.Chart.from_expressions("25*sin(u)", "v", "25*cos(u)")
    scene = ks.Scene(
        mesh=chart.mesh(8, 8, order=2, u_range=(0, 0.7), v_range=(0, 25)),
        thickness=0.25,
        material=ks.Isotropic(E=4.32e8, nu=0.0),
        supports=[ks.Symmetry(["u0", "v0"]), ks.Fixed("v1", "xz")],
        loads=[ks.Pressure("1+x", name="a")],
        solve={"large_deflection": False, "error": "off"},
    )
    return ks.solve(scene)


def test_near_and_far_agree(roof):
    """The same before fields of the whole shell are known, from a few triangles, as after."""
    points = roof.mesh.points[[0, 7, 40]]
    before = roof.at(points)
    shear = roof.fields["shear"]
    after = roof.at(points)
    for name, values in before.items():
        np.testing.assert_allclose(
            values, after[name], rtol=1e-12, atol=1e-12 * np.abs(values).max(initial=0.0)
        )
    np.testing.assert_allclose(after["Q"], shear[[0, 7, 40]], atol=1e-12 * np.abs(shear).max())
    np.testing.assert_allclose(before["M"], roof.fields["moment"][[0, 7, 40]], atol=1e-10)


def test_few_triangles_are_looked_at(roof, monkeypatch):
    from kshell.shell.vertex_fields import Recovered

    seen = []
    whole = Recovered.tensors
    monkeypatch.setattr(Recovered, "tensors", lambda self, p, t: seen.append(len(t)) or whole(self, p, t))
    again = ks.solve(roof.scene)
    again.at(roof.mesh.points[[40]])
    assert seen
    assert max(seen) < len(roof.mesh.triangles) / 4
