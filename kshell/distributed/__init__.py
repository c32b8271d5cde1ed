"""One scene on several processes: PETSc solves, and every process holds the element matrices of its own triangles.

A team of processes runs the same analysis on the same scene. Each knows the whole mesh, the supports and all vectors,
so that frames of supports, planes of symmetry and numbers of unknowns are found for the whole and agree by
construction. Divided are the triangles: their stiffness, their derivatives of strains, the matrix and its factors,
which are what fills the memory. Stresses of a triangle are computed by the process that has it, and put together.

launch.py       whether this process is one of several, told by its environment; imports nothing
team.py         the processes: joining what they have, agreeing on errors before any is raised
partition.py    which triangles are whose
matrix.py       sums of what the processes have of a matrix, as matrices of PETSc
factor.py       factors by MUMPS
prepared.py     matrices of plates, ready for loads; multigrid.py the same by multigrid
koiter.py, linear.py, plate.py    models
refuse.py       what is not for several processes
saving.py       files: result.json once, result.pvtu in pieces
command.py      the command line on several processes: one message, one exit code, none left waiting
"""
