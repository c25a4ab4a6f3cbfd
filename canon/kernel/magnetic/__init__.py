"""Charged particles and rotating frames, H = Σ (p − A)²/2m + φ: Boris's push, and splittings by shifts of gauge."""
