"""How much faster does ``hybridid sweep`` train a grid than a plain loop, to the same errors? Simulated.

(a) The nine networks of the thesis' Table 4.4 on the virtual vehicle (3 to 5 hidden layers of 8 to 32
neurons, vertical velocity), one seed at a time, in three ways:

    sweep       the command ``hybridid sweep``
    plain loop  one after another, scored and written as a sweep's are: ``hybridid residual -m``, Hydra's loop
    bare loop   one after another in one process that only trains them and writes nothing

The same code trains them, with the same epochs, always on one thread. The gray box is fitted before; nobody
logs.
(b) All seeds of these nine in one command.
(c) 200 small networks in one command.

All on two cores. Wall and CPU time both count what other programs do meanwhile: leave the machine alone.

    python benchmarks/sweep_speed.py [--seeds 2] [--networks 200] [--epochs 800]
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import fmean, stdev
from tempfile import TemporaryFile
from typing import Any

from benchmarks import studies

OUT = studies.OUT / "sweep_speed"
OUTPUT = "vertical_velocity"
CORES = 2
GRID = {"depth": (3, 4, 5), "width": (8, 16, 32)}
ADAM = (
    "optimiser=adam",
    "starts=1",
    "horizons=[10]",
    "patience=400",
    "batch=256",
    "learning_rate=3e-3",
    "weight_decay=1e-2",
)
"""Networks share a stack only with adam."""
WORDS = ("experiment=vehicle_narx", "data=simulated", *(f"residual.{word}" for word in ADAM))
WAYS = ("sweep", "plain loop", "bare loop")


@dataclass(frozen=True)
class Timed:
    """One way to train the grid with one seed: wall and CPU seconds, held-out RMSE in m/s by size."""

    way: str
    seed: int
    wall: float
    cpu: float
    held_out: dict[str, float]


def main(arguments: Sequence[str] | None = None, say: Callable[[str], None] = print) -> dict[str, Any]:
    """Run the study from the command line's ``arguments`` and write it to ``outputs/studies/sweep_speed``."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=2, help="of the grid of Table 4.4 (default: 2)")
    parser.add_argument("--networks", type=int, default=200, help="small ones in one command (default: 200)")
    parser.add_argument("--epochs", type=int, default=800, help="at most, of each network (default: 800)")
    parser.add_argument("--bare-loop", type=int, metavar="SEED", help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.bare_loop is not None:
        print(json.dumps(_bare_loop(given.bare_loop, given.epochs)))
        return {}
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:CORES])
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    say(f"load of the machine before: {os.getloadavg()[0]:.1f}")
    for way in WAYS:
        _timed([*_hybridid("fit", _out(way)), "case=vehicle", "data=simulated"])
        _one(way, given.seeds, epochs=1)  # what is compiled once and kept on disk is nobody's time
    timed = []
    for seed in range(given.seeds):
        for way in WAYS:
            timed.append(_one(way, seed, given.epochs))
            say(f"{way}, seed {seed}: {timed[-1].wall:.1f} s wall, {timed[-1].cpu:.1f} s CPU")
    together = _together(given.seeds, given.epochs)
    say(f"all {given.seeds} seeds in one command: {together['wall']:.1f} s wall, {together['cpu']:.1f} s CPU")
    small = _small(given.networks, given.epochs)
    say(f"{given.networks} small networks: {small['wall']:.0f} s wall, {small['cpu']:.0f} s CPU")
    found = {"provenance": "simulated", "timed": [asdict(t) for t in timed], "small": small}
    found |= {"together": together, "load": os.getloadavg()[0]}
    found |= {"ratio": _ratios(timed), "ratio_together": _ratios(timed, together)}
    text = _report(timed, together, small, given)
    say(text)
    studies.write(OUT / "sweep_speed.json", json.dumps(found, indent=1))
    studies.write(OUT / "sweep_speed.md", text)
    _draw(timed)
    return found


def _words(seeds: str, epochs: int) -> list[str]:
    return [*WORDS, f"residual.outputs=[{OUTPUT}]", f"residual.seeds=[{seeds}]", f"residual.epochs={epochs}"]


def _hybridid(command: str, out: Path) -> list[str]:
    return [sys.executable, "-m", "hybridid_cli", command, f"paths.outputs={out}", "mlflow.enabled=false"]


def _out(way: str) -> Path:
    return OUT / way.replace(" ", "_")


