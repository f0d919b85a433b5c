"""Serial arms and trees with auxiliary links, one spring per link (Lin, Shieh and Chen 2010)."""
