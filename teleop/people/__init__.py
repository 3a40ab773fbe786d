"""Rendered people: bodies, poses, clothes, rooms and a depth sensor, for training, tests and the virtual operator.

All geometry is in the operator's axes, which are the camera's levelled axes when the operator faces the sensor
(see ``teleop.frames``): x to the operator's right, y up, z backwards; metres; the floor is y = 0.
"""
