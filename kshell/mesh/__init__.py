"""Triangle meshes with named groups: reading, checking, selecting, writing."""

from kshell.mesh import check
from kshell.mesh.mesh import Group, Mesh
from kshell.mesh.read import read_mesh
from kshell.mesh.select import Selection, select
from kshell.mesh.write import write_msh

__all__ = ["Group", "Mesh", "Selection", "check", "read_mesh", "select", "write_msh"]
