"""The Koiter energy on triangles of order 1, 2 and 3 of any surface in space."""
