"""MuJoCo's side: the compiled model with slots for bodies, the base scene, rest and sleep."""
