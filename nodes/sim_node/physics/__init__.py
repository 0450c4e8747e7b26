"""The MuJoCo engine: the compiled model with slots for bodies, the base scene, rest and sleep."""
