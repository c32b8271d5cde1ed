"""States of equilibrium of an energy: linear, by Newton's method, along paths of loads.

Knows energies and conditions on their unknowns, neither meshes nor shells."""
