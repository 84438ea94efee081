"""What a verdict on a fit says."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hybridid.quality.hypotheses import Hypothesis
from hybridid.quality.words import explained


@pytest.mark.parametrize(("released", "says"), [(("c_d",), True), ((), False)])
def test_a_value_beyond_a_bound_may_be_another_law(released, says):
    windows = SimpleNamespace(lengths=[101], dt=0.01)
    best, given = (
        SimpleNamespace(share=share, data=SimpleNamespace(problem=SimpleNamespace(windows=windows)))
        for share in (0.00012, 0.0095)
    )
    said = explained(
        [Hypothesis("bound", "c_d wants to leave the bounds", (1.0,), (0,), 0, released)], best, given
    )
    assert said.startswith("the records say that c_d wants to leave the bounds: the same model then leaves")
    assert said.endswith("another law is there, which hybridid trace looks for") is says
