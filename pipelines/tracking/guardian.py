"""``python -m pipelines.tracking.guardian COMMAND...`` ends COMMAND with all its processes when stdin closes.

The process that starts it holds the other end of stdin. When that process is killed, the system closes it.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading

from pipelines.tracking.patience import END


def main() -> int:
    """Run the command in this process' group; returns its exit code."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # for the group: this process ends with the command
    command = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL)
    threading.Thread(target=_end_with_stdin, args=(command,), daemon=True).start()
    return command.wait()


def _end_with_stdin(command: subprocess.Popen[bytes]) -> None:
    sys.stdin.buffer.read()
    os.killpg(0, signal.SIGTERM)
    try:
        command.wait(END)
    finally:
        os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    sys.exit(main())
