"""Values of the elements at points spread over all triangles, for pictures.

At reference points (point, 2), the same in all triangles, there are by the names of fields

position (triangle, point, 3) at rest, displacement (3), moment (3), shear (2), membrane_force (3),
stress_top, stress_middle, stress_bottom (3)

as far as the result has them, each found when it is first looked at, in the frames of fields.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from kshell.elements.lattice import lattice

Floats = NDArray[np.float64]


class Sampled:
    """Values at the points of `kshell.elements.lattice`; those of the latest are kept, for the next picture.

    Parameters
    ----------
    evaluate : callable
        Reference points (point, 2) to fields there.
    """

    def __init__(self, evaluate: Callable[[Floats], Mapping[str, Floats]]) -> None:
        self._evaluate = evaluate
        self._latest: dict[int, Mapping[str, Floats]] = {}

    def at(self, parts: int) -> Mapping[str, Floats]:
        """Fields at the points of triangles whose sides have so many parts."""
        if parts not in self._latest:
            self._latest = {parts: self._evaluate(lattice(parts)[:, 1:])}
        return self._latest[parts]
