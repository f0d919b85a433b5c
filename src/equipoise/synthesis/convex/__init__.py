"""The convex program: blocks of unknowns, the bound, few springs that reach it."""
