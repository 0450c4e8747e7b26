"""Recognition: features of things, trained models, classification, and estimation of hidden sides."""
