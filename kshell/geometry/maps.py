"""Smooth maps made of others: slopes, products and pulled-back one-forms."""

from __future__ import annotations

from collections.abc import Sequence

from kshell.geometry.components import Floats
from kshell.geometry.smooth import ComposedMap, Partials, SmoothMap, Taylor, indices, product_partials


class SlopeMap(SmoothMap):
    """(f_u, f_v) of a map f with one component."""

    parameters, components = 2, 2

    def __init__(self, f: SmoothMap) -> None:
        self.f, self.highest = f, f.highest - 1

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        self.require(order, "a gradient")
        values = self.f.partials(where, order + 1)
        return {(i, j): [values[i + 1, j][0], values[i, j + 1][0]] for i, j in indices(2, order)}


class ProductMap(SmoothMap):
    """A map times a function."""

    parameters = 2

    def __init__(self, vector: SmoothMap, factor: SmoothMap) -> None:
        self.vector, self.factor = vector, factor
        self.components, self.highest = vector.components, min(vector.highest, factor.highest)

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        vector, factor = self.vector.partials(where, order), self.factor.partials(where, order)
        f = _component(factor, 0)
        columns = [product_partials(_component(vector, c), f, 2, order) for c in range(self.components)]
        return {index: [column[index] for column in columns] for index in indices(2, order)}


class PullBackMap(SmoothMap):
    """The components of a one-form P du + Q dv in parameters (s, t), (u, v) = phi(s, t).

    (P(phi) u_s + Q(phi) v_s,  P(phi) u_t + Q(phi) v_t)
    """

    parameters, components = 2, 2

    def __init__(self, form: SmoothMap, phi: SmoothMap) -> None:
        self.composed, self.phi = ComposedMap(form, phi), phi
        self.highest = min(form.highest, phi.highest - 1)

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        self.require(order, "a pulled-back form")
        form, phi = self.composed.partials(where, order), self.phi.partials(where, order + 1)
        out: Partials = {index: [] for index in indices(2, order)}
        for di, dj in ((1, 0), (0, 1)):
            terms = []
            for c in range(2):
                slope: Taylor = {(i, j): phi[i + di, j + dj][c] for i, j in indices(2, order)}
                terms.append(product_partials(_component(form, c), slope, 2, order))
            for index in out:
                out[index].append(terms[0][index] + terms[1][index])
        return out


def _component(partials: Partials, c: int) -> Taylor:
    return {index: vector[c] for index, vector in partials.items()}
