"""Smooth surfaces through the vertices of flat triangles: mid-edge nodes for meshes that have none.

sheets.py      edges that keep their shape (borders, creases, branches, rims of flat parts), and the sheets between
fits.py        quadrics and quartic polynomials fitted to the vertices around each vertex
one_sided.py   of the fits near an edge those that do not reach over a jump of curvature
borders.py     circles along the kept edges
rebuild.py     all of it: the nodes, and an estimate of their error
decision.py    whether the error is small enough against the thickness
"""
