"""``teleop serve``."""
