# SPDX-License-Identifier: BSD-3-Clause
"""The package as it was installed: types, what it carries, and the notebook."""

import pathlib
import re
import subprocess
import sys

import nbclient
import nbformat
import pytest
from conftest import SOURCE

import jink

HERE = pathlib.Path(__file__).parent
FOLDER = pathlib.Path(jink.__file__).parent


def test_is_the_installed_one():
    assert SOURCE not in FOLDER.parents or "site-packages" in FOLDER.parts
    assert f'define JINK_VERSION "{jink.__version__}"' in (SOURCE / "planner/base/version.hpp").read_text()


def test_names_no_place_of_the_machine_that_built_it():
    files = [file for file in FOLDER.rglob("*") if file.is_file() and file.suffix != ".pyc"]
    assert len(files) > 20 and not [file for file in files if str(SOURCE).encode() in file.read_bytes()]


def test_does_without_pandas_until_it_is_needed():
    script = "import jink, sys; sys.exit('pandas' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


@pytest.mark.parametrize("what", [["client.py"], ["--disable-error-code", "import-untyped", "--allow-untyped-calls", "-p", "jink"]])
def test_is_typed(what, tmp_path):
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path, *what], cwd=HERE, text=True,
                          capture_output=True, check=False)
    assert done.returncode == 0, done.stdout


def test_every_name_is_there_and_says_what_it_is():
    for name in jink.__all__:
        assert name == "__version__" or getattr(jink, name).__doc__, name


def test_the_document_does_what_it_says(arena, study, tmp_path, monkeypatch):
    """Its pieces of code, one after the other, in a folder with the files that it names."""
    monkeypatch.chdir(tmp_path)
    pathlib.Path("arena").symlink_to(arena)
    pathlib.Path("study").symlink_to(study)
    pathlib.Path("mine.yaml").write_text((jink.config_folder() / "planner.yaml").read_text())
    names = {}
    pieces = re.findall(r"^```python\n(.*?)^```", (SOURCE / "docs/python.md").read_text(), re.DOTALL | re.MULTILINE)
    for piece in pieces:
        exec(compile(piece, "docs/python.md", "exec"), names)
    assert len(pieces) == 5 and names["plan"].status == "reaches" and names["result"].reached and len(names["front"]) > 10


@pytest.mark.parametrize("notebook", sorted((SOURCE / "examples").rglob("*.ipynb")), ids=lambda file: file.name)
def test_a_notebook_runs(notebook):
    content = nbformat.read(notebook, as_version=4)
    assert not [cell for cell in content.cells if cell.get("outputs") or cell.get("execution_count")], "outputs are stripped"
    nbclient.NotebookClient(content, timeout=300, kernel_name="python3",
                            resources={"metadata": {"path": str(notebook.parent)}}).execute()
    assert [output for cell in content.cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]
