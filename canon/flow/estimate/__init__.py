"""Error estimates of computed motions: their companions, and what the distance from them says."""
