"""DELTA robots (Simionescu, Ciupitu and Ionita 2015)."""
