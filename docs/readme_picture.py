"""Draws the picture of the README from a stored trace of measured records: ``make readme-picture``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from hybridid.plotting.style import save
from hybridid.plotting.trace_waterfall import Level, waterfall_plot

IMAGES = Path(__file__).parent / "images"
OUTPUT = "position"


def main(stored: Path) -> None:
    """Write the waterfall of the trace in ``stored``, a ``trace.json``, to ``docs/images``.

    Raises:
        SystemExit: if the trace is not one of measured records.
    """
    trace = json.loads(stored.read_text(encoding="utf-8"))
    if trace["provenance"] != "measured":
        sys.exit(f"{stored}: the trace is {trace['provenance']}; the README shows measured records only")
    levels = [Level(entry["label"], entry["held_out_rmse"][OUTPUT]) for entry in trace["path"]]
    floor, judged = trace["noise_floor"][OUTPUT], f"held-out horizons of {trace['horizon']:g} s"
    plot = waterfall_plot(levels, floor["value"], OUTPUT, floor["unit"], judged, trace["provenance"])
    save(plot, IMAGES, name="emps_waterfall", kinds=("svg",))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
