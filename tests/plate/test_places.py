"""Points of a plate, one by one and together."""

import numpy as np

from kshell.plate.domain import Domain
from kshell.plate.points import PlatePoints
from tests.plate.plates import disk


def test_points_are_found_alike_alone_together_and_again():
    """Inside, at vertices, between chords and the curved edge, and beside the plate; what is given may be changed."""
    domain = Domain(disk(3), curved=True)
    points = np.array([[0.1, 0.2], [0.0, 0.0], [np.cos(0.13), np.sin(0.13)], [2.0, 1.0], [0.1, 0.2]])
    together = PlatePoints(domain).find(points)
    own = PlatePoints(domain)
    own.find(points[1:3]).xi[:] = np.nan
    for k, point in enumerate(points):
        for places in (own, PlatePoints(domain)):
            found = places.find(point[None])
            for name in ("triangles", "xi", "xy", "distance"):
                assert np.array_equal(getattr(found, name), getattr(together, name)[k : k + 1])
    assert len(own.find(points[:0]).triangles) == 0
