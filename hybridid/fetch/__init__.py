"""Public records: downloaded once, checked against their SHA-256, kept."""

from hybridid.fetch.archive import FetchError, PublicArchive
from hybridid.fetch.library import ARCHIVES, archive_named
from hybridid.fetch.retrieve import fetch

__all__ = ["ARCHIVES", "FetchError", "PublicArchive", "archive_named", "fetch"]
