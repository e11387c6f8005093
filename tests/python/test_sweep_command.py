"""`python3 -m corda sweep`: the same files in every way, and damage is named."""

import hashlib
import io
import json
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tarfile
import time
import zipfile

import numpy as np
import pytest

import corda
import corda.sweep
from corda import _archive, _run_sweep, _shards, _sweep_file

PROGRAM = os.environ["CORDA_PROGRAM"]
COMMAND = [sys.executable, "-m", "corda", "sweep"]

SCENE = """schema = 1
[world]
duration = 0.2
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 40.0 }
[solver]
method = "exact"
[video]
size = [64, 48]
fps = 30
"""
VARY = """"rope[0].hang.angle_deg" = { uniform = [5.0, 90.0] }
"rope[0].hang.links" = { integer = [1, 5] }
"rope[0].mass" = { log_uniform = [0.01, 10.0] }
"world.gravity" = [1.62, [0.5, -9.81]]
"""
QUICK = '[output]\npictures = "none"\nlabels = ["positions", "mask"]\n'


class Folder:
    """A folder with a sweep file, and runs of it."""

    def __init__(self, path, capfd):
        self.path = path
        self._capfd = capfd
        self.scene(SCENE)

    def scene(self, text):
        (self.path / "scene.toml").write_text(text)

    def define(self, head, vary=VARY, rest=""):
        (self.path / "sweep.toml").write_text(f'schema = 1\nscene = "scene.toml"\n{head}\n[vary]\n{vary}{rest}')

    def file(self, name):
        return str(self.path / name)

    def arguments(self, name, *more):
        return [self.file("sweep.toml"), "-o", self.file(name), *more]

    def run(self, name, *more):
        """Runs the command in this process, with one job unless told otherwise; returns exit code, output and messages."""
        jobs = [] if {"--jobs", "--check"} & set(more) else ["--jobs", "1"]
        self._capfd.readouterr()
        code = corda.sweep.main(self.arguments(name, *jobs, *more))
        return code, *self._capfd.readouterr()

    def start(self, name, *more, **named):
        return subprocess.Popen([*COMMAND, *self.arguments(name, "-q", *more)], stderr=subprocess.PIPE, text=True, **named)

    def sums(self, name):
        """SHA-256 of every file by its name, except the temporary files of killed processes."""
        return {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in (self.path / name).iterdir()
                if not file.name.endswith(".tmp")}

    def whole(self):
        """The sums of a sweep that one process makes at once."""
        code, _, messages = self.run("whole", "--force")
        assert code == 0, messages
        return self.sums("whole")

    def manifest(self, name):
        return json.loads((self.path / name / "manifest.json").read_text())

    def damage(self, name):
        data = bytearray((self.path / name).read_bytes())
        data[len(data) // 2] ^= 1
        (self.path / name).write_bytes(data)


@pytest.fixture
def folder(tmp_path, capfd):
    return Folder(tmp_path, capfd)


def render(folder, key, output):
    """Renders the scene with the parameters of a sample, as its .json has them, by the program."""
    parameters = json.loads((folder.path / "out" / f"{key}.json").read_text())["parameters"]
    settings = [part for name, value in parameters.items() for part in ("--set", f"{name}={_sweep_file.toml_of(value)}")]
    subprocess.run([PROGRAM, "render", folder.file("scene.toml"), "-o", folder.file(output), "-q", *settings], check=True)


LONGER = SCENE.replace("0.2", "4.5") + "shutter = 0.5\nsubframes = 2\ncrf = 30\n[style]\ntrail_s = 0.5\n"  # several key frames
AUTOMATIC = SCENE.replace('[solver]\nmethod = "exact"\n', "").replace("fps = 30", 'fps = "30000/1001"')


@pytest.mark.parametrize("scene", [AUTOMATIC, LONGER])
def test_clips_have_the_bytes_of_renders(folder, scene):
    folder.scene(scene)
    folder.define("samples = 2")
    assert folder.run("out")[0] == 0
    with tarfile.open(folder.file("out/shard-000000.tar")) as tar:
        tar.extractall(folder.file("out"))
    for key in ("000000", "000001"):
        render(folder, key, f"{key}.mp4")
        assert (folder.path / "out" / f"{key}.mp4").read_bytes() == (folder.path / f"{key}.mp4").read_bytes()


def test_pictures_have_the_bytes_of_renders(folder):
    folder.define("samples = 1", rest='[output]\npictures = "png"\n')
    assert folder.run("out")[0] == 0
    with tarfile.open(folder.file("out/shard-000000.tar")) as tar:
        names = tar.getnames()
        tar.extractall(folder.file("out"))
    assert names == [*(f"000000.{k:06}.png" for k in range(6)), "000000.json", "000000.npz"]
    render(folder, "000000", "frames/%06d.png")
    for k in range(6):
        assert (folder.path / "out" / f"000000.{k:06}.png").read_bytes() == (folder.path / f"frames/{k:06}.png").read_bytes()


def test_shards_have_their_bytes(folder):
    """A change of these is a change of all data sets; src/CHANGELOG.md must name it."""
    assert corda.__version__ == "0.1.0"  # it stands in every sample
    vary = VARY.replace(', [0.5, -9.81]', ', 9.81') + '"rope[0].payload" = { normal = [1.0, 0.5], min = 0.0 }\n'
    sums, members = {}, {}
    for pictures in ("none", "png", "npz", "mp4"):
        folder.define("samples = 2\nseed = 7", vary, f'[output]\npictures = "{pictures}"\nlabels = {json.dumps(_sweep_file.LABELS)}\n'
                                                     "[split]\ntrain = 0.5\ntest = 0.5\n")
        sums[pictures] = folder.whole()["shard-000000.tar"]
        with tarfile.open(folder.file("whole/shard-000000.tar")) as tar:
            members[pictures] = {member.name: tar.extractfile(member).read() for member in tar}
    for name, data in members["none"].items():  # the arrays and the facts of a sample
        assert members["mp4"][name] == members["png"][name] == data, name
    clips = [data for name, data in members["mp4"].items() if name.endswith(".mp4")]
    assert len(clips) == 2 and all(b"x264 - core " in clip for clip in clips)
    if not all(b"x264 - core 164 r3095 baee400 " in clip for clip in clips):
        del sums["mp4"]  # clips depend on the version of the encoder, which they name
    assert sums == {pictures: SUMS[pictures] for pictures in sums}


SUMS = {
    "none": "988c541d5f267f416c1f9ae537b6d5f78e0cddef44471072aeba41bb12d76321",
    "png": "0806d430f9ea54db1875e3c370d40ddd1e1f61f7f21c59cdf4fe723fd36f713f",
    "npz": "8a3372676795dba6c20cc1566c342a5d922a0408461e276596905bda76ef3558",
    "mp4": "31394a26be56a4dba0ea0ff6032eed095e343b15b47ff277300265bd9493da6a",
}


def test_any_number_of_jobs_and_any_split_give_the_same_files(folder):
    folder.define("samples = 23\nshard_samples = 3\nseed = 11", rest="[split]\ntrain = 0.5\ntest = 0.5\n")
    whole = folder.whole()
    assert len(whole) == 8 * 2 + 2
    for jobs in ("0", "3"):
        code, _, messages = folder.run(f"jobs{jobs}", "--jobs", jobs)
        assert code == 0, messages
        assert folder.sums(f"jobs{jobs}") == whole
    order = list(range(8))
    random.Random(8).shuffle(order)
    for i in order:
        assert folder.run("tasks", "--shard", f"{i}/8")[0] == 0
    assert folder.sums("tasks") == whole
    manifest = folder.manifest("whole")
    assert (manifest["samples"], manifest["complete"], sum(manifest["splits"].values())) == (23, True, 23)
    assert {shard["file"]: shard["sha256"] for shard in manifest["shards"]} == {
        name: total for name, total in whole.items() if name.endswith(".tar")}


def test_two_of_one_folder_at_a_time_give_the_same_files(folder):
    folder.define("samples = 12\nshard_samples = 2", rest=QUICK)
    whole = folder.whole()
    for process in [folder.start("both", "--jobs", "1") for _ in range(2)]:
        assert process.wait(120) == 0, process.stderr.read()
    assert folder.sums("both") == whole


def test_refused_samples_are_counted_and_named(folder):
    # Particles that are too heavy, and a relaxation that diverges.
    folder.scene(SCENE.replace('"exact"', '"relaxation"\nreach = 1'))
    folder.define("samples = 8", '"rope[0].payload" = { normal = [0.0, 1.0] }\n"solver.force" = [[0.0, -9.8], [1e300, 0.0]]\n',
                  QUICK + "[split]\ntrain = 1\n")
    code, out, messages = folder.run("out", "--json")
    assert code == 0, messages
    manifest = folder.manifest("out")
    failed = manifest["failed"]
    assert f'{failed} samples refused, see column "failure" of metadata.csv; the first, 00000' in messages
    assert f"by {folder.file('sweep.toml')}" in messages
    assert json.loads(out)["failed"] == failed == len(manifest["failures"])
    assert manifest["samples"] == manifest["splits"]["train"] == 8 - failed
    assert manifest["shards"][0]["failed"] == failed
    with tarfile.open(folder.file("out/shard-000000.tar")) as tar:
        keys = {name[:6] for name in tar.getnames()}
    assert len(keys) == 8 - failed and not keys & {failure["key"] for failure in manifest["failures"]}
    codes = [failure["failure"]["code"] for failure in manifest["failures"]]
    assert set(codes) == {3, 8} and failed < 8
    rows = dict(line.split(",", 1) for line in (folder.path / "out/metadata.csv").read_text().splitlines())
    for failure in manifest["failures"]:
        message = failure["failure"]["message"]
        assert ("vary rope[0].payload=" if failure["failure"]["code"] == 3 else "diverged") in message and "--set" not in message
        assert message[:20] in rows[failure["key"]]
    assert folder.run("out", "--check")[0] == 0


def test_a_sweep_without_any_sample_fails(folder):
    folder.define("samples = 3", '"rope[0].hang.links" = { uniform = [3.1, 3.9] }\n', QUICK)
    for _ in range(2):  # the second time, its shard is there
        code, _, messages = folder.run("out")
        assert code == 3
        assert "all samples were refused; the first, 000000: " in messages and "rope[0].hang.links" in messages


def test_check_compares_the_summaries_with_the_shards(folder):
    folder.define("samples = 3", rest=QUICK)
    whole = folder.whole()
    for name in ("metadata.csv", "manifest.json"):
        path = folder.path / "whole" / name
        path.write_text(path.read_text() + " \n")
        code, _, messages = folder.run("whole", "--check")
        assert code == 7 and f"{path}' does not say what the shards hold" in messages
        path.unlink()
        assert folder.run("whole")[0] == 0
        assert folder.sums("whole") == whole


def test_check_names_what_is_wrong_and_its_advice_works(folder):
    folder.define("samples = 6\nshard_samples = 2", rest=QUICK)
    whole = folder.whole()
    code, out, _ = folder.run("whole", "--check")
    assert code == 0 and "all shards are as they were written" in out
    shard = folder.path / "whole/shard-000001.tar"

    def expect_named(problem):
        code, out, messages = folder.run("whole", "--check", "--json")
        report = json.loads(out)
        assert (code, report["ok"], report["problems"]) == (7, False, [f"'{shard}' {problem}"])
        assert problem in messages

    def expect_mended():
        assert folder.run("whole", "--resume")[0] == 0
        assert folder.sums("whole") == whole
        assert folder.run("whole", "--check")[0] == 0

    folder.damage("whole/shard-000001.tar")
    expect_named("is damaged: its SHA-256 is another one than its index says; remove it, and run the sweep again")
    shard.unlink()
    expect_named("is missing; run the sweep again")
    expect_mended()
    for spoil in (lambda: os.truncate(shard, 1000), lambda: folder.damage("whole/shard-000001.json"),
                  (folder.path / "whole/shard-000001.json").unlink):
        spoil()
        expect_named("does not fit its index; run the sweep again")
        expect_mended()
    code, _, messages = folder.run("nothing", "--check")
    assert code == 7 and "shard-000000.tar' is missing" in messages and "shard-000002.tar' is missing" in messages
    assert not (folder.path / "nothing").exists()


def test_a_full_disk_keeps_finished_shards(folder):
    folder.define("grid = true\nshard_samples = 1", '"world.duration" = [0.1, 10.0, 0.2]\n', QUICK)
    whole = folder.whole()
    assert os.path.getsize(folder.file("whole/shard-000001.tar")) > 40_000
    assert os.path.getsize(folder.file("whole/shard-000000.tar")) < 20_000
    for jobs in ("1", "2"):  # a limit of the size of a file, which a process sees as a full disk
        limit = (resource.RLIMIT_FSIZE, (25_000, 25_000))
        full = folder.start(f"out{jobs}", "--jobs", jobs, preexec_fn=lambda: resource.setrlimit(*limit))
        assert full.wait(60) == 6
        messages = full.stderr.read()
        assert "shard-000001.tar" in messages and "File too large" in messages and messages.count("\n") == 1
        assert sorted(os.listdir(folder.file(f"out{jobs}"))) == ["manifest.json", "shard-000000.json", "shard-000000.tar"]
        code, out, _ = folder.run(f"out{jobs}", "--json")
        assert code == 0 and json.loads(out)["shards_made"] == 2
        assert folder.sums(f"out{jobs}") == whole


def test_a_folder_of_another_sweep_is_refused_naming_the_difference(folder):
    folder.define("samples = 4\nshard_samples = 2", rest=QUICK)
    whole = folder.whole()

    def expect_refused(difference):
        code, _, messages = folder.run("whole")
        assert code == 2
        assert f"manifest.json' is of another sweep: {difference}" in messages and "; choose another folder" in messages
        assert folder.sums("whole") == whole

    folder.define("samples = 4\nshard_samples = 2\nseed = 8", rest=QUICK)
    expect_refused("seed is 8 and was 0")
    folder.define("samples = 4\nshard_samples = 2", VARY + '"world.drag" = [0.1]\n', QUICK)
    expect_refused('vary."world.drag" is [0.1] and was not given')
    folder.define("samples = 4\nshard_samples = 2", rest=QUICK)
    folder.scene(SCENE + "crf = 30\n")
    expect_refused("scene is ")
    assert folder.run("whole", "--force")[0] == 0
    assert folder.sums("whole") != whole
    folder.scene(SCENE)
    assert folder.run("whole", "--force")[0] == 0
    assert folder.sums("whole") == whole
    (folder.path / "whole/manifest.json").write_text("{}")
    code, _, messages = folder.run("whole")
    assert code == 6 and "manifest.json' is no manifest of a sweep; move it away" in messages


def test_a_folder_of_the_program_of_before_is_refused(folder):
    """Its numbers are others."""
    folder.define("samples = 2", rest=QUICK)
    folder.whole()
    manifest = folder.manifest("whole")
    del manifest["made_from"]["random"]
    (folder.path / "whole/manifest.json").write_text(json.dumps(manifest))
    code, _, messages = folder.run("whole")
    assert code == 2 and "random is philox4x64 and was not given" in messages


def test_a_shard_of_another_sweep_is_refused_naming_the_difference(folder):
    folder.define("samples = 4\nshard_samples = 2\nseed = 8", rest=QUICK)
    assert folder.run("other")[0] == 0
    folder.define("samples = 4\nshard_samples = 2", rest=QUICK)
    whole = folder.whole()
    names = ["shard-000001.tar", "shard-000001.json"]
    for name in names:
        (folder.path / "whole" / name).write_bytes((folder.path / "other" / name).read_bytes())
    for more, code in (((), 2), (("--check",), 7)):
        found, _, messages = folder.run("whole", *more)
        assert found == code and "shard-000001.tar' is of another sweep: seed is 0 and was 8; " in messages
    for name in names:
        (folder.path / "whole" / name).unlink()
    assert folder.run("whole")[0] == 0
    assert folder.sums("whole") == whole


def test_a_sweep_grows_and_does_not_shrink(folder):
    folder.define("samples = 3\nshard_samples = 2", rest=QUICK)
    assert folder.run("out")[0] == 0
    folder.define("samples = 7\nshard_samples = 2", rest=QUICK)
    code, out, _ = folder.run("out", "--json")
    assert code == 0 and json.loads(out)["shards_made"] == 3  # the second had one sample
    assert folder.sums("out") == folder.whole()
    folder.define("samples = 3\nshard_samples = 2", rest=QUICK)
    code, _, messages = folder.run("out")
    assert code == 2 and "' is of a sweep of more samples; move it away" in messages
    assert folder.run("out", "--check")[0] == 7
    folder.define("samples = 6\nshard_samples = 2", rest=QUICK)
    assert folder.run("out", "--force")[0] == 0
    assert not (folder.path / "out/shard-000003.tar").exists()
    kept = folder.sums("out")
    folder.define("samples = 5\nshard_samples = 2", rest=QUICK)  # with as many shards
    assert folder.run("out")[0] == 2
    assert folder.sums("out") == kept


def test_reports_and_errors_are_json(folder):
    folder.define("samples = 5\nshard_samples = 2", rest=QUICK)
    code, out, messages = folder.run("out", "--json", "--shard", "1/2")
    report = json.loads(out)
    assert code == 0 and "other shards are missing" in messages and report.pop("wall_s") > 0.0
    assert report == {"schema": 1, "output": folder.file("out"), "samples": 5, "shards": 1, "shards_made": 1, "samples_made": 2,
                      "failed": 0, "complete": False, "figures": []}
    report = json.loads(folder.run("out", "--json")[1])
    assert (report["shards"], report["shards_made"], report["complete"]) == (3, 2, True)
    assert folder.run("out")[1] == folder.file("out") + "\n"
    folder.define("samples = 0")
    code, out, _ = folder.run("out", "--json")
    error = json.loads(out)["error"]
    assert code == error["code"] == 3
    assert error["message"].startswith(folder.file("sweep.toml") + ":3:11: samples: ")


@pytest.mark.parametrize("more, words", [
    (["--shard", "2/2"], "--shard 2/2: give I/N"), (["--shard", "x"], "--shard x: give I/N"),
    (["--check", "--force"], "--check excludes --force"), (["--force", "--shard", "0/2"], "--shard excludes --force"),
    (["--check", "--sheet"], "--check excludes --sheet"), (["--jobs", "-1"], "--jobs -1 is not within"), (["--jobs", "x"], "--jobs"),
    (["--job", "1"], "--job 1; see --help"), (["-o", "-"], "give a folder"), (["--plot", "x"], "--plot x: is not Y:X"),
    (["--backend", "typo"], 'backend "typo" is unknown')])
def test_a_wrong_command_line_is_refused(folder, more, words):
    folder.define("samples = 1")
    code, _, messages = folder.run("out", *more)
    assert code == 2 and words in messages and messages.count("\n") == 1
    assert not (folder.path / "out").exists()


def test_the_module_has_commands(capfd):
    def run(*arguments):
        ended = subprocess.run([sys.executable, "-m", "corda", *arguments], capture_output=True, text=True)
        return ended.returncode, ended.stdout + ended.stderr

    assert run("--version") == (0, f"corda {corda.__version__}\n")
    assert run() == (2, "corda: error: give a command: sweep or report\n")
    assert run("swep") == (2, "corda: error: there is no command 'swep' of Python; give sweep or report\n")
    code, text = run("sweep", "--help")
    assert code == 0 and all(f"--{name}" in text for name in ("shard", "check", "resume", "force", "jobs", "plot", "sheet", "json"))


def test_standard_input_is_a_sweep_file(folder):
    folder.define("samples = 3", rest=QUICK)
    whole = folder.whole()
    piped = subprocess.run([*COMMAND, "-", "-o", "out"], cwd=folder.path, stdin=open(folder.file("sweep.toml")), capture_output=True)
    assert piped.returncode == 0, piped.stderr
    assert folder.sums("out") == whole


def living(session):
    """Processes of a session that are not finished."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            fields = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] not in "ZX":
            found.append(int(entry.name))
    return found


def wait_until(condition):
    end = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.mark.parametrize("jobs", ["1", "2"])
@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_keeps_finished_shards(folder, jobs, number, code):
    folder.define("samples = 3000\nshard_samples = 1", rest=QUICK)
    process = folder.start("out", "--jobs", jobs, start_new_session=True)
    wait_until((folder.path / "out/shard-000001.json").exists)
    process.send_signal(number)
    assert process.wait(60) == code
    assert process.stderr.read() == ("corda: error: interrupted: finished shards stay in " + folder.file("out") +
                                     "; run it again for the others\n")
    wait_until(lambda: not living(process.pid))
    assert not list((folder.path / "out").glob("*.tmp"))
    assert not (folder.path / "out/shard-002999.tar").exists()
    made = folder.sums("out")
    folder.define("samples = 2\nshard_samples = 1", rest=QUICK)
    whole = folder.whole()
    assert all(made[name] == whole[name] for name in whole if name.startswith("shard-"))


def test_a_signal_to_one_worker_is_no_interruption(folder):
    folder.define("samples = 3000\nshard_samples = 1", rest=QUICK)
    process = folder.start("out", "--jobs", "2", start_new_session=True)
    wait_until((folder.path / "out/shard-000001.json").exists)
    workers = [number for number in living(process.pid) if b"spawn_main" in pathlib.Path(f"/proc/{number}/cmdline").read_bytes()]
    assert len(workers) == 2
    os.kill(workers[0], signal.SIGTERM)
    code, messages = process.wait(60), process.stderr.read()
    assert code == 75, messages
    assert "a process that makes samples was killed" in messages
    wait_until(lambda: not living(process.pid))
    process = folder.start("all", "--jobs", "2", start_new_session=True)
    wait_until((folder.path / "all/shard-000001.json").exists)
    os.killpg(process.pid, signal.SIGTERM)  # as schedulers of clusters do
    assert process.wait(60) == 143
    wait_until(lambda: not living(process.pid))


def test_a_signal_amid_an_archive_is_a_signal(monkeypatch):
    """The archive that it leaves raises an error of its own."""
    worker = _run_sweep._Worker
    monkeypatch.setattr(worker, "is_stopped", False)
    monkeypatch.setattr(worker, "definition", type("Definition", (), {"pictures": []}))
    monkeypatch.setattr(worker, "gl", ())
    monkeypatch.setattr(_run_sweep, "make_sample", lambda *_: {"positions": np.zeros(3)})
    monkeypatch.setattr(_shards, "pack", _archive.npz_bytes)
    monkeypatch.setattr(zipfile, "_get_compressor", lambda *_: worker._stop())
    with pytest.raises(KeyboardInterrupt):
        worker.pack([0])


def test_killed_sweeps_go_on(folder):
    """While they make shards; 100 with CORDA_TEST_LONG."""
    folder.define("samples = 60\nshard_samples = 2", rest=QUICK)
    whole = folder.whole()
    moments = random.Random(20261127)
    tasks = folder.path / "tasks"
    amid = 0
    for _ in range(100 if os.environ.get("CORDA_TEST_LONG") else 4):
        shards = sorted(tasks.glob("shard-*[!p]"))
        for path in moments.sample(shards, len(shards) // 2):
            path.unlink()  # so that there is work
        made = len(list(tasks.glob("shard-*.json"))) + moments.randint(1, 5)
        process = folder.start("tasks", "--jobs", moments.choice("12"), start_new_session=True)
        wait_until(lambda: len(list(tasks.glob("shard-*.json"))) >= made or process.poll() is not None)
        process.kill()
        amid += process.wait() == -signal.SIGKILL and len(list(tasks.glob("shard-*.json"))) < 30
        wait_until(lambda: not living(process.pid))  # no worker outlives its parent
    assert amid > 0
    code, _, messages = folder.run("tasks")
    assert code == 0, messages
    assert folder.sums("tasks") == whole


def test_files_of_others_are_kept(folder):
    folder.define("samples = 4\nshard_samples = 1", rest=QUICK)
    out = folder.path / "out"
    out.mkdir()
    for name in ("shard-000000.tar", "metadata.csv", "shard-000007.json"):
        (out / name).write_text("precious")
        for more in ((), ("--force",)):
            code, _, messages = folder.run("out", *more)
            assert code == 6 and f"{name}' is there, and no manifest of a sweep" in messages
        assert (out / name).read_text() == "precious"
        (out / name).unlink()
    others = ("shard-notes.txt", "shard-train-000000.tar", "shard-00.tar")
    for name in others:
        (out / name).write_text("precious")
    assert folder.run("out", "--force")[0] == 0
    assert all((out / name).read_text() == "precious" for name in others)
    manifest = (out / "manifest.json").read_text()
    (out / "manifest.json").unlink()  # it is made again
    assert json.loads(folder.run("out", "--json")[1])["shards_made"] == 0
    assert (out / "manifest.json").read_text() == manifest


def test_links_and_pipes_are_refused(folder):
    folder.define("samples = 4\nshard_samples = 1", rest=QUICK)
    victim = folder.path / "victim"
    victim.write_text("precious")
    for name in ("shard-000002.tar", "shard-000002.json", "metadata.csv"):
        assert folder.run("out")[0] == 0
        path = folder.path / "out" / name
        for make in (lambda: path.symlink_to(victim), lambda: os.mkfifo(path)):
            path.unlink()
            make()
            code, _, messages = folder.run("out")
            assert code == 6 and f"{name}' is no ordinary file" in messages
            assert folder.run("out", "--check")[0] == 7
        path.unlink()
    assert victim.read_text() == "precious"


def test_any_json_may_be_an_index(folder):
    folder.define("samples = 2\nshard_samples = 1", rest=QUICK)
    whole = folder.whole()
    path = folder.path / "whole/shard-000001.json"
    sound = json.loads(path.read_text())
    texts = ['{"checksum":1,"rows":' + 100_000 * "[", "[]", "", "\xff", '{"checksum": "\\ud800"}']
    for key, value in (("rows", [1]), ("rows", 7), ("made_from", [1]), ("bytes", -1), ("bytes", 1e300), ("sha256", 1),
                       ("rows", [{"key": "000001", "split": 1}]),
                       ("rows", [{"key": "000001", "split": "", "failure": "none"}])):
        forged = sound | {key: value}
        forged["checksum"] = _shards._checksum_of(forged)
        texts.append(json.dumps(forged))
    for text in texts:
        path.write_text(text)
        assert folder.run("whole", "--check")[0] == 7, text[:100]
        assert json.loads(folder.run("whole", "--json")[1])["shards_made"] == 1, text[:100]
        assert folder.sums("whole") == whole


def test_a_share_of_any_number_of_processes(folder):
    folder.define("samples = 4\nshard_samples = 1", rest=QUICK)
    assert json.loads(folder.run("out", "--json", "--shard", f"2/{2**63}")[1])["shards_made"] == 1
    assert (folder.path / "out/shard-000002.tar").exists()
    assert json.loads(folder.run("out", "--json", "--shard", "100/101")[1])["shards"] == 0


def test_old_shards_stay_until_a_sample_is_made(folder, monkeypatch):
    folder.define("samples = 2\nshard_samples = 1", rest=QUICK)
    whole = folder.whole()

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(_run_sweep, "make_sample", interrupt)
    assert folder.run("whole", "--force")[0] == 130
    assert folder.sums("whole") == whole


def test_tars_are_ustar_without_owner_and_time():
    file = io.BytesIO()
    tar = _archive.TarWriter(file)
    tar.add("000000.json", b"{}\n")
    tar.add("000000.npz", 513 * b"x")
    tar.finish()
    with tarfile.open(fileobj=io.BytesIO(file.getvalue())) as read:
        members = read.getmembers()
        assert [(one.name, one.size, one.mode, one.uid, one.gid, one.uname, one.mtime) for one in members] == [
            ("000000.json", 3, 0o644, 0, 0, "", 0), ("000000.npz", 513, 0o644, 0, 0, "", 0)]
    assert file.getvalue()[257:265] == b"ustar\x0000"
    assert hashlib.sha256(file.getvalue()).hexdigest() == TAR_SUM


TAR_SUM = "3455ec71e6da11f53e526e8dc35f646943836e5d3fcebc18cbb758f74772035b"


def test_arrays_have_their_bytes():
    """The same for every supported version of numpy."""
    arrays = {"times": np.arange(3.0), "mask": np.arange(24, dtype=np.uint8).reshape(2, 3, 4), "empty": np.zeros((2, 0, 2))}
    data = _archive.npz_bytes(arrays)
    read = np.load(io.BytesIO(data))
    assert all(np.array_equal(read[name], array) and read[name].dtype == array.dtype for name, array in arrays.items())
    assert hashlib.sha256(data).hexdigest() == NPZ_SUM
    smooth = np.zeros(8000, np.uint8)
    assert len(_archive.npz_bytes({"mask": smooth})) < 500  # compressed; numbers are not
    assert smooth.tobytes() in _archive.npz_bytes({"times": smooth.view(np.float64)})


NPZ_SUM = "f9a77a8b1cc67823f0be8501b2372f254e830675b96f0c821baf3efe6d168ef8"
