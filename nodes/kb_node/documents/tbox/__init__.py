"""TBoxes as documents: what they declare, whether they may hold, and what is to be known of them."""
