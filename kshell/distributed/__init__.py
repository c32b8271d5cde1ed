"""One scene on several processes: PETSc solves, and every process holds its own triangles.

The first process of a team runs an analysis as one process alone would: it reads the mesh, and finds frames of
supports, planes of symmetry, directors, loads and numbers of unknowns for the whole. It deals out triangles in pieces
with numbers of their own, and calls the others: their element matrices, the matrix and its factors, which are what
fills the memory, are divided, and so are strains and stresses of states. Only the first process has the mesh and whole
vectors.

launch.py       whether this process is one of several, told by its environment; imports nothing
team.py         the processes: dealing out, adding up, agreeing on errors before any is raised
calls.py        calls of the first process to the others, and what they share
leading.py      an analysis from its mesh to the results that all leave with
partition.py    which triangles are whose
shares.py       which rows of a vector are whose
piece.py        the triangles of one process; surface_piece.py of a shell, plate_piece.py of a plate
matrix.py       sums of what the processes have of a matrix; numbering.py the same in PETSc
factor.py       factors by MUMPS
prepared.py     matrices of plates, ready for loads; multigrid.py the same by multigrid
koiter.py, linear.py, plate.py    models
refuse.py       what is not for several processes
saving.py       files: result.json once, result.pvtu in pieces
command.py      the command line on several processes: one message, one exit code, none left waiting
"""
