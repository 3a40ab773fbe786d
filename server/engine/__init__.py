"""The loop between the source and the robot: reader thread, engine thread, and what they hand to the clients."""
