"""Fitting: aligns the models of classes with observed things."""
