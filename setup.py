"""What pyproject.toml cannot say: the folder meshes comes along in the wheel as data of kshell.verify.

`kshell verify` runs the cases wherever kshell is installed, and some of them read the meshes that lie beside the
package in the repository.
"""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["kshell*"]), "kshell.verify.meshes"],
    package_dir={"kshell.verify.meshes": "meshes"},
)
