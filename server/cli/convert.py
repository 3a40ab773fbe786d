"""``teleop convert``."""
