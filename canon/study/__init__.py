"""Long runs: drift statistics, cost against accuracy."""
