"""A task that memory or time do not allow is refused in one line before it begins."""

from __future__ import annotations

import pytest

from hybridid.demand import Demand
from pipelines.runner import check_stages
from pipelines.shared import limits
from pipelines.shared.errors import ConfigError
from pipelines.shared.limits import available, check_and_tell, check_demand, check_points, check_processes
from pipelines.shared.sections.stages import LimitsSection


def test_the_memory_of_this_machine_is_the_limit(settings, monkeypatch):
    monkeypatch.setattr(limits, "available", lambda: 4e9)
    check_demand(Demand("the fit", 3.9e9, 1.0, ("k",)), settings())
    with pytest.raises(ConfigError) as refused:
        check_demand(Demand("the fit", 2.3e10, 1.0, ("residual.width (1000000)",)), settings())
    assert str(refused.value) == (
        "the fit would take about 23 GB of memory, and free here are 4 GB: lower residual.width (1000000), "
        "or raise limits.memory"
    )


def test_limits_of_the_config_take_its_place(settings):
    large = Demand("the fit", 3e9, 3 * 3600.0, ("k",))
    with pytest.raises(ConfigError, match=r"3 GB of memory, and limits\.memory allows 2 GB"):
        check_demand(large, settings({"limits.memory": 2.0}))
    with pytest.raises(ConfigError, match=r"at least 3 h, and limits\.hours allows 2 h: "):
        check_demand(large, settings({"limits.memory": 4.0, "limits.hours": 2.0}))
    check_demand(large, settings({"limits.memory": 4.0, "limits.hours": 2.0}), cores=2)
    with pytest.raises(ConfigError, match=r"limits\.memory is 0"):
        settings({"limits.memory": 0})


def test_a_long_task_says_so_before_it_begins(settings, heard):
    check_and_tell(Demand("the fit", 1e6, 60.0, ("k",)), settings(), heard)
    assert heard.said == []
    check_and_tell(Demand("the fit", 1e6, 380.0, ("estimator.substeps (1000000)",)), settings(), heard)
    check_and_tell(Demand("the fit", 1e6, 7200.0, ("k",)), settings(), heard)
    assert heard.said == [
        "the fit takes at least 6.3 min: lower estimator.substeps (1000000) to make it shorter",
        "the fit takes at least 2 h: lower k to make it shorter",
    ]


def test_what_is_available_is_a_sound_number():
    assert 1e7 < available() < 1e14


@pytest.mark.parametrize(
    ("changes", "command", "said"),
    [
        ({"residual.kind": "narx", "residual.width": [10**6]}, "residual", r"residual\.width \(1000000\)"),
        ({"residual.kind": "rbf", "residual.nodes": [10**5]}, "residual", r"residual\.nodes \(100000\)"),
        ({"residual.kind": "rbf", "residual.processes": 10**6}, "residual", r"residual\.processes"),
        ({"estimator.starts": 10**11}, "fit", r"estimator\.starts \(100000000000\)"),
        ({"trace.processes": 10**7}, "trace", r"trace\.processes"),
        ({"rig.duration": 1e12}, "preprocess", r"rig\.duration"),
    ],
)
def test_before_a_stage_runs(settings, changes, command, said):
    with pytest.raises(ConfigError, match=f"lower {said}, or raise limits.memory"):
        check_stages(settings({"data": "simulated", **changes}), command)


def test_processes_and_points(settings):
    check_processes(None, "sweep.processes", settings())
    check_processes(2, "sweep.processes", settings())
    with pytest.raises(ConfigError, match=r"1000000 processes side by side .* lower sweep\.processes"):
        check_processes(10**6, "sweep.processes", settings())
    check_points(100, LimitsSection())
    with pytest.raises(ConfigError, match=r"a sweep of 10,000,000 points"):
        check_points(10**7, LimitsSection())
