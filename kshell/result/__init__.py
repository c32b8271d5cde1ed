"""What is answered: plain data, and how it is saved."""
