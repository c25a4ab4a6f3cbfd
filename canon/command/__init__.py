"""What each command of ``canon`` reads and prints; nowhere else does canon print."""
