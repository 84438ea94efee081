"""``Case``: one bad input as data, what it must be answered with, and what is wrong with an answer."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from hybridid_cli.explain import FAILED, NOT_CONVERGED, WRONG_MODEL, WRONG_REQUEST

Content = str | bytes | Callable[[Path], None]
"""A file's text, its bytes, or what writes it, given its path."""
LONGEST = 600
"""Characters of a line that a person still reads."""
LONGEST_MESSAGE = 20_000
"""Characters of a message before the terminal shortens it."""
REFUSED = (FAILED, WRONG_REQUEST)
"""Exit codes of an input that must be refused."""
BORNE = (0, FAILED, WRONG_REQUEST, NOT_CONVERGED, WRONG_MODEL)
"""Of one that may be right: a fit, a refusal, or a fit that is told to be no good."""
UNFINISHED = (".unfinished-", ".replaced-", ".part", ".tmp")


@dataclass(frozen=True)
class Case:
    """``hybridid`` with ``words`` in a folder that holds the example lab and ``files`` (name: content).

    ``codes`` are the exit codes that are right, ``says`` parts of the last line on stderr, any spelling of
    large and small letters. Where 0 is among the codes, the input is rightly borne, and ``says`` is
    looked for in all that was printed.
    """

    name: str
    words: tuple[str, ...]
    says: tuple[str, ...] = ()
    codes: tuple[int, ...] = REFUSED
    files: Mapping[str, Content] = field(default_factory=dict)
    seconds: float = 60.0
    """After which it counts as hanging."""


@dataclass(frozen=True)
class Said:
    """What a command answered. ``code`` is negative for a signal; ``left`` are the files in its folder."""

    code: int
    out: str
    err: str
    seconds: float
    left: tuple[str, ...] = ()

    @property
    def complaint(self) -> str:
        """The last line on stderr."""
        return self.err.strip().splitlines()[-1] if self.err.strip() else ""

    def __str__(self) -> str:
        return f"exit code {self.code}: {self.complaint[:120]}"


def faults(case: Case, said: Said) -> Iterator[str]:
    """What is wrong with the answer; nothing if all is well."""
    if said.seconds >= case.seconds:
        yield f"no answer within {case.seconds:g} s"
    if said.code not in case.codes:
        yield f"exit code {said.code}, expected {' or '.join(map(str, case.codes))}"
    if "Traceback (most recent call last)" in said.out + said.err:
        yield "a traceback"
    if said.code:
        yield from _bad_line(said.complaint)
    heard = (said.out + said.err if 0 in case.codes else said.complaint).lower()
    for part in case.says:
        if part.lower() not in heard:
            yield f"does not say {part!r}"
    for name in said.left:
        if any(mark in name for mark in UNFINISHED):
            yield f"left behind: {name}"


def _bad_line(line: str) -> Iterator[str]:
    """What is wrong with a complaint, whatever it is about."""
    if not line.startswith("hybridid: "):
        yield "the last line is no message of hybridid"
    if len(line) > LONGEST:
        yield f"a line of {len(line)} characters"
    if "--debug shows where" in line:
        yield "a raw exception: the message speaks to the maker, not to the engineer"
    words = line.removeprefix("hybridid: ").split(": ")
    if any(a == b for a, b in itertools.pairwise(words)):
        yield "says a part twice"


def check_line(refused: Exception) -> None:
    """Check that what is refused is refused in a line.

    Raises:
        AssertionError: if not.
    """
    said = str(refused)
    assert said.strip(), "it says nothing"
    assert "\n" not in said, said
    assert len(said) <= LONGEST_MESSAGE, said[:300]
