"""Where Argyris functions on a chart are not to be taken, and what to take."""

# charts that are thinner, against their size, lock
THINNEST = 2e-3
# what smooth functions cannot follow
JUMP_INSIDE = (
    "jump across lines inside the shell (steps of the section, lines held or loaded, borders of free strains)"
)

USE_KOITER = 'take element = "koiter", which works on charts too'
