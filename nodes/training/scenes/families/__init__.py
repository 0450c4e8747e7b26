"""Parametric families of objects: each sample is a bottle, cup or pear with other proportions and curves.

Scaling one model would keep its profile: all bottles would have their shoulders at the same relative height,
unlike real ones.
"""
