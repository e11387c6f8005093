"""The scripts of examples/cluster on GNU parallel and Dask, and the commands of its Kubernetes Jobs.

Each makes the bytes of one machine, also if a task or a worker is killed in the middle. slurm.sh tests Slurm.
"""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import types

import kubernetes.client
import pytest
import yaml
from distributed import LocalCluster

HERE = pathlib.Path(__file__).parent
EXAMPLES = pathlib.Path(os.environ["CORDA_EXAMPLES"]) / "cluster"
# Command, its output, and the first file that shard 1 of 4 finishes.
WORKS = {"film": ("render swing.toml -o", "swing.mp4", "swing.mp4.parts/000001-*"),
         "sweep": ("sweep sweep.toml -o", "clips", "clips/shard-000001.tar")}


class Work:
    """A film or a sweep in a folder that all tasks see. A shell would split the folder's name."""

    def __init__(self, parent, name):
        self.folder = parent / "shared folder"
        self.folder.mkdir()
        for file in ("swing.toml", "sweep.toml"):
            shutil.copy(HERE / file, self.folder)
        self.runs_file = parent / "runs"
        self.words, self.output, self.first_file = WORKS[name]
        self.command = ["corda", *self.words.split(), self.output]

    def start(self, command):
        return subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def runs_of(self, shard):
        """The processes that have made a shard."""
        lines = self.runs_file.read_text().splitlines()
        return [int(line.split()[0]) for line in lines if line.endswith(f"--shard {shard}")]

    def wait_for_first_file(self, engine):
        """Returns the process that makes shard 1, which is held once its first file is on the disk."""
        while not list(self.folder.glob(self.first_file)):
            assert engine.poll() is None, engine.stdout.read()
            time.sleep(0.01)
        return self.runs_of("1/4")[0]

    def expect_output_of_one_machine(self):
        program = os.environ["CORDA_PROGRAM"]
        subprocess.run([program, *self.words.split(), "alone-" + self.output, "-q"], cwd=self.folder, check=True)
        assert bytes_below(self.folder / self.output) == bytes_below(self.folder / ("alone-" + self.output))

    def expect_end(self, engine):
        """Expects an engine to end well, and to have made shard 1 twice."""
        text, _ = engine.communicate(timeout=120)
        assert engine.returncode == 0, text
        runs = [len(self.runs_of(f"{i}/4")) for i in range(4)]
        assert runs[1] == 2 and min(runs) >= 1, text  # Dask also repeats the tasks that a lost worker had finished
        self.expect_output_of_one_machine()


def bytes_below(path):
    files = [path] if path.is_file() else sorted(path.iterdir())
    return {"" if file == path else file.name: file.read_bytes() for file in files}


@pytest.fixture(params=WORKS)
def work(request, tmp_path, monkeypatch):
    made = Work(tmp_path, request.param)
    monkeypatch.setenv("PATH", f"{HERE}:{os.environ['PATH']}")
    monkeypatch.setenv("RUNS", str(made.runs_file))
    yield made
    (tmp_path / "runs-release-1").touch()  # what a failed test has not killed ends


def test_parallel_runs_a_killed_task_again(work, monkeypatch):
    monkeypatch.setenv("PARALLEL", "--jobs 2")
    monkeypatch.setenv("HELD_SHARDS", "1/4")
    engine = work.start([EXAMPLES / "parallel.sh", "4", *work.command])
    os.kill(work.wait_for_first_file(engine), signal.SIGKILL)
    work.expect_end(engine)


def test_dask_runs_the_task_of_a_killed_worker_again(work, monkeypatch):
    monkeypatch.setenv("HELD_SHARDS", "1/4")
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as cluster:
        monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", cluster.scheduler_address)
        engine = work.start([sys.executable, EXAMPLES / "dask_shards.py", "4", *work.command])
        task = work.wait_for_first_file(engine)
        worker = int(pathlib.Path(f"/proc/{task}/stat").read_text().split()[3])
        for process in (worker, task):  # as if their machine failed
            os.kill(process, signal.SIGKILL)
        work.expect_end(engine)


JOBS = list(yaml.safe_load_all((EXAMPLES / "kubernetes.yaml").read_text()))


@pytest.mark.parametrize("job", JOBS, ids=lambda job: job["metadata"]["name"])
def test_kubernetes_knows_every_key_of_its_jobs(job):
    client = kubernetes.client.ApiClient()
    typed = client.deserialize(types.SimpleNamespace(data=json.dumps(job)), "V1Job")  # leaves out keys that it does not know
    assert client.sanitize_for_serialization(typed) == job


def test_commands_of_the_kubernetes_jobs_make_the_output(work, monkeypatch):
    shards, join = (job["spec"] for job in JOBS)
    count = shards["completions"]
    for spec, index in [(shards, i) for i in range(count)] + [(join, None)]:
        if index is not None:
            monkeypatch.setenv("JOB_COMPLETION_INDEX", str(index))
        container, = spec["template"]["spec"]["containers"]
        film = "corda render swing.toml -o swing.mp4"
        assert film in container["command"][-1]
        pod = work.start([*container["command"][:-1], container["command"][-1].replace(film, " ".join(work.command))])
        text, _ = pod.communicate(timeout=120)
        assert pod.returncode == 0, text
    assert [len(work.runs_of(f"{i}/{count}")) for i in range(count)] == [1] * count
    work.expect_output_of_one_machine()
