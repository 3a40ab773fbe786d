"""The robot: commands, state, kinematics, limits and the simulated greenhouse. Knows no person and no camera."""

from robot_sim.kernel_cache import keep_kernels

keep_kernels(*__path__)
