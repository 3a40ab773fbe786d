"""What pyproject.toml cannot say: the wheel carries the bundled recordings and is not built without the console."""

from __future__ import annotations

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.errors import SetupError

ROOT = Path(__file__).resolve().parent
CONSOLE = ROOT / "server" / "console" / "index.html"


class BuildWithRecordings(build_py):
    """Copies recordings/ beside the server's modules, where an installed server looks for them."""

    def run(self) -> None:
        """Build, then copy. An editable install uses the folders where they are."""
        super().run()
        if self.editable_mode:
            return
        if not CONSOLE.is_file():
            raise SetupError("the console is not built, and a wheel must not lack it; run 'make setup' first")
        target = Path(self.build_lib) / "server" / "recordings"
        target.mkdir(parents=True, exist_ok=True)
        for path in sorted((ROOT / "recordings").iterdir()):
            if path.suffix in (".mcap", ".md"):
                shutil.copyfile(path, target / path.name)


setup(cmdclass={"build_py": BuildWithRecordings})
