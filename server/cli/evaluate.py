"""``teleop evaluate``."""
