"""Figures and reports of a mechanism, its springs and its verdict."""
