"""Packages beyond what pyproject.toml can say: the meshes of the verification cases come along in the wheel.

`kshell verify` runs the cases wherever kshell is installed, so a wheel has kshell, the cases and their runner
(verification, verification.cases, verification.suite), and the folder meshes as data of the package verification.
"""

from setuptools import find_packages, setup

FOUND = find_packages(include=["kshell*", "verification", "verification.cases*", "verification.suite*"])

setup(packages=[*FOUND, "verification.meshes"], package_dir={"verification.meshes": "meshes"})
