"""Bags of ROS 2, written by the library's own writer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

HEADER = "\n".join(
    (
        "=" * 80,
        "MSG: std_msgs/Header",
        "builtin_interfaces/Time stamp",
        "string frame_id",
        "=" * 80,
        "MSG: builtin_interfaces/Time",
        "int32 sec",
        "uint32 nanosec",
    )
)
EPOCH = 1_700_000_000_000_000_000
"""ns; the first stamp of every file here."""


@dataclass(frozen=True)
class Bag:
    """Messages ``(topic, type, definition, message, log time in s)``, and the MCAP file that holds them."""

    JOINT: ClassVar = f"std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] effort\n{HEADER}"
    path: Path

    def joint(
        self,
        time: float,
        q: Sequence[float],
        tau: Sequence[float],
        name: Sequence[str] = ("elbow",),
        stamped: bool = True,
    ) -> SimpleNamespace:
        """A message of joint states; without ``stamped`` its header holds no stamp."""
        ns = EPOCH + round(time * 1e9) if stamped else 0
        stamp = SimpleNamespace(sec=ns // 10**9, nanosec=ns % 10**9)
        header = SimpleNamespace(stamp=stamp, frame_id="base")
        return SimpleNamespace(header=header, name=list(name), position=list(q), effort=list(tau))

    def swing(
        self, n: int = 200, dt: float = 0.01, late: float = 0.003, stamped: bool = True
    ) -> Iterator[tuple]:
        """Joint states at even stamps, logged late; a command without a header, at a third of the rate."""
        for k in range(n):
            t = k * dt
            message = self.joint(t, [np.sin(t), 2.0], [np.cos(t), 3.0], ("elbow", "wrist"), stamped)
            yield "/joint_states", "sensor_msgs/JointState", self.JOINT, message, t + late
            if k % 3 == 0:
                yield "/cmd", "std_msgs/Float64", "float64 data", SimpleNamespace(data=np.sin(t)), t + 0.001

    def write(self, messages: Any, compression: str = "ZSTD") -> Path:
        """Write the file anew."""
        from mcap.writer import CompressionType
        from mcap_ros2.writer import Writer

        packed = CompressionType[compression]
        with self.path.open("wb") as file, Writer(file, compression=packed, chunk_size=4096) as writer:
            known: dict[str, Any] = {}
            for topic, kind, text, message, at in messages:
                schema = known.setdefault(kind, None) or writer.register_msgdef(kind, text)
                known[kind] = schema
                writer.write_message(topic, schema, message, log_time=EPOCH + round(at * 1e9))
        return self.path


@pytest.fixture
def bag(tmp_path: Path) -> Bag:
    """A bag to be written."""
    pytest.importorskip("mcap_ros2", reason="needs the extra ros: pip install 'hybridid[ros]'")
    return Bag(tmp_path / "swing.mcap")
