"""The public archives that hybridid knows: one literal tuple, and the way to find one by name."""

from __future__ import annotations

from hybridid.fetch.archive import FetchError, PublicArchive
from hybridid.naming import unknown

# The addresses are the Google Drive objects that the benchmark's own loader downloads
# (PyPI nonlinear_benchmarks 1.0.1, benchmarks.py), in Drive's form for a direct download.
_DRIVE = "https://drive.google.com/uc?export=download&id="

ARCHIVES: tuple[PublicArchive, ...] = (
    PublicArchive(
        name="emps",
        url=f"{_DRIVE}1zwoXYa9-3f8NQ0ohzmjpF7UxbNgRTHkS",  # EMPS.zip, 1,949,929 bytes says the loader
        page="https://www.nonlinearbenchmark.org/benchmarks/emps",
        members={
            "DATA_EMPS.mat": "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e",
            "DATA_EMPS_PULSES.mat": "0eab75bb1f6b16228ee78791343a88bf9bfd9a51036ac9807d7b5fc11c0e1704",
        },
        licence="none stated; cite the authors",
        citation="A. Janot, M. Gautier, M. Brunot, Data Set and Reference Models of EMPS, "
        "2019 Workshop on Nonlinear System Identification Benchmarks, Eindhoven",
    ),
    PublicArchive(
        name="silverbox",
        url=f"{_DRIVE}17iS-6oBUUgrmiAcrZoG9S5sOaljZnDSy",  # SilverboxFiles.zip, 5,793,999 bytes
        page="https://www.nonlinearbenchmark.org/benchmarks/silverbox",
        # as two public audits of the archive printed it; they print the members' hashes below too
        sha256="2398dda503ac4c30f46c7a1ba09d8a8864d001cc71bbeb59f207a054cc592d8c",
        members={
            "SNLS80mV.csv": "ae62d5a91230c10f76e6dd02c8a4fac3c9d4d8a95fbf50e87cb0c4885003e0f1",
            "Schroeder80mV.csv": "b22cbcba9c59d9b4b1b379967b669dc32959e515b24784da3254505f8563e36c",
            "README.txt": "90c365916d60afc3cb208f772be40918175370cbcf43d1ada3df19b8a2c58ae8",
        },
        licence="none stated; cite the authors",
        citation="T. Wigren, J. Schoukens, Three free data sets for development and benchmarking in "
        "nonlinear system identification, 2013 European Control Conference, pp. 2933-2938",
    ),
)


def archive_named(name: str) -> PublicArchive:
    """The archive called ``name``.

    Raises:
        FetchError: if there is none; gives the nearest name.
    """
    for archive in ARCHIVES:
        if archive.name == name:
            return archive
    raise FetchError(unknown("public archive", name, [archive.name for archive in ARCHIVES]))
