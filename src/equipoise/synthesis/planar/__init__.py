"""Planar arms with springs between any links, and the layouts that can balance them (Lee and Chen 2014)."""
