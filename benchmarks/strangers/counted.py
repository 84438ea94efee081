"""``python -m benchmarks.strangers.counted FILE WORDS``: hybridid that writes a line to FILE for each refit,
before it begins. So a trace that was killed leaves what it had begun."""

from __future__ import annotations

import functools
import os
import sys
from pathlib import Path
from typing import Any

from hybridid.trace.refits import refit as module


def count(file: Path) -> None:
    """Count each refit from now on; before any other module has taken the function by its name."""
    plain = module.refit

    @functools.wraps(plain)
    def counted(*given: Any, **named: Any) -> module.Refit:
        with file.open("a", encoding="utf-8") as stream:
            stream.write("begun\n")
            stream.flush()
            os.fsync(stream.fileno())
        return plain(*given, **named)

    module.refit = counted


if __name__ == "__main__":
    count(Path(sys.argv[1]).absolute())
    sys.argv = ["hybridid", *sys.argv[2:]]
    from hybridid_cli.main import main

    main()
