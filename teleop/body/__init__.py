"""Perception: depth frame -> operator's pixels -> body parts -> joints -> skeleton."""
