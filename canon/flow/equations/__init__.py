"""First-order equations of motion of every sort of system, and what happens to them at walls and contacts."""
