"""Speed: workload W1, the machine's floor, and one row of numbers a run (docs/bench.md)."""
