"""The Koiter energy with Argyris elements on a chart."""
