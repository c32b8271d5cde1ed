"""The Hellan-Herrmann-Johnson plate of any order: deflection and moments at once, moments in equilibrium.

Moments m in P_{p-1}(T), symmetric, m_nn continuous across edges; deflection w in P_p, continuous. The continuity of
m_nn is imposed by a multiplier on the edges, which is the slope of w, so that moments are eliminated triangle by
triangle and the system is symmetric and positive definite in w and the slopes (Arnold & Brezzi, RAIRO M2AN 19 (1985)
7-32; Comodi, Math. Comp. 52 (1989) 17-29). Order 1 is the Morley element.
"""

from kshell.plate.hhj.tables import LARGEST_ORDER, Tables, tables

__all__ = ["LARGEST_ORDER", "Tables", "tables"]
