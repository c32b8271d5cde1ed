"""Before numpy is imported: a worker of pytest-xdist uses one thread, for there are as many workers as cores.

Pictures are those of matplotlib, whether PyVista is installed or not.
"""

import os

if "PYTEST_XDIST_WORKER" in os.environ:
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")

os.environ.setdefault("KSHELL_STILLS", "matplotlib")
