"""Assisted picking: which fruit, how to stand, the way of both arms there and to the box; pure planning."""
