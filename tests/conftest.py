"""For all tests: generated examples may take as long as a busy machine needs."""

from hypothesis import settings

settings.register_profile("no_clock", deadline=None)
settings.load_profile("no_clock")
