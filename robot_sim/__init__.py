"""The robot: commands, state, kinematics, limits and the simulated greenhouse. Knows no person and no camera."""
