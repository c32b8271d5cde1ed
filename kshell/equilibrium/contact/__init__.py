"""Contact of a shell with itself and with obstacles, as part of an equilibrium."""
