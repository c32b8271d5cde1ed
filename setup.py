"""What pyproject.toml cannot say: folders of data without modules, and meshes, data of kshell.verify in the wheel.

`kshell verify` runs the cases wherever kshell is installed, and some of them read the meshes that lie beside the
package in the repository.
"""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["kshell*"]), "kshell.cli.start", "kshell.verify.meshes"],
    package_dir={"kshell.verify.meshes": "meshes"},
)
