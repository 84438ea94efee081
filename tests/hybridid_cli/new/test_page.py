"""``docs/your-machine.md``: its commands run on simulated recordings and give what the page says."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from pipelines.new.template import kinds

PAGE = (Path(__file__).parents[3] / "docs" / "your-machine.md").read_text()
SECTIONS = dict(re.findall(r"(?ms)^### (\w+)\n(.*?)(?=^##|\Z)", PAGE))


def commands(text: str) -> list[list[str]]:
    return [line.split()[1:] for line in text.splitlines() if line.startswith("hybridid ")]


def test_the_page_has_a_section_for_each_template():
    assert SECTIONS.keys() == set(kinds())


@pytest.mark.parametrize("kind", SECTIONS)
def test_a_template_s_commands_find_what_was_simulated(kind, machine, say, own_folder):
    """The fit finds the planted parameters; nothing is missing in the machine, and nothing is said to be."""
    (own_folder / f"{kind}.csv").write_text(machine(kind).text, encoding="utf-8")
    lines = commands(SECTIONS[kind])
    assert [line[0] for line in lines] == ["new", "trace"]
    for line in lines:
        said = say(*line)
        assert said.code == 0, said.complaint
    assert said.out.startswith("nothing missing")
    (file,) = own_folder.glob("outputs/*/latest/fit/estimate.json")
    found = json.loads(file.read_text())["parameters"]
    truth = machine(kind).truth
    assert {name: found[name]["value"] for name in truth} == pytest.approx(truth, rel=0.02)


def test_the_first_example_finds_what_the_template_does_not_declare(machine, say, own_folder):
    (own_folder / "slide.csv").write_text(machine("slide").text, encoding="utf-8")
    new, run, trace = commands(PAGE[: PAGE.index("## What `new` finds out")])
    made = say(*new)
    told = re.search(r"```\n(slide: .*?)\n```", PAGE, flags=re.DOTALL)
    assert told[1] in made.out
    assert "\n".join(machine("slide").text.split("\n")[:2]) in PAGE
    assert say(*run).code == 0
    found = say(*trace).out
    sentence = re.search(r"```\n(effect found: .*?)\n```", PAGE, flags=re.DOTALL)[1].replace("\n", " ")
    number = r"df_v = −0\.\d+"
    assert found.startswith(sentence[: sentence.index("(df_v")])
    assert float(re.search(number, found)[0].split("−")[1]) == pytest.approx(0.8, rel=0.01)
