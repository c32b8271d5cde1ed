"""Where Argyris functions on a chart are not to be taken, and what to take."""

# charts that are thinner, against their size, lock
THINNEST = 2e-3
USE_KOITER = 'take element = "koiter", which works on charts too'