def _one(way: str, seed: int, epochs: int) -> Timed:
    """The nine networks of one seed."""
    out = _out(way)
    own = _words(str(seed), epochs)
    if way == "sweep":
        wall, cpu, _ = _timed([*_hybridid("sweep", out), *own, f"sweep.processes={CORES}"])
        return Timed(
            way, seed, wall, cpu, _held_out_of_sweep(max(out.glob("sweeps/*"), key=os.path.getmtime))
        )
    if way == "plain loop":
        sizes = [f"residual.{key}={','.join(map(str, values))}" for key, values in GRID.items()]
        before = set(out.glob("vehicle/*/residual"))
        wall, cpu, _ = _timed([*_hybridid("residual", out), "-m", *own, *sizes])
        return Timed(way, seed, wall, cpu, _held_out_of(set(out.glob("vehicle/*/residual")) - before))
    wall, cpu, said = _timed([sys.executable, __file__, "--epochs", str(epochs), "--bare-loop", str(seed)])
    return Timed(way, seed, wall, cpu, json.loads(said))


def _timed(words: Sequence[str]) -> tuple[float, float, str]:
    """Wall seconds of a command, CPU seconds of the whole machine meanwhile, and what it printed.

    It prints to files: a pipe is open as long as any process that it has started is.
    """
    with TemporaryFile("w+") as said, TemporaryFile("w+") as complained:
        before, began = _busy(), time.perf_counter()
        code = subprocess.run(words, stdout=said, stderr=complained, check=False).returncode
        wall, cpu = time.perf_counter() - began, _busy() - before
        for file in (said, complained):
            file.seek(0)
        if code:
            raise SystemExit(f"{' '.join(words)}\n{complained.read()}")
        return wall, cpu, said.read()


def _busy() -> float:
    """CPU seconds of all processes since the machine started: a worker forked by a server is nobody's child
    whose time one could ask for."""
    user, nice, system = Path("/proc/stat").read_text().split()[1:4]
    return (int(user) + int(nice) + int(system)) / os.sysconf("SC_CLK_TCK")


def _held_out_of_sweep(folder: Path) -> dict[str, float]:
    cells = json.loads((folder / "sweep.json").read_text())["outputs"][0]["cells"]
    return {_size(c["at"]["residual.depth"], c["at"]["residual.width"]): c["held_out"]["mean"] for c in cells}


def _held_out_of(folders: Iterable[Path]) -> dict[str, float]:
    networks = [one for f in folders for one in json.loads((f / "residual.json").read_text())["networks"]]
    return {_size(one["depth"], one["width"]): one["held_out"] for one in networks}


def _size(depth: int, width: int) -> str:
    return f"{depth} x {width}"


def _bare_loop(seed: int, epochs: int) -> dict[str, float]:
    """Network after network by the very code that a stack trains with."""
    from hybridid.hybrid import errors_of, gray_runs
    from hybridid.residuals import training
    from hybridid_cli.composing import settings_of
    from pipelines.residual.narx import NARXRequest
    from pipelines.residual.stage import gray_box

    settings = settings_of(_words(str(seed), epochs), "run")
    request = NARXRequest.of(settings["residual"])
    (tree,) = {path.resolve().parent.parent for path in _out("bare loop").glob("vehicle/*/fit/stage.json")}
    gray = gray_box(settings, tree)
    tasks = request.tasks(gray.model, errors_of(gray_runs(gray, request.initial_state)))
    found = {}
    for task in tasks:
        one = training.train(task, request.training)
        found[_size(task.architecture.depth, task.architecture.width)] = one.held_out
    return found


def _together(seeds: int, epochs: int) -> dict[str, float]:
    """The grid with every seed in one command, in a folder where none of it is there yet."""
    out = OUT / "together"
    _timed([*_hybridid("fit", out), "case=vehicle", "data=simulated"])
    own = _words(",".join(map(str, range(seeds))), epochs)
    wall, cpu, _ = _timed([*_hybridid("sweep", out), *own, f"sweep.processes={CORES}"])
    return {"wall": wall, "cpu": cpu}


