"""Faults put into the running server: real web server, engine, body tracker and PyBullet; rendered people."""
