"""``teleop track``."""
