"""Kinematics of serial arms: D-H chains, forward kinematics, Jacobians, closed-form and numerical inverse.

Every chain, from D-H rows or a URDF, is brought to one form: fixed transforms with a joint about or along z between.
"""

from robot_sim.kinematics.chain import Chain, Joint
from robot_sim.kinematics.damped_least_squares import DlsSettings, solve_dls
from robot_sim.kinematics.dh import DhRow, modified_dh, standard_dh
from robot_sim.kinematics.ik_result import IkBatch, IkReason, IkResult
from robot_sim.kinematics.pitch_arm import PitchArm
from robot_sim.kinematics.spherical_wrist import SphericalWristArm
from robot_sim.kinematics.twin_base_arm import TwinBaseArm
from robot_sim.kinematics.urdf import chain_from_urdf

__all__ = [
    "Chain",
    "DhRow",
    "DlsSettings",
    "IkBatch",
    "IkReason",
    "IkResult",
    "Joint",
    "PitchArm",
    "SphericalWristArm",
    "TwinBaseArm",
    "chain_from_urdf",
    "modified_dh",
    "solve_dls",
    "standard_dh",
]
