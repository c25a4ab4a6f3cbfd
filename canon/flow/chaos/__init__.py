"""Regular or chaotic: sections, periodic orbits, and how fast neighbours part."""
