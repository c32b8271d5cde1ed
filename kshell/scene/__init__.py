"""What a user describes: mesh, material, supports, loads and probes, as plain checked data."""
