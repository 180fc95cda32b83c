"""Settings of Sphinx for the site. docs/make.sh builds it from the Markdown files where they stand."""

project = "taut"
author = "the authors of taut"
root_doc = "docs/index"
extensions = ["myst_parser", "sphinx.ext.autodoc"]
include_patterns = ["docs/*.md", "docs/lab/README.md", "docs/paper/README.md", "CHANGELOG.md", "README.md",
                    "CONTRIBUTING.md", "constraints/README.md", "systems/README.md",
                    "systems/KEYS.md", "lammps/README.md", "benchmarks/README.md", "benchmarks/HISTORY.md", "tests/README.md",
                    "tests/portability/README.md", "docs/study/README.md", "openmm_plugin/README.md",
                    "conformance/README.md", "conformance/MATRIX.md"]
myst_heading_anchors = 4  # the names that GitHub gives to headings
suppress_warnings = ["myst.xref_missing"]  # links to files that are no pages; tests/named_files.py checks all links
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
html_theme = "furo"
html_title = "taut"
html_show_copyright = False
html_copy_source = html_show_sourcelink = False


def setup(app):
    """Escapes the bars of |x| in docstrings, which reStructuredText takes for a substitution."""
    def escape_bars(app, what, name, thing, options, lines):
        lines[:] = [line.replace("|", "\\|") for line in lines]

    app.connect("autodoc-process-docstring", escape_bars)
