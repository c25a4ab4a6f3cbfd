"""Inverses of canonical transformations in closed form: by the coordinates alone, of polar and of confocal type."""
