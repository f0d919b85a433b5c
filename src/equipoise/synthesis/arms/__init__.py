"""What several methods share: chains of links, mass moments, shoulders."""
