"""``docs/your-machine.md``: its commands run on simulated recordings and give what the page says."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from benchmarks.strangers.play import SLOW
from benchmarks.strangers.servo import ALLOWED, edited, said_on_page
from hybridid.model import compose
from hybridid.plants.servo import FIRMWARE, GRAVITY, Servo
from pipelines.new.template import kinds, template

PAGE = (Path(__file__).parents[3] / "docs" / "your-machine.md").read_text()
EFFORTS, FLOWS = "coulomb,quadratic_drag", "linear_leak,overflow"
TRACED = ("carriage", "two_tanks", "vehicle", "dc_motor")
"""Templates whose trace is run here, one of each kind of port and of those with constants given."""
SECTIONS = dict(re.findall(r"(?ms)^### (\w+)\n(.*?)(?=^##|\Z)", PAGE))


def commands(text: str) -> list[list[str]]:
    return [line.split()[1:] for line in text.splitlines() if line.startswith("hybridid ")]


def few(effects: str) -> tuple[str, ...]:
    """What makes a trace of the page short: these ``effects`` alone, learned efforts and flows over two
    variables, in this process."""
    variables = "trace.variables=[velocity,level]"
    return f"trace.effects=[{effects}]", variables, "trace.processes=1", "mlflow.enabled=false"


def test_the_page_has_a_section_for_each_template():
    assert SECTIONS.keys() == set(kinds())


@pytest.mark.parametrize("kind", SECTIONS)
def test_a_template_s_commands_find_what_was_simulated(kind, machine, say, own_folder, request):
    """The fit finds the planted parameters; nothing is missing in the machine, and nothing is said to be.
    Here the trace of some templates tries a few effects, and draws figures of the two tanks alone; the others
    are fitted. ``make study-strangers`` traces all with all effects, and draws all."""
    if kind != "two_tanks":
        request.getfixturevalue("no_figures")
    (own_folder / f"{kind}.csv").write_text(machine(kind).text, encoding="utf-8")
    new, trace = commands(SECTIONS[kind])
    assert (new[0], trace[0]) == ("new", "trace")
    traced = [*trace, *few(FLOWS if kind in SLOW else EFFORTS), "trace.laws=false"]
    for line in (new, traced if kind in TRACED else ["fit", *trace[1:], "mlflow.enabled=false"]):
        said = say(*line)
        assert said.code == 0, said.complaint
    assert kind not in TRACED or said.out.startswith("nothing missing")
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
    assert say(*run, "mlflow.enabled=false").code == 0
    found = say(*trace, *few(f"{EFFORTS},asymmetric_viscous,asymmetric_coulomb")).out
    sentence = re.search(r"```\n(effect found: .*?)\n```", PAGE, flags=re.DOTALL)[1].replace("\n", " ")
    number = r"df_v = −0\.\d+"
    assert found.startswith(sentence[: sentence.index("(df_v")])
    assert float(re.search(number, found)[0].split("−")[1]) == pytest.approx(0.8, rel=0.01)


def test_the_page_s_servo_has_the_equations_of_the_packaged_one():
    """The diff of the page, made on the template: at random states the two differ by rounding alone."""
    plan = template("servo")
    _, block, of_case = said_on_page()
    space: dict[str, object] = {}
    exec(edited(block, plan.code("xl330", {})), space)
    added = [line for line in (block + of_case).splitlines() if line.startswith("+")]
    assert len(added) <= ALLOWED
    ours, packaged = (compose(one, ["viscous", "coulomb"]) for one in (space["Servo"](), Servo()))
    known = packaged.values({"q_0": 0.03})
    values = dict(zip([p.name for p in packaged.parameters], known, strict=True))
    weight = values["m"] * GRAVITY * values["l"]
    inertia = values["J"] + values["m"] * values["l"] ** 2
    values |= {"J": inertia, "G": weight, "k_p": 400 * FIRMWARE, "U": 7.4}
    p = ours.values({p.name: values[p.name] for p in ours.parameters})
    for q, w, goal, on in np.random.default_rng(0).uniform(-1, 1, (20, 4)):
        on = float(on > 0)
        for name in ("f", "h"):
            found = getattr(ours, name)(0, [q, w], [goal, on], p).full()
            assert found == pytest.approx(
                getattr(packaged, name)(0, [q, w], [goal, 400, 7.4, on], known).full()
            )
