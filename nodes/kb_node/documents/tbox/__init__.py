"""TBoxes as documents: their declarations, validation and notes."""
