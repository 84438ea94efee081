"""Everything that ``trace.json`` says, put together from what was found and proved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hybridid.naming import listed
from hybridid.trace.ceiling import Ceiling
from hybridid.trace.split import Split
from hybridid.trace.verdict import Trace
from pipelines.shared.augmented import augmented, commands
from pipelines.shared.config import Settings
from pipelines.shared.findings import Prepared
from pipelines.trace.complete import Completed, completeness
from pipelines.trace.findings import (
    accepted_entries,
    ceiling_entry,
    estimate_entries,
    floor_entries,
    path_entries,
    rejected_entries,
    step_entries,
)
from pipelines.trace.proof import Proof
from pipelines.trace.request import Request, own_effects
from pipelines.trace.words import sentence


@dataclass(frozen=True)
class Story:
    """A finished trace. ``proofs`` are of the declared and, if anything was accepted, the augmented model,
    ``ceilings`` and ``networks`` theirs; ``fitted`` and ``held_out`` are the records that served each way."""

    settings: Settings
    request: Request
    split: Split
    fitted: Sequence[Prepared]
    held_out: Sequence[Prepared]
    found: Trace
    proofs: Sequence[Proof]
    ceilings: Sequence[Sequence[Ceiling]]
    networks: Sequence[Completed]

    @property
    def provenance(self) -> str:
        """``measured``, ``simulated``, or both."""
        return listed(sorted({r.provenance for r in (*self.fitted, *self.held_out)}))

    @property
    def judged(self) -> str:
        """Which horizons judged, in words."""
        length = f"{self.request.horizon:g} s horizons"
        if self.held_out:
            return f"{length} of {listed([r.name for r in self.held_out])}, held out"
        return f"alternate {length} of {listed([r.name for r in self.fitted])}, held out"

    @property
    def augmented(self) -> Settings:
        """The case's settings with what was accepted."""
        terms = self.found.model.terms[len(self.found.model.terms) - len(self.found.accepted) :]
        paths = {path.partition(":")[2]: path for path in own_effects(self.settings)}
        return augmented(self.settings, terms, paths, self.proofs[-1].estimate)

    def _rows(self, model: int) -> list[dict[str, Any]]:
        """Metrics of a proved model, and of it with the network of the completeness check."""
        alone = [{**row, "network": False} for row in self.proofs[model].rows]
        networks = self.networks[model].rows if self.networks else ()
        return [*alone, *({**row, "network": True} for row in networks)]

    def data(self, model_file: Path, seconds: float) -> dict[str, Any]:
        """``trace.json``."""
        search, before, after = self.found.search, self.proofs[0], self.proofs[-1]
        data = {
            "case": self.settings.case,
            "provenance": self.provenance,
            "verdict": self.found.verdict,
            "sentence": "",
            "accepted": accepted_entries(self.found, after.estimate),
            "rejected": rejected_entries(search),
            "before": self._rows(0),
            "after": self._rows(-1),
            "noise_floor": floor_entries(self.found, self.found.model),
            "seconds": seconds,
            "declared": [term.name for term in before.model.terms],
            "effects": [term.name for term in self.found.model.terms],
            "estimates": {
                "before": estimate_entries(before.estimate),
                "after": estimate_entries(after.estimate),
            },
            "path": path_entries(search),
            "ceilings": {
                "before": [ceiling_entry(c) for c in self.ceilings[0]],
                "after": [ceiling_entry(c) for c in self.ceilings[-1]],
            },
            "remains": list(self.found.remains),
            "completeness": completeness(self.networks, self.request.rules),
            "stopped": search.stopped,
            "split": self.split.described,
            "horizon": self.request.horizon,
            "horizons": [len(self.split.fitted), len(self.split.held_out)],
            "rules": asdict(self.request.rules),
            "processes": self.request.processes,
            "fitted_records": [r.name for r in self.fitted],
            "records": [_record(r, "fitted") for r in self.fitted]
            + [_record(r, "held out") for r in self.held_out],
            "commands": list(commands(self.augmented, model_file, self.split.horizon)),
            "steps": step_entries(search),
        }
        return {**data, "sentence": sentence(data)}


def _record(prepared: Prepared, role: str) -> dict[str, Any]:
    kept = {key: prepared.row[key] for key in ("source", "digest", "n", "dt")}
    return {"name": prepared.name, "role": role, "provenance": prepared.provenance, **kept}
