"""Parts of a Hamiltonian with a motion in closed form: Kepler problems, linear systems, planets about a star."""
