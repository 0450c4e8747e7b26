"""What is drawn, in Rerun's terms."""
