"""Before numpy is imported: a worker of pytest-xdist uses one thread, for there are as many workers as cores.

Pictures are those of matplotlib, whether PyVista is installed or not; what is printed has 80 columns and no colours,
whatever the terminal.
"""

import os

if "PYTEST_XDIST_WORKER" in os.environ:
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")

os.environ.setdefault("KSHELL_STILLS", "matplotlib")
os.environ["COLUMNS"] = "80"
for variable in ("FORCE_COLOR", "CLICOLOR_FORCE", "TTY_COMPATIBLE"):
    os.environ.pop(variable, None)
