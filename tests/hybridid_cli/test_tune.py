"""``hybridid tune``: two workers on one search, its result on the terminal, the config it leaves taken up."""

from __future__ import annotations

import re
from pathlib import Path

NETWORK = (
    "residual=narx", "residual.orders={error: 2, inputs: 1, gray: 1}", "residual.depth=1", "residual.width=4",
    "residual.seeds=[0]", "residual.every=5", "residual.horizons=[1]", "residual.epochs=4",
)  # fmt: skip
SPACE = (
    "tune.space.residual.width.high=8", "tune.space.residual.depth=null", "tune.trials=3", "tune.startup=2",
    "tune.processes=2", "out=search",
)  # fmt: skip


def test_search_and_take_up(say, quick):
    said = say("tune", *quick, *NETWORK, *SPACE)
    assert said.code == 0, said.err
    trials = re.findall(r"trial (\d+): width=\d .*: (?:held-out share|pruned)", said.err)
    assert sorted(trials) == ["0", "1", "2"]
    assert "(simulated)" in said.out
    assert "chosen: trial" in said.out
    command = re.search(r"hybridid run (--config-dir search experiment=tuned)", said.out)[1].split()
    taken = say("residual", *command, "out=again", "mlflow.enabled=false")
    assert taken.code == 0, taken.err
    assert Path("again/residual/hybrid.json").exists()

    again = say("tune", *quick, *NETWORK, *SPACE)
    assert again.code == 0
    assert "continues a search: 3 of 3 trials are done in search" in again.err
    assert not re.search(r"trial \d+: width", again.err)
