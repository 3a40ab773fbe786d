"""``teleop doctor``."""
