"""Exactness without a Fourier series: how far an energy is from constant, in polynomial time."""
