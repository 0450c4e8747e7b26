"""Plans to print: rooms, furniture as it stands, and names, as SVG at a scale."""
