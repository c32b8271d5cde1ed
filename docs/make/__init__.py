"""Pages of the site that are made from the program: keys, commands, verification, notebooks; formulas as MathML."""
