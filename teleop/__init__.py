"""From depth frames to robot commands: perception, intent and safety. Knows no socket and no web server."""

import robot_sim
from robot_sim.kernel_cache import keep_kernels

keep_kernels(*robot_sim.__path__, *__path__)
