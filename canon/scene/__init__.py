"""Ready systems, one small file a family."""
