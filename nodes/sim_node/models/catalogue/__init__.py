"""The families of models, one file each. Each function builds the parts of one model."""
