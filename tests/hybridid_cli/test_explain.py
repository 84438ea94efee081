"""What the machine refuses is said in one line, without words for the maker."""

from __future__ import annotations

import errno

from hybridid_cli.exit_codes import FAILED
from hybridid_cli.explain import explained


def test_a_full_disk_that_names_no_file_costs_one_line():
    """As a stream raises it that is flushed."""
    said, code = explained(OSError(errno.ENOSPC, "No space left on device"), "fit", [])
    assert said == (
        "writing a file: no space left on device; what was unfinished is discarded, what was finished is kept"
    )
    assert code == FAILED


def test_memory_that_does_not_suffice_costs_one_line():
    said, code = explained(MemoryError("Unable to allocate 374. GiB"), "fit", [])
    assert said == (
        "the memory of this machine does not suffice: Unable to allocate 374. GiB; make the task smaller"
    )
    assert code == FAILED


def test_keys_are_listed_in_one_order(say):
    """They came in another order each time."""
    said = say("trace", "case=emps", "trace.network=false")
    listed = said.err.partition("allowed: ")[2].strip().split(", ")
    assert listed == sorted(listed)
    assert "trace.worth" in listed
