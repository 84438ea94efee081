"""The controllers that hybridid knows, by the name under which a config asks for one."""

from __future__ import annotations

from collections.abc import Mapping

LAWS: Mapping[str, str] = {"emps_pd": "hybridid.controllers.emps_pd:EMPSPD"}
"""Name and import path of each."""
