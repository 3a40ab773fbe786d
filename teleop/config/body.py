"""Configuration of perception: segmentation, forest, mean shift, filter."""

from __future__ import annotations

from teleop.config.base import Section


class BodyConfig(Section):
    """All of perception; its sub-sections follow the data flow."""
