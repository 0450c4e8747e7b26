"""What is drawn, as Rerun archetypes."""
