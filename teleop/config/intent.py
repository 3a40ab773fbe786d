"""Configuration of intent and safety: zones, tasks, mapping, hands, engaging, watchdogs."""

from __future__ import annotations

from teleop.config.base import Section


class IntentConfig(Section):
    """All of intent; its sub-sections follow the data flow."""
