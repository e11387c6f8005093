"""`python3 -m corda`: its words and errors, standard streams that take nothing, and Ctrl-C while it starts."""

import json
import os
import subprocess
import sys

import pytest

CORDA = f"'{sys.executable}' -m corda"
SCENE = os.path.join(os.environ["CORDA_EXAMPLES"], "first.toml")


def shell(line, **options):
    return subprocess.run(["sh", "-c", line.format(corda=CORDA, scene=f"'{SCENE}'")], capture_output=True, text=True, **options)


@pytest.mark.parametrize("line, code, said", [
    ("report {scene} -o out --dry-run -q --json >&-", 6, "writing to standard output: Bad file descriptor"),
    ("report {scene} -o out --dry-run -q --json >/dev/full", 6, "writing to standard output: No space left on device"),
    ("report --help >/dev/full", 6, "writing to standard output: No space left on device"),
    ("sweep --help >&-", 6, "writing to standard output: Bad file descriptor"),
    ("--help >/dev/full", 6, "writing to standard output: No space left on device"),
    ("--version >&-", 6, "writing to standard output: Bad file descriptor"),
    ("report --help | true", 0, ""),
    ("report - -o out <&-", 6, "standard input is closed"),
    ("swep 2>/dev/full", 2, ""),
    ("swep 2>&-", 2, "")])
def test_closed_and_full_streams(line, code, said, tmp_path):
    ended = shell("{corda} " + line, cwd=tmp_path)
    assert ended.returncode == code, ended.stderr
    assert ended.stderr == "" if not said else ended.stderr.startswith(f"corda: error: {said}"), ended.stderr
    assert len(ended.stderr.splitlines()) == bool(said) and ended.stdout == ""
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words, said", [
    ("swep --json", "there is no command 'swep' of Python; give sweep or report"),
    ("--json swep", "there is no command 'swep' of Python"),
    ("--json", "give a command: sweep or report"),
    ("--json report", "-o/--output"),
    ("report --json", "-o/--output")])
def test_errors_are_json(words, said):
    ended = shell("{corda} " + words)
    error = json.loads(ended.stdout)["error"]
    assert error["code"] == ended.returncode == 2 and said in error["message"]
    assert said in ended.stderr and len(ended.stderr.splitlines()) == 1


def test_options_may_stand_before_the_command(tmp_path):
    ended = shell("{corda} --json report {scene} -o out --dry-run", cwd=tmp_path)
    assert ended.returncode == 0 and json.loads(ended.stdout)["schema"] == 1, ended.stderr
    assert "usage: python3 -m corda report" in shell("{corda} report --help").stdout
    assert "usage: python3 -m corda COMMAND" in shell("{corda} --help").stdout


def test_an_interruption_while_numpy_is_imported_has_no_traceback(tmp_path):
    (tmp_path / "numpy.py").write_text("import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(60)\n")
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    ended = shell("{corda} report", env={**os.environ, "PYTHONPATH": path})
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "")
