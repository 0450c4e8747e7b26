"""Features of colour images from a network that was trained on photographs, and classes from them."""
