"""Motion in time by implicit steps, each of them one equilibrium."""
