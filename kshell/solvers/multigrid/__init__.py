"""Multigrid for plates: element, vertex space, reduced-HCT coarse spaces, direct on the coarsest."""
