"""Open chains without auxiliary links (Lenzo 2017)."""
