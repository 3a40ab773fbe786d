"""``teleop train``."""
