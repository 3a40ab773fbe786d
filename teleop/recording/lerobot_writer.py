"""Writes LeRobot dataset files, layout v3.0: Parquet for the numbers, MP4 for colour, 16-bit PNG for depth.

Layout after LeRobot's documentation of its format: ``data/chunk-000/file-NNN.parquet``, ``videos/KEY/chunk-000/
file-NNN.mp4``, ``meta/info.json``, ``meta/stats.json``, ``meta/tasks.parquet``, ``meta/episodes/chunk-000/
file-000.parquet``. Every episode has files of its own.

A dataset has one rate: frame i of an episode is stamped i / fps there, its own time is in ``observation.time_ns``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any, Final

import cv2
import numpy as np

from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.recording.lerobot_features import COLOR, DEPTH, TIME, Statistics, Vector

VERSION: Final = "v3.0"
_FILE: Final = "chunk-{chunk_index:03d}/file-{file_index:03d}"
_DATA: Final = f"data/{_FILE}.parquet"
_VIDEO: Final = f"videos/{{video_key}}/{_FILE}.mp4"
_GROUP_FRAMES: Final = 64
_STATISTIC_STEP: Final = 8
"""Every eighth pixel and line of the images."""
_COUNTERS: Final = ("timestamp", "frame_index", "episode_index", "index", "task_index")


class LeRobotWriter:
    """One dataset, frame by frame."""

    def __init__(self, folder: Path, fps: int, task: str, names: Mapping[str, tuple[str, ...]]) -> None:
        """folder: new. task: what the operator does, in words. names: feature -> names of its numbers.

        Raises RecordingError: no pyarrow, folder not new.
        """
        self._pa, self._parquet = _arrow()
        self._folder, self._fps, self._task, self._names = folder, fps, task, dict(names)
        self._sizes: dict[str, tuple[int, int]] = {}
        self._episodes: list[dict[str, Any]] = []
        self._statistics: dict[str, Statistics] = {}
        self._total = 0
        self._rows: list[dict[str, Any]] = []
        self._table: Any = None
        self._video: cv2.VideoWriter | None = None
        self._length = 0
        try:
            (folder / "meta" / "episodes" / "chunk-000").mkdir(parents=True)
        except OSError as error:
            raise RecordingError(f"cannot write {folder}: {error.strerror or error}") from None

    def write(self, frame: DepthFrame, vectors: Mapping[str, Vector]) -> None:
        """The next frame of the episode; the first after ``end_episode`` begins another. Raises RecordingError."""
        if self._length == 0:
            self._begin(frame)
        ok, png = cv2.imencode(".png", frame.depth_mm, [cv2.IMWRITE_PNG_COMPRESSION, 3])
        if not ok:
            raise RecordingError(f"depth of shape {frame.depth_mm.shape} cannot be written as PNG")
        number = len(self._episodes)
        row: dict[str, Any] = {name: vector.tolist() for name, vector in vectors.items()}
        row[DEPTH] = {"bytes": png.tobytes(), "path": f"depth-{number:03d}-{self._length:06d}.png"}
        row[TIME] = frame.t_ns
        counters = (self._length / self._fps, self._length, number, self._total, 0)
        row |= dict(zip(_COUNTERS, counters, strict=True))
        self._rows.append(row)
        for name, vector in vectors.items():
            self._count(name, vector[None, :])
        for name, value in zip(_COUNTERS, counters, strict=True):
            self._count(name, np.array([[value]]))
        self._count(TIME, np.array([[frame.t_ns]]))
        step = _STATISTIC_STEP
        self._count(DEPTH, frame.depth_mm[::step, ::step].reshape(-1, 1))
        if self._video is not None:
            self._write_color(frame)
        self._length += 1
        self._total += 1
        if len(self._rows) == _GROUP_FRAMES:
            self._flush()

    def end_episode(self) -> None:
        """Complete the episode's files; without frames nothing happens."""
        if self._length == 0:
            return
        self._flush()
        self._table.close()
        self._table = None
        place = {"chunk_index": 0, "file_index": len(self._episodes)}
        episode: dict[str, Any] = {
            "episode_index": len(self._episodes),
            "tasks": [self._task],
            "length": self._length,
            "dataset_from_index": self._total - self._length,
            "dataset_to_index": self._total,
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
        }
        episode |= {f"data/{name}": value for name, value in place.items()}
        if self._video is not None:
            self._video.release()
            self._video = None
            episode |= {f"videos/{COLOR}/{name}": value for name, value in place.items()}
            episode |= {f"videos/{COLOR}/from_timestamp": 0.0, f"videos/{COLOR}/to_timestamp": self._length / self._fps}
        self._episodes.append(episode)
        self._length = 0

    def close(self) -> None:
        """End the episode and write what describes the dataset. Raises RecordingError without frames."""
        self.end_episode()
        if not self._episodes:
            raise RecordingError("no frames; a dataset needs at least one")
        meta = self._folder / "meta"
        self._parquet.write_table(
            self._pa.Table.from_pylist(self._episodes), meta / "episodes/chunk-000/file-000.parquet"
        )
        self._parquet.write_table(self._tasks(), meta / "tasks.parquet")
        images = (DEPTH, COLOR)
        statistics = {name: found.as_json(name in images) for name, found in self._statistics.items()}
        _write_json(meta / "stats.json", statistics)
        _write_json(meta / "info.json", self._info())

    def _begin(self, frame: DepthFrame) -> None:
        place = {"chunk_index": 0, "file_index": len(self._episodes)}
        sizes = {DEPTH: frame.depth_mm.shape}
        if frame.color_rgb is not None:
            sizes[COLOR] = frame.color_rgb.shape[:2]
        if self._sizes and sizes != self._sizes:
            raise RecordingError(f"images changed from {self._sizes} to {sizes}; a dataset has one size of image")
        self._sizes = sizes
        data = self._folder / _DATA.format(**place)
        data.parent.mkdir(parents=True, exist_ok=True)
        self._table = self._parquet.ParquetWriter(data, self._schema(), compression="snappy")
        if frame.color_rgb is not None:
            path = self._folder / _VIDEO.format(video_key=COLOR, **place)
            path.parent.mkdir(parents=True, exist_ok=True)
            height, width = sizes[COLOR]
            self._video = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), self._fps, (width, height))
            if not self._video.isOpened():
                raise RecordingError(f"cannot write {path}: OpenCV here has no MPEG-4 encoder, or the disk is full")

    def _write_color(self, frame: DepthFrame) -> None:
        rgb = frame.color_rgb
        if rgb is None or rgb.shape[:2] != self._sizes[COLOR]:  # none near in time: the film must not lose step
            rgb = np.zeros((*self._sizes[COLOR], 3), np.uint8)
        assert self._video is not None
        self._video.write(cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))
        step = _STATISTIC_STEP
        self._count(COLOR, rgb[::step, ::step].reshape(-1, 3) / 255.0)

    def _count(self, name: str, samples: Any) -> None:
        self._statistics.setdefault(name, Statistics(samples.shape[1])).add(samples)

    def _flush(self) -> None:
        if self._rows:
            try:
                self._table.write_table(self._pa.Table.from_pylist(self._rows, schema=self._schema()))
            except OSError as error:
                raise RecordingError(f"cannot write {self._folder}: {error}") from None
            self._rows.clear()

    def _schema(self) -> Any:
        pa = self._pa
        vectors = [(name, pa.list_(pa.float32(), len(of))) for name, of in self._names.items()]
        image = (DEPTH, pa.struct([("bytes", pa.binary()), ("path", pa.string())]))
        counters = [("timestamp", pa.float32()), *((name, pa.int64()) for name in _COUNTERS[1:])]
        return pa.schema([*vectors, image, (TIME, pa.int64()), *counters])

    def _tasks(self) -> Any:
        """A pandas table whose index is the task's words, which readers look up."""
        table = self._pa.table({"task_index": [0], "__index_level_0__": [self._task]})
        column = {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64"}
        index = {"name": None, "field_name": "__index_level_0__", "pandas_type": "unicode", "numpy_type": "object"}
        pandas = {
            "index_columns": ["__index_level_0__"],
            "column_indexes": [],
            "columns": [entry | {"metadata": None} for entry in (column, index)],
        }
        return table.replace_schema_metadata({"pandas": json.dumps(pandas)})

    def _info(self) -> dict[str, Any]:
        plain = {"dtype": "float32", "shape": [1], "names": None}
        features: dict[str, Any] = {
            name: {"dtype": "float32", "shape": [len(of)], "names": list(of)} for name, of in self._names.items()
        }
        axes = ["height", "width", "channels"]
        features[DEPTH] = {
            "dtype": "image",
            "shape": [*self._sizes[DEPTH], 1],
            "names": axes,
            "info": {"is_depth_map": True, "unit": "mm", "encoding": "16-bit PNG, 0 = no reading"},
        }
        if COLOR in self._sizes:
            height, width = self._sizes[COLOR]
            film = {"height": height, "width": width, "codec": "mpeg4", "pix_fmt": "yuv420p", "fps": self._fps}
            about = {f"video.{key}": value for key, value in film.items()}
            features[COLOR] = {
                "dtype": "video",
                "shape": [height, width, 3],
                "names": axes,
                "info": about | {"video.channels": 3, "video.is_depth_map": False, "has_audio": False},
            }
        features |= {name: plain | {"dtype": "int64"} for name in (TIME, *_COUNTERS)} | {"timestamp": plain}
        return {
            "codebase_version": VERSION,
            "robot_type": "greenhouse three-arm",
            "total_episodes": len(self._episodes),
            "total_frames": self._total,
            "total_tasks": 1,
            "chunks_size": 1000,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "fps": self._fps,
            "splits": {"train": f"0:{len(self._episodes)}"},
            "data_path": _DATA,
            "video_path": _VIDEO if COLOR in self._sizes else None,
            "features": features,
        }


def _arrow() -> tuple[Any, ModuleType]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise RecordingError(
            f"LeRobot files need pyarrow ({error}); pip install 'greenhouse-teleop[datasets]'"
        ) from None
    return pyarrow, parquet


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(content, indent=4), encoding="utf-8")
