"""Koiter shells on triangles.

koiter/   triangulated surfaces of order 1, 2, 3, flat or curved, with folds and branches
chart/    Argyris functions on a smooth chart

Each has its surface, energy, supports with the motions they leave free, loads, matrices and recovery, and knows
nothing of the other. What they share lies here. The kernel, arrays in and arrays out:

reference.py, vectors.py, frames.py   tables of the reference triangle; vectors and tensors on the surface
kinematics.py, resultants.py          changes of curvature; forces and moments, rotations
section.py, initial.py, evaluate.py   A, B, D of the cross-section; states without stress; values of places
planes.py, turning.py, limits.py      planes and rotations of supports; where Argyris is not to be taken
scatter.py                            blocks summed into a matrix

and around it, from a resolved scene to a result:

model.py, problem.py                  what an analysis takes; what is solved
supports.py, loads.py                 the words of a scene as conditions and forces
held.py, shape_checks.py              rigid motions that nothing holds; doubtful shapes
answer.py, group_reactions.py         the result; reactions of groups
fields.py, vertex_fields.py           values at any point, at vertices
"""
