"""One spring of wire: dimensions, stresses and margins."""
