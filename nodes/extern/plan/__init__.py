"""Floor plans to print: rooms, furniture and names, as SVG at a scale."""
