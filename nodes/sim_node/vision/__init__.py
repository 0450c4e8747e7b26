"""What cameras in the simulated world see."""
