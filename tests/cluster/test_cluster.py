"""The commands of examples/cluster on GNU parallel and Dask, with tasks and workers that are killed in the middle.

They make the bytes of one machine. slurm.sh tests Slurm.
"""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest
from distributed import LocalCluster

HERE = pathlib.Path(__file__).parent
PAGE = (pathlib.Path(os.environ["CORDA_EXAMPLES"]) / "cluster" / "README.md").read_text()
# The first file that the task makes that is killed.
FIRST_FILE = {"clips": "clips/shard-000001.tar", "frames": "frames/000090.png"}
ALONE = {"clips": "python3 -m corda sweep sweep.toml -o alone -q", "frames": "corda render swing.toml -o alone/%06d.png -q"}


def block(heading, language):
    """The lines of the first block of code below a heading of the page."""
    return re.search(rf"## {heading}\n.*?```{language}\n(.*?)```", PAGE, re.DOTALL)[1].splitlines()


class Work:
    """A sweep and a film in a folder that all tasks see. A shell would split the folder's name."""

    def __init__(self, parent):
        self.folder = parent / "shared folder"
        self.folder.mkdir()
        for file in ("swing.toml", "sweep.toml"):
            shutil.copy(HERE / file, self.folder)
        self.runs_file = parent / "runs"

    def start(self, command):
        return subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def wait_for_held_task(self, engine, option, output):
        """Returns the process of the task with this option, which is held once its first file is on the disk."""
        while not (self.folder / FIRST_FILE[output]).exists():
            assert engine.poll() is None, engine.stdout.read()
            time.sleep(0.01)
        lines = self.runs_file.read_text().splitlines()
        return [int(line.split()[0]) for line in lines if option in line][0]

    def expect_end(self, engine, option, output):
        """Expects an engine to end well, to have run the killed task twice, and the output of one machine."""
        text, _ = engine.communicate(timeout=120)
        assert engine.returncode == 0, text
        assert self.runs_file.read_text().count(option) == 2, text
        subprocess.run(ALONE[output], shell=True, cwd=self.folder, check=True, env=os.environ | {"HELD": ""})
        made, alone = (files_in(self.folder / name) for name in (output, "alone"))
        assert made == alone


def files_in(path):
    return {file.name: file.read_bytes() for file in path.iterdir() if not file.name.endswith(".tmp")}


@pytest.fixture
def work(tmp_path, monkeypatch):
    made = Work(tmp_path)
    monkeypatch.setenv("PATH", f"{HERE}:{os.environ['PATH']}")
    monkeypatch.setenv("RUNS", str(made.runs_file))
    yield made
    (tmp_path / "runs-release").touch()  # what a failed test has not killed ends


@pytest.mark.parametrize("option, output, lines", [("--shard 1/8", "clips", slice(0, 2)), ("--frames 90:180", "frames", slice(2, 3))])
def test_parallel_runs_a_killed_task_again(work, monkeypatch, option, output, lines):
    monkeypatch.setenv("HELD", option)
    commands = "\n".join(block("GNU parallel", "sh")[lines]).replace("--jobs 1", "--jobs 2")
    engine = work.start(["bash", "-euc", commands])
    os.kill(work.wait_for_held_task(engine, option, output), signal.SIGKILL)
    work.expect_end(engine, option, output)


def test_dask_runs_the_task_of_a_killed_worker_again(work, monkeypatch):
    option = "--shard 1/8"
    monkeypatch.setenv("HELD", option)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster:
        monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", cluster.scheduler_address)
        script = "\n".join(block("Dask", "python"))
        engine = work.start(["bash", "-euc", '"$0" -c "$1" && python3 -m corda sweep sweep.toml -o clips', sys.executable, script])
        task = work.wait_for_held_task(engine, option, "clips")
        worker = int(pathlib.Path(f"/proc/{task}/stat").read_text().split()[3])
        for process in (worker, task):  # as if their machine failed
            os.kill(process, signal.SIGKILL)
        work.expect_end(engine, option, "clips")
