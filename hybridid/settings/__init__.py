"""Settings: how one is declared and checked, and those of a fit. Imports nothing heavy.

Help, completion and the configuration reference are made from these declarations.
"""

from hybridid.settings.bounds import check
from hybridid.settings.declare import REQUIRED, Declared, Setting, declared, inlined, keys, setting

__all__ = ["REQUIRED", "Declared", "Setting", "check", "declared", "inlined", "keys", "setting"]
