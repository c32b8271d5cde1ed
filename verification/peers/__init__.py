"""Other programs on the same plates, for honest comparison: each a small driver of its own."""
