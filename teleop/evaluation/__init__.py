"""Figures of a body tracker on people, rooms and motions it never saw: rendered with their truth, and real ones."""
