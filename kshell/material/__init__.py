"""From elastic constants to the stiffness of a cross-section."""
