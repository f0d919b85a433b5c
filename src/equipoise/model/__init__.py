"""Frozen values: the mechanism, its bodies, joints, force elements and masses, with units, names and errors."""
