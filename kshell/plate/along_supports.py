"""How the reactions of a plate are distributed along its supports, for `Result.reaction_along`."""

from __future__ import annotations

from collections.abc import Callable, MutableMapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule
from kshell.plate.domain import Domain, EdgePatch
from kshell.plate.forms import EdgeSpring
from kshell.plate.held import HeldGroup, Supports
from kshell.plate.line_forces import POINTS, Lines, union
from kshell.result.along_supports import SAMPLES, AlongSupport, deferred, moment_about_origin

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Forces(Protocol):
    """What an element knows of all supports together; see `kshell.plate.line_forces.LineForces`."""

    def force(self, s: Floats) -> Floats:
        """(edge, point) V at points s of every edge of the mesh."""

    def moment(self, s: Floats) -> Floats:
        """(edge, point) M."""

    @property
    def at_ends(self) -> Floats:
        """(end,) R."""


@dataclass(frozen=True)
class AlongSupports:
    """Distributions of the reactions of a plate.

    Attributes
    ----------
    find : function
        Gives V, M and R along lines.
    moved : function
        w, or w_n along the outward normal, at an edge patch: (edge, point), for springs.
    """

    domain: Domain
    supports: Supports
    lines: Callable[[], Lines]
    find: Callable[[Lines], Forces]
    moved: Callable[[EdgePatch, bool], Floats]

    def documents(self) -> MutableMapping[str, dict[str, Any]]:
        """By support; those of supports on surfaces are not along lines."""
        held = self.supports.held
        labels = [g.label for g in held if len(g.line) + len(g.edges) + len(g.points)]
        labels += [label for label, form in self.supports.springs if isinstance(form, EdgeSpring)]
        whole = {g.label for g in held if len(g.surface)}
        whole |= {label for label, form in self.supports.springs if not isinstance(form, EdgeSpring)}
        return deferred([label for label in dict.fromkeys(labels) if label not in whole], self._document)

    @cached_property
    def _lines(self) -> Lines:
        return self.lines()

    @cached_property
    def _forces(self) -> Forces:
        return self.find(self._lines)

    def _springs(self, label: str) -> list[EdgeSpring]:
        springs = self.supports.springs
        return [form for name, form in springs if name == label and isinstance(form, EdgeSpring)]

    def _document(self, label: str) -> dict[str, Any]:
        mesh, groups = self.domain.mesh, [g for g in self.supports.held if g.label == label]
        lines = [part for g in groups for part in (g.line, g.edges)]
        edges = union(*lines, *(form.edges for form in self._springs(label)))
        share = self._share(label, len(mesh.points), lambda g: union(mesh.edges[g.line], g.points))
        mine = np.flatnonzero(share[self._lines.ends] > 0.0)
        vertices = self._lines.ends[mine]
        at_ends = np.zeros((len(mine), 3))
        if len(mine):
            at_ends[:, 2] = self._forces.at_ends[mine] * share[vertices]
        patch, force, moment = self._in_space(label, edges, *interval_rule(POINTS))
        weights = patch.weights[..., None]
        total = [
            (weights * force).sum(axis=(0, 1)) + at_ends.sum(axis=0),
            moment_about_origin(self._points(patch), weights * force)
            + moment_about_origin(mesh.points[vertices], at_ends)
            + (weights * moment).sum(axis=(0, 1)),
        ]
        shown, force, moment = self._in_space(label, edges, SAMPLES, np.ones(len(SAMPLES)))
        x, lengths = self._points(shown), patch.weights.sum(axis=1)
        found = AlongSupport(edges, x, lengths, force, moment, np.stack(total), vertices, at_ends)
        return found.document(mesh, self._lines.stops)

    def _in_space(self, label: str, edges: Ints, s: Floats, w: Floats) -> tuple[EdgePatch, Floats, Floats]:
        """Force and moment (edge, point, 3) per length of a support on edges, at points s of them."""
        patch = self.domain.edge_points(edges, s, w)
        v, m = np.zeros((2, *patch.xy.shape[:2]))
        count = len(self.domain.mesh.edges)
        held, turned = (
            self._share(label, count, of)[edges, None] for of in (lambda g: g.line, lambda g: g.edges)
        )
        if held.any():
            v += held * self._forces.force(s)[edges]
        if turned.any():
            m += turned * self._forces.moment(s)[edges]
        for form in self._springs(label):
            pull = form.stiffness(patch.xy) * self.moved(patch, form.rotation)
            pull[~np.isin(edges, form.edges)] = 0.0
            if form.rotation:
                m += pull
            else:
                v -= pull
        n, none = patch.normal, np.zeros_like(v)
        force, moment = (none, none, v), (-m * n[..., 1], m * n[..., 0], none)
        return patch, np.stack(force, axis=-1), np.stack(moment, axis=-1)

    def _share(self, label: str, count: int, members: Callable[[HeldGroup], Ints]) -> Floats:
        """(count,) the share of a support in what it holds beside others."""
        mine, all_of_them = np.zeros((2, count))
        for group in self.supports.held:
            all_of_them[members(group)] += 1.0
            if group.label == label:
                mine[members(group)] += 1.0
        return np.asarray(mine / np.maximum(all_of_them, 1.0))

    def _points(self, patch: EdgePatch) -> Floats:
        z = np.full((*patch.xy.shape[:2], 1), self.domain.mesh.points[0, 2])
        return np.concatenate([patch.xy, z], axis=2)
