"""Depth sources, live or recorded, all behind ``teleop.sources.base.Source``; opened by URI."""

from teleop.sources.base import Source, SourceInfo
from teleop.sources.uri import LEGAL_URIS, open_source

__all__ = ["LEGAL_URIS", "Source", "SourceInfo", "open_source"]