def _small(networks: int, epochs: int) -> dict[str, float]:
    """Ten sizes of at most 16 neurons a layer, as many seeds as it takes."""
    seeds = ",".join(str(100 + k) for k in range(networks // 10))  # other seeds than those of (a)
    sizes = ("residual.depth=[1,2,3,4,5]", "residual.width=[8,16]", f"sweep.processes={CORES}")
    wall, cpu, said = _timed([*_hybridid("sweep", _out("sweep")), *_words(seeds, epochs), *sizes])
    assert f"{networks} of {networks} points have results, 0 of them from before" in said, said
    return {"networks": networks, "wall": wall, "cpu": cpu}


def _ratios(timed: Sequence[Timed], together: dict[str, float] | None = None) -> dict[str, dict[str, float]]:
    """How often the time of the sweeps, or of the one ``together``, goes into each loop's, over all seeds."""
    total = {
        way: {kind: sum(getattr(t, kind) for t in timed if t.way == way) for kind in ("wall", "cpu")}
        for way in WAYS
    }
    ours = together or total["sweep"]
    return {way: {kind: total[way][kind] / ours[kind] for kind in ours} for way in WAYS[1:]}


def _report(
    timed: Sequence[Timed], together: dict[str, float], small: dict[str, float], given: argparse.Namespace
) -> str:
    lines = [f"Nine networks of Table 4.4, {given.epochs} epochs at most, simulated, {CORES} cores", ""]
    rows = []
    for way in WAYS:
        own = [t for t in timed if t.way == way]
        rows.append([way, *(", ".join(f"{getattr(t, kind):.1f}" for t in own) for kind in ("wall", "cpu"))])
    lines += [*studies.table(("way", "wall s, by seed", "CPU s, by seed"), rows), ""]
    cost = f"{together['wall']:.1f} s wall, {together['cpu']:.1f} s CPU"
    for what, ratios in (
        ("a sweep of one seed", _ratios(timed)),
        (f"one sweep of all {given.seeds} seeds ({cost})", _ratios(timed, together)),
    ):
        parts = (
            f"the {way} {r['wall']:.2f} times by wall, {r['cpu']:.2f} by CPU" for way, r in ratios.items()
        )
        lines.append(f"{what} is faster than {'; '.join(parts)}")
    sizes = []
    for size in timed[0].held_out:
        loop, swept = (_errors(timed, way, size) for way in ("plain loop", "sweep"))
        largest = max(abs(a - b) for a, b in zip(loop, swept, strict=True))
        sizes.append((size, _spread(loop), _spread(swept), f"{1e3 * largest:.3f} mm/s"))
    header = ("size", "held-out RMSE, plain loop", "sweep", "largest difference of one seed")
    wall = f"{small['wall']:.0f} s ({small['wall'] / 60:.1f} min) wall, {small['cpu']:.0f} s CPU"
    said = f"{small['networks']:.0f} small networks in one command: {wall}"
    return "\n".join([*lines, "", *studies.table(header, sizes), "", said])


def _errors(timed: Sequence[Timed], way: str, size: str) -> list[float]:
    return [t.held_out[size] for t in timed if t.way == way]


def _spread(values: Sequence[float]) -> str:
    deviation = f" ± {1e3 * stdev(values):.2f}" if len(values) > 1 else ""
    return f"{1e3 * fmean(values):.2f}{deviation} mm/s"


def _draw(timed: Sequence[Timed]) -> None:
    """Wall times beside the held-out errors of both."""
    from hybridid.plotting.looks import BLUE, DATA_GREY, VERMILION
    from hybridid.plotting.style import DOUBLE_COLUMN, Plot, context, new_figure, save

    with context():
        figure = new_figure(DOUBLE_COLUMN, 70, "nine networks of Table 4.4, vertical velocity", "simulated")
        times, errors = figure.subplots(1, 2, width_ratios=(1, 2))
        for row, (way, colour) in enumerate(zip(WAYS, (BLUE, VERMILION, DATA_GREY), strict=True)):
            own = [t.wall for t in timed if t.way == way]
            times.barh(row, fmean(own), color=colour, height=0.6)
            times.plot(own, [row] * len(own), "|", color="black")
        times.set_yticks(range(len(WAYS)), WAYS)
        times.invert_yaxis()
        times.set_xlabel("wall time [s]")
        for shift, (way, colour) in zip(
            (-0.12, 0.12), (("plain loop", VERMILION), ("sweep", BLUE)), strict=True
        ):
            for column, size in enumerate(timed[0].held_out):
                own = [1e3 * error for error in _errors(timed, way, size)]
                label = way if column == 0 else None
                errors.plot([column + shift] * len(own), own, "o", color=colour, markersize=3, label=label)
        errors.set_xticks(range(len(timed[0].held_out)), list(timed[0].held_out))
        errors.set_xlabel("layers x neurons [–]")
        errors.set_ylabel("held-out RMSE, a point a seed [mm/s]")
        errors.legend()
        caption = (
            "Wall time of nine networks, and their held-out errors, trained in a sweep and in a plain loop."
        )
        save(Plot(figure, "sweep_speed", caption, "simulated"), OUT, kinds=("svg",))


if __name__ == "__main__":
    main()
