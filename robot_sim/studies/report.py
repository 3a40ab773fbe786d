"""Tables and the report of a study: one Markdown page, one CSV per table."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from robot_sim.errors import RobotError

Cell = str | float | int | bool
Progress = Callable[[str, int, int], None]
"""Called with what is going on, steps done, steps in all."""


def silent(_what: str, _done: int, _total: int) -> None:
    """Progress for callers that show none."""


def new_folder(path: Path) -> Path:
    """The output folder, made when missing. Raises RobotError when it cannot be written."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RobotError(f"cannot write into {path}: {error.strerror}; choose another --output") from None
    return path


def text_of(cell: Cell) -> str:
    """A cell as shown in Markdown."""
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    if isinstance(cell, float):
        return f"{cell:.4g}" if abs(cell) < 1000 else f"{cell:.0f}"
    return str(cell)


@dataclass(frozen=True, slots=True)
class Table:
    """A named table; name is the CSV's file name."""

    name: str
    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def markdown(self, most_rows: int = 40) -> str:
        """The table in Markdown, cut off after most_rows with a pointer to the CSV."""
        lines = [f"| {' | '.join(self.header)} |", f"|{'---|' * len(self.header)}"]
        lines += [f"| {' | '.join(text_of(c) for c in row)} |" for row in self.rows[:most_rows]]
        if len(self.rows) > most_rows:
            lines.append(f"\n{len(self.rows)} rows in all: `{self.name}.csv`")
        return "\n".join(lines)


def table(name: str, title: str, header: Sequence[str], rows: Iterable[Sequence[Cell]]) -> Table:
    """A table whose rows all have the header's length."""
    fixed = tuple(tuple(r) for r in rows)
    if any(len(r) != len(header) for r in fixed):
        raise RobotError(f"table {name}: every row needs {len(header)} cells")
    return Table(name, title, tuple(header), fixed)


@dataclass(slots=True)
class Report:
    """Collects paragraphs, tables and pictures in order; ``write`` makes README.md and the CSV files."""

    title: str
    folder: Path
    _parts: list[str] = field(default_factory=list)
    _tables: list[Table] = field(default_factory=list)

    def text(self, paragraph: str) -> None:
        """Add a paragraph."""
        self._parts.append(paragraph)

    def heading(self, words: str) -> None:
        """Add a section heading."""
        self._parts.append(f"## {words}")

    def table(self, t: Table) -> None:
        """Add a table under its title."""
        self._tables.append(t)
        self._parts.append(f"**{t.title}**\n\n{t.markdown()}")

    def csv_only(self, t: Table) -> None:
        """Add a long table as a CSV file, mentioned in one line."""
        self._tables.append(t)
        self._parts.append(f"{t.title}: `{t.name}.csv` ({len(t.rows)} rows)")

    def picture(self, file_name: str, caption: str) -> None:
        """Add a picture that lies in the folder."""
        self._parts.append(f"![{caption}]({file_name})")

    def write(self) -> Path:
        """Write all files; returns the Markdown page's path."""
        new_folder(self.folder)
        for t in self._tables:
            with (self.folder / f"{t.name}.csv").open("w", newline="", encoding="utf-8") as f:
                writer = csv.writer(f)
                writer.writerow(t.header)
                writer.writerows(t.rows)
        page = self.folder / "README.md"
        page.write_text("\n\n".join([f"# {self.title}", *self._parts]) + "\n", encoding="utf-8")
        return page
