"""Where Argyris functions on a chart are not to be taken."""

# charts that are thinner, against their size, lock
THINNEST = 2e-3
