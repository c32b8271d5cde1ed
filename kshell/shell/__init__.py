"""Koiter shells on triangles.

The kernel: arrays in, arrays out, nothing knows of scenes, results or files.

surface.py, chart_surface.py    unknowns and rest geometry: triangulated of order 1, 2, 3; Argyris on a chart
reference.py, strain_tables.py  constant tables of the reference triangle
kinematics.py, edges.py         changes of curvature and of edge angles; directors
section.py, constitutive.py     A, B, D of the cross-section; stiffness of a triangle in its strains
energy.py, koiter.py, argyris.py  energy, gradient, Hessian of both discretisations
supports.py, loads.py, matrices.py, initial.py    and chart_supports.py, chart_loads.py
linear.py                       small deflections
equilibrium.py, newton.py, load_steps.py, path.py  large deflections
recovery.py, reactions.py, topology.py  what comes out, and how the surface hangs together

From a scene to a result, around it:

model.py, problem.py            solve a scene: `solve_shell`
discretisation.py, argyris_discretisation.py, chart_recovery.py  both discretisations as scenes need them
scene_supports.py, scene_loads.py, scene_reactions.py            the words of a scene
held.py, shape_checks.py        rigid motions that nothing holds; doubtful shapes
fields.py                       values at vertices and at any point
"""
