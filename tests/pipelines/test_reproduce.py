"""The whole of ``reproduce`` on short records: the page, interruption, failure."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hybridid.quantities import estimated
from pipelines import reproduce as module
from pipelines.reproduce import reproduce
from pipelines.shared.errors import ConfigError, Incomplete
from pipelines.shared.storage import read_json

FREE, HORIZON = "emps_free_run", "emps_horizon"


@pytest.fixture
def experiments(settings, data):
    """Two experiments of Chapter 6, on short measured records."""
    return {
        FREE: settings({"estimator.horizon": None, "mlflow.enabled": False}),
        HORIZON: settings({"mlflow.enabled": False}),
    }


@pytest.fixture
def reproduced(experiments, heard, once):
    """The page of both, and what was said of the work."""
    page, heard.said, heard.works = once(
        "reproduced",
        lambda: (reproduce(experiments, Path("outputs"), heard, processes=1), heard.said, heard.works),
    )
    return page


def pages(folder="outputs"):
    return [(Path(folder) / "thesis" / f"index.{kind}").read_text() for kind in ("html", "md")]


def row(page, label):
    """The cells of a row of Markdown."""
    line = next(line for line in page.splitlines() if line.startswith(f"| {label} |"))
    return [cell.strip() for cell in line.strip("|").split("|")]


def value(cell):
    """``2.67·10⁻⁵`` or ``0.012`` as a number."""
    mantissa, _, exponent = cell.partition("·10")
    return float(mantissa) * 10.0 ** int(exponent.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0)


def test_the_page_is_written_twice_with_numbers_errata_and_figures(reproduced):
    assert reproduced == Path("outputs/thesis/index.html")
    html, markdown = pages()
    for text in (html, markdown):
        assert "Table 6.2: EMPS, estimates of the gray box" in text
        assert "It is the RMSE in metres" in text
        assert "Figure 6.1: identification record" in text
        assert "Table 5.4" not in text  # nobody asked for the eSEA
    assert row(markdown, "gray box")[-1] == "measured"
    assert row(markdown, "hybrid, 4 nodes")[2] == "not run"
    assert Path("outputs/thesis/figures/figure-6.1.svg").is_file()
    assert "(figures/figure-6.1.svg)" in markdown
    assert html.count("<img ") == 2  # 6.1 and 6.2; the others show a hybrid
    assert '<a href="#chapter-6' in html
    assert re.search(r'<section id="chapter-6', html)


def test_the_numbers_are_those_of_the_run_trees(reproduced):
    _, markdown = pages()
    masses = [read_json(tree / "fit/estimate.json")["parameters"]["M"] for tree in trees()]
    shown = {row(markdown, "M")[2], row(markdown, "M, fitted over 1 s")[2]}
    assert shown == {estimated(mass["value"], mass["std"], "") for mass in masses}


def trees():
    return [p for p in Path("outputs/short").iterdir() if not p.is_symlink()]


def test_every_line_says_which_experiment_and_since_when(reproduced, heard):
    assert re.match(r"\[0:0\d\] 1 of 2 emps_free_run: begins", heard.said[0])
    end = r"\[\d:\d\d\] 2 of 2 emps_horizon: done in \d+ s; 2 of 2 are done"
    assert any(re.fullmatch(end, line) for line in heard.said)
    assert any(re.match(r"thesis: 0 of 2 done, 0:\d\d; emps_free_run: fit: ", s) for s in heard.works)


def test_a_second_run_reuses_everything(experiments, reproduced, heard):
    first = pages()[1]
    heard.said.clear()
    reproduce(experiments, Path("outputs"), heard, processes=1)
    assert sum("fresh, reused" in line for line in heard.said) == 6
    assert not any("not made yet" in line or "stale" in line for line in heard.said)
    assert without_times(pages()[1]) == without_times(first)


def without_times(text):
    return re.sub(r"\| \d+ s \|", "|", text)


def test_an_interrupted_run_goes_on_where_it_stopped(experiments, heard):
    def strike(line):
        heard.said.append(line)
        if "2 of 2" in line and "fit: not made yet" in line:
            raise KeyboardInterrupt

    say, heard.say = heard.say, strike
    with pytest.raises(KeyboardInterrupt):
        reproduce(experiments, Path("outputs"), heard, processes=1)
    assert not Path("outputs/thesis").exists()
    heard.said.clear()
    heard.say = say
    reproduce(experiments, Path("outputs"), heard, processes=1)
    reused = [line for line in heard.said if "fresh, reused" in line]
    assert len(reused) == 4  # the first experiment's three stages, the second's records
    assert any("2 of 2 emps_horizon: fit: not made yet" in line for line in heard.said)


@pytest.mark.parametrize("processes", [1, 2])
def test_a_failure_is_named_on_the_page_and_spoils_no_other(experiments, settings, data, heard, processes):
    wrong = settings({"parameters.M.upper": 30.5, "parameters.M.lower": 31.0, "mlflow.enabled": False})
    experiments[HORIZON] = wrong
    with pytest.raises(Incomplete) as raised:
        reproduce(experiments, Path("outputs"), heard, processes=processes)
    message = str(raised.value)
    assert message.startswith(f"1 of 2 experiments failed: {HORIZON} (")
    assert "outputs/thesis/index.html" in message
    markdown = pages()[1]
    assert row(markdown, "M, fitted over 1 s")[2].startswith("failed: ")
    assert "±" in row(markdown, "M")[2]
    assert row(markdown, HORIZON)[-1].startswith("failed: ")
    assert any(HORIZON in line and "failed: " in line for line in heard.warned)
    traceback = Path(f"outputs/thesis/failed-{HORIZON}.txt").read_text()
    assert traceback.startswith("Traceback")


def test_a_mended_failure_leaves_no_trace(experiments, settings, heard):
    good = experiments[HORIZON]
    experiments[HORIZON] = settings({"parameters.M.lower": 200.0, "mlflow.enabled": False})
    with pytest.raises(Incomplete):
        reproduce(experiments, Path("outputs"), heard, processes=1)
    experiments[HORIZON] = good
    reproduce(experiments, Path("outputs"), heard, processes=1)
    assert not list(Path("outputs/thesis").glob("failed-*"))
    assert "failed" not in pages()[1]


def test_records_of_the_virtual_rig_are_said_to_be_simulated(settings, heard):
    simulated = {FREE: settings({"data": "simulated", "mlflow.enabled": False})}
    reproduce(simulated, Path("outputs"), heard, processes=1)
    html, markdown = pages()
    assert row(markdown, "gray box")[-1] == "simulated"
    assert "Data: simulated." in markdown
    assert "all numbers are simulated by the virtual rig" in markdown
    assert "(simulated): force" in html
    assert "(measured)" not in html


@pytest.mark.parametrize("processes", [0, -1, True])
def test_a_wrong_number_of_processes_is_said(experiments, heard, processes):
    with pytest.raises(ConfigError, match=r"processes is .*: at least 1, or null"):
        reproduce(experiments, Path("outputs"), heard, processes=processes)


def test_only_what_the_page_needs_is_run(reproduced):
    assert module.LAST_STAGE == "validate"
    assert not any((tree / "plot").exists() for tree in trees())


def test_a_network_inside_the_equations_has_all_figures_of_chapter_6(settings, data, heard):
    network = {"kind": "rbf", "nodes": [2], "max_iterations": 2}
    hybrid = settings({"residual": network, "mlflow.enabled": False})
    reproduce({"emps_rbf_4": hybrid}, Path("outputs"), heard, processes=1)
    drawn = {path.stem for path in Path("outputs/thesis/figures").iterdir()}
    assert drawn == {f"figure-6.{k}" for k in (1, 2, 4, 5, 6, 7, 8)}
    cells = row(pages()[1], "hybrid, 4 nodes")
    assert value(cells[2]) > 0
    assert cells[-1] == "measured"
    assert heard.warned == []
