"""How far an answer may be from the exact one: bounds with a proof, and estimates without."""
