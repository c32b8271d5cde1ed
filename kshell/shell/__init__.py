"""Koiter shells on triangles: arrays in, arrays out. Nothing here knows of scenes, results or files.

surface.py, chart_surface.py    unknowns and rest geometry: triangulated of order 1, 2, 3; Argyris on a chart
reference.py, strain_tables.py  constant tables of the reference triangle
kinematics.py, edges.py         changes of curvature and of edge angles; directors
section.py, constitutive.py     A, B, D of the cross-section; stiffness of a triangle in its strains
energy.py, koiter.py, argyris.py  energy, gradient, Hessian of both discretisations
supports.py, loads.py, matrices.py, initial.py    and chart_supports.py, chart_loads.py
linear.py                       small deflections
equilibrium.py, newton.py, load_steps.py, path.py  large deflections
recovery.py, reactions.py, topology.py  what comes out, and how the surface hangs together
"""
