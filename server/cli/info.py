"""``teleop info``."""
