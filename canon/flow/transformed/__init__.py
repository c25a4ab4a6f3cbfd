"""Time-transformed methods: the extended Hamiltonian, its motion, and states at given times."""
