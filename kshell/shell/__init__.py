"""Koiter shells on triangles.

The kernel: arrays in, arrays out, nothing knows of scenes, results or files.

koiter/, chart/                 the two discretisations: unknowns and rest geometry, energy, supports, loads, recovery
reference.py                    constant tables of the reference triangle
kinematics.py, frames.py        changes of curvature and of edge angles; frames of tensors
section.py, constitutive.py     A, B, D of the cross-section; stiffness of a triangle in its strains
matrices.py, initial.py         mass and springs; strains without stress
reactions.py                    resultants of forces on the unknowns

From a structure to a result, around it:

model.py, koiter/model.py, chart/model.py   the shell as analyses need it
problem.py                      energy, loads and conditions of a structure
supports.py, loads.py           what each kind of support and load means for either discretisation
group_reactions.py, fields.py, answer.py    what comes out
held.py, shape_checks.py, imperfection.py   rigid motions that nothing holds; doubtful shapes; nodes moved
"""
