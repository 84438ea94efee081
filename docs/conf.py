"""How Sphinx builds the documentation: ``make docs``.

The source folder is the repository's root, so that the Markdown pages link to each other as they do on a git
server. From the docstrings, Sphinx writes one page for each module of ``hybridid`` into ``docs/api/``,
which git ignores.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.util import logging

ROOT = Path(__file__).parents[1]
# the pages describe this checkout, wherever hybridid is installed
sys.path.insert(0, str(ROOT))

project = "hybridid"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"]
root_doc = "docs/index"
include_patterns = ["*.md", "docs/**", "data/README.md", "outputs/README.md", "benchmarks/**.md"]
# folders that Sphinx need not look into
exclude_patterns = ["**/.*", ".*", "data/[!R]*", "outputs/[!R]*", "docs/_templates", "build", "dist"]
# whole: autosummary looks from the source folder, HTML from this one
templates_path = [str(ROOT / "docs" / "_templates")]
smartquotes = False
html_theme = "furo"
html_title = "hybridid"
html_copy_source = False
html_show_copyright = False

myst_heading_anchors = 3
myst_enable_extensions = ["dollarmath"]
# two modules may each have a class of one name, which a type hint then cannot tell apart
suppress_warnings = ["ref.python"]
autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_type_aliases = {"Array": "Array"}
maximum_signature_line_length = 100
napoleon_numpy_docstring = False
napoleon_custom_sections = [("Source", "notes_style"), ("Shapes", "notes_style")]

SECTION = re.compile(r"[A-Z]\w+:$")
LIST_OR_DIRECTIVE = re.compile(r"[-*.] |\d+\. |\.\. |>>>|.*::$")


def plain_text_to_rst(app: Sphinx, what: str, name: str, obj: object, options: Any, lines: list[str]) -> None:
    """Make an indented equation a literal block, and let ``|v|`` in a sentence be an absolute value."""
    text: list[str] = []
    above, in_section, in_block = "", False, False
    for line in lines:
        if line.strip() and not line.startswith(" "):
            above, in_section, in_block = line, bool(SECTION.match(line)), False
        elif line.strip() and not in_section and not in_block:
            in_block = True
            if text and not text[-1] and not LIST_OR_DIRECTIVE.match(above):
                text += ["::", ""]
        text.append(line if in_block else re.sub(r"(``.*?``)|\|", lambda m: m[1] or r"\|", line))
    # the blank line keeps napoleon from reading the words before a colon as a type
    lines[:] = ["", *text] if what in {"data", "attribute", "property"} else text


def toctree_of_the_table(app: Sphinx, docname: str, source: list[str]) -> None:
    """Give the front page a table of contents: the pages that its own table links to, in that order.

    A toctree in the page itself would show as a block of code on a git server.
    """
    if docname == root_doc:
        pages = dict.fromkeys(re.findall(r"\]\(([\w./-]+)\.md\)", source[0]))
        source[0] += "\n".join(["\n", "```{toctree}", ":hidden:", "", *pages, "```", ""])


def every_module_has_a_page(app: Sphinx, error: Exception | None) -> None:
    """Warn of a public module of ``hybridid`` without a page; ``make docs`` takes a warning for an error."""
    files = [path.relative_to(ROOT).with_suffix("") for path in (ROOT / "hybridid").rglob("*.py")]
    modules = {".".join(path.parts) for path in files if not path.name.startswith("_")}
    for missing in sorted(modules - {page.stem for page in (ROOT / "docs" / "api").glob("*.rst")}):
        logging.getLogger(__name__).warning("%s has no page of the API", missing)


def setup(app: Sphinx) -> None:
    """Connect the hooks; that of the docstrings runs before napoleon reads their sections."""
    # pages of an earlier build may name modules that no longer exist
    shutil.rmtree(ROOT / "docs" / "api", ignore_errors=True)
    app.connect("autodoc-process-docstring", plain_text_to_rst, priority=400)
    app.connect("source-read", toctree_of_the_table)
    app.connect("build-finished", every_module_has_a_page)
