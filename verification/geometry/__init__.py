"""Where discrete curvature converges and where it is known not to, and comparison with libigl."""
