"""What pyproject.toml cannot say: folders of data without modules, meshes, data of kshell.verify in the wheel, and
loops that are compiled where there is a C compiler (where not, numpy does the same, `kshell/solvers/kernels.py`).

`kshell verify` runs the cases wherever kshell is installed, and some of them read the meshes that lie beside the
package in the repository.
"""

import sys

from setuptools import Extension, find_packages, setup

setup(
    packages=[*find_packages(include=["kshell*"]), "kshell.cli.start", "kshell.verify.meshes"],
    package_dir={"kshell.verify.meshes": "meshes"},
    ext_modules=[
        Extension(
            name,
            [name.replace(".", "/") + ".pyx"],
            # the same numbers as numpy on every processor: no products and sums rounded together
            extra_compile_args=[] if sys.platform == "win32" else ["-O3", "-g0", "-ffp-contract=off"],
            optional=True,
        )
        for name in (
            "kshell.elements.compiled",
            "kshell.mesh.compiled",
            "kshell.solvers.compiled",
            "kshell.solvers.fronts",
            "kshell.solvers.panels",
            "kshell.solvers.multigrid.compiled",
        )
    ],
)
