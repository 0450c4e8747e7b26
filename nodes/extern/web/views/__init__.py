"""What the panels of the page show, as plain rows, texts and positions: pure, and known to no browser."""
