"""A model of a person who drives the robot through the console: what they see, decide and do.

``console`` what is painted -> ``eye`` what is read off it, late and inexactly -> ``picking`` / ``spraying`` what to do
-> ``body`` how a person gets there. Nothing here knows the simulation.
"""
