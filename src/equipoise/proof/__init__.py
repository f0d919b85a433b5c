"""Certificates of balance that another program can check."""
