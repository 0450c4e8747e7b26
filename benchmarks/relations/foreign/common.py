"""Small things of household size that several worlds have."""

from benchmarks.relations.foreign.drawing import (
    ball,
    bar,
    box,
    tube,
    vessel,
)

MUG = (
    vessel(0.04, 0.09, 0.005)
    + bar(0.006, (0.045, 0, 0.02), (0.06, 0, 0.045))
    + bar(0.006, (0.06, 0, 0.045), (0.045, 0, 0.07))
)
BOWL = vessel(0.08, 0.055, 0.006, foot=0.045, staves=18)
PLATE = tube(0.1, 0.012)
BOTTLE = tube(0.035, 0.2) + tube(0.013, 0.08, (0, 0, 0.2))
CAN = tube(0.033, 0.1)
CARTON = box((0.07, 0.07, 0.2))
BOOK = box((0.16, 0.23, 0.03))
LEMON = ball(0.03)
