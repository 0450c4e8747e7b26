"""Questions about a simulated day, asked in words."""
