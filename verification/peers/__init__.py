"""Other programs on the same plates and shells, for honest comparison: each a small driver of its own.

| driver | program | what |
|---|---|---|
| scikit_fem.py | scikit-fem and scipy | plates, Morley and Argyris |
| ngsolve_plate.py, ngsolve_shell.py | NGSolve | Hellan-Herrmann-Johnson plates, Koiter shells |
| kratos_shell.py | Kratos | plates and shells, thin triangles, small and large deflections |
| opensees_shell.py | OpenSees | plates and shells, thin triangles and quadrilaterals, small and large deflections |
| calculix_shell.py | CalculiX | shells, quadrilaterals of eight nodes |
| getfem_plate.py, freefem_plate.py | GetFEM, FreeFEM | plates |

All are run as scripts by the interpreter that has the program, with a job (see job.py) as the only argument; none of
them imports kshell.
"""
