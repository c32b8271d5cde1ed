"""What the shape of a mesh adds to intervals of frequencies and buckling factors, which are those of the shape taken.

Curved edges of plates are known by their nodes, off by delta: an eigenvalue changes by about 4 delta / R where an edge
has the radius R, as that of a disk that grows. The root of the mean square along all curved edges is taken, since modes
move most where edges bend most. Shells: the shares of their triangles, weighted with the energy of each mode; finer
meshes of quadratic triangles without a geometry see the angles between these, as static ones do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.followed import Followed
from kshell.analysis.interval import Interval, Known
from kshell.equilibrium.model import Model
from kshell.error.curve_doubt import curve_doubt, polygon_share, turns
from kshell.error.plates import GROWTH
from kshell.plate.domain import Domain
from kshell.plate.model import PlateModel

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Shape:
    """The shape that the first mesh tells.

    Attributes
    ----------
    follows : bool
        Whether finer meshes follow curved edges of the first one.
    frozen : (mode,) array
        Share that finer meshes keep; of modes beyond its last one that of the last.
    cut : (mode,) array
        The same of meshes of more triangles than ``triangles``, which see the angles between quadratic ones.
    """

    follows: bool
    frozen: Floats
    cut: Floats
    triangles: int = 0

    @classmethod
    def of(cls, model: Model, vectors: Floats, known: bool, followed: Followed | None = None) -> Shape:
        """Of the first mesh.

        Parameters
        ----------
        vectors : (free, mode)
            Modes on it.
        known : bool
            Whether new nodes lie on the true shape.
        followed : Followed, optional
            Its curved edges, which finer meshes follow.
        """
        if followed is not None:
            edges = np.array([share_of_edges(followed.first)])
            return cls(True, edges, edges)
        triangles = len(model.structure.space.triangles)
        if known:
            return cls(False, np.zeros(1), np.zeros(1), triangles)
        frozen = _own(model, vectors)
        return cls(False, frozen, np.maximum(frozen, _own(model, vectors, cut=True)), triangles)

    def widened(self, known: Known, model: Model, vectors: Floats, followed: Followed | None = None) -> Known:
        """Estimated intervals with what the shape adds, on the first mesh or a finer one with edges that follow it."""
        kinds = {i.kind for i in known.of}
        if "estimated" not in kinds:
            return replace(known, shape=0.0) if "guaranteed" in kinds else known
        share = self._share(model, vectors, followed).tolist()
        of = [_wider(i, s) for i, s in zip(known.of, share, strict=False)]
        return replace(known, of=of, shape=share[0])

    def limits(self, tolerance: float, width: float | None) -> str:
        """Why finer meshes do not reach a tolerance, in words; empty while a width without the shape is large."""
        frozen = float(self.cut.max(initial=0.0))
        if 2.0 * frozen <= tolerance or width is None or width > frozen:
            return ""
        cure = (
            "give its geometry, or a chart"
            if not self.follows
            else "begin with more nodes along its curved edges"
        )
        return f"the shape of the mesh is known to {frozen:.1e} only, and refining adds nothing: {cure}"

    def _share(self, model: Model, vectors: Floats, followed: Followed | None) -> Floats:
        """(mode,) relative."""
        if followed is None:
            own = _own(model, vectors)
            kept = self.cut if len(model.structure.space.triangles) > self.triangles else self.frozen
            if len(kept) == 0:
                return own
            return np.maximum(own, kept[np.minimum(np.arange(len(own)), len(kept) - 1)])
        domain = _domain(model)
        missed = share_of_edges(domain, followed.missed(domain))
        return np.full(vectors.shape[1], float(self.frozen[0]) + missed)


def share_of_edges(domain: Domain, off: Floats | None = None) -> float:
    """Relative change of an eigenvalue where curved edges are off.

    Parameters
    ----------
    off : (edge,) array, optional
        By how much, of `Domain.curves`; the `curve_doubt` if absent.
    """
    curves = domain.curves
    if not curves.curved.any():
        return 0.0
    length = domain.mesh.edge_lengths[curves.edges]
    polygon = polygon_share(domain) if off is None else 0.0
    off = curve_doubt(domain) if off is None else off
    relative = GROWTH * off * turns(curves) / length  # turn over length is the curvature
    return polygon + float(np.sqrt((relative**2 * length).sum() / length.sum()))


def _domain(model: Model) -> Domain:
    if isinstance(model, PlateModel) and model.element == "argyris":
        return model.problem.domain
    return Domain(model.structure.space, True)


def _own(model: Model, vectors: Floats, cut: bool = False) -> Floats:
    """(mode,) of a mesh by itself, or of one whose triangles are parts of its own."""
    from kshell.error import shells
    from kshell.shell.koiter.model import KoiterModel

    if model.kind == "plate":
        return np.full(vectors.shape[1], share_of_edges(_domain(model)))
    if not isinstance(model, KoiterModel):
        return np.zeros(vectors.shape[1])
    strain = model.problem.energy.linear_strain
    share = shells.share_when_cut if cut else shells.geometry_share
    return np.array([share(model, strain(x)) for x in model.expand(vectors).T])


def _wider(interval: Interval, share: float) -> Interval:
    if interval.kind != "estimated" or interval.lower is None or interval.upper is None:
        return interval
    more = share * max(abs(interval.lower), abs(interval.upper))
    return Interval(interval.lower - more, interval.upper + more, "estimated")
