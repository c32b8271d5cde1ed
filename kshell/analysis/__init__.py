"""From a scene to its result: which model, and how it is solved."""
