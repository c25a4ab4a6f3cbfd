"""Motion: methods, propagation, trajectories."""
