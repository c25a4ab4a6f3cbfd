"""Equations with kinks: the regimes between them, and which regime follows where the motion meets one."""
