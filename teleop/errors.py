"""The one exception root of teleop. Messages are one line: what is wrong, what is legal, what to do next."""


class TeleopError(Exception):
    """Base of all errors a user can cause; the command line prints it on one line and exits 1."""


class SourceError(TeleopError):
    """A depth source that cannot be opened or read on."""


class FrameError(TeleopError):
    """A frame whose arrays or times are not what DepthFrame requires."""


class RecordingError(TeleopError):
    """A recording that cannot be read or written."""


class ModelError(TeleopError):
    """A model file that is missing or of another format."""


class DataError(TeleopError):
    """A reference data set that is missing or incomplete (TELEOP_DATA)."""
