"""What kshell is checked against: cases with known answers, charts and benchmarks."""
