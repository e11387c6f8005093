"""Makes and checks the files of a sweep, by several processes. The same sweep gives the same files, however its shards are made."""

import collections
import concurrent.futures
import contextlib
import dataclasses
import itertools
import multiprocessing
import multiprocessing.resource_tracker
import os
import signal
import threading
import time

from . import _corda, _shards
from ._archive import read_plain, sha256_of
from ._arguments import make_error
from ._corda import Error
from ._sample import make_sample

_MAX_CHUNK = 8  # samples that a process makes at a time: each exchange takes some 0.2 ms
_CHUNKS_AHEAD = 3  # per process
_SIGNALS_APART_S = 0.5  # those that one sender sends to all processes of a sweep


@dataclasses.dataclass
class Run:
    """How a sweep is run."""

    folder: str
    shard: tuple = (0, 1)  #: make only every count-th shard file, from shard file `index` on
    jobs: int = 1  #: processes; the bytes do not depend on it
    force: bool = False  #: replace the shards of another sweep, and make finished ones again
    gl: tuple = ("auto", False)  #: how to reach OpenGL: backend, require_gpu


@dataclasses.dataclass
class Result:
    shards: int = 0  #: shard files of this run
    shards_made: int = 0  #: those that were not finished before
    samples_made: int = 0
    failed: int = 0  #: samples without files: of this run, or of the whole sweep if it is complete
    first_failure: str = ""  #: key and reason of the first of them
    is_complete: bool = False  #: all shard files of the sweep are there, with metadata.csv and manifest.json

    def add_failure(self, row):
        self.failed += 1
        self.first_failure = self.first_failure or f"{row['key']}: {row['failure']['message']}"


class _Worker:
    """The state of a process of the pool."""

    definition = None
    gl = None
    is_making = False  #: a signal may end the work in hand
    is_stopped = False

    @classmethod
    def start(cls, definition, gl):
        cls.definition, cls.gl = definition, gl
        _corda.keep_memory()
        signal.signal(signal.SIGTERM, cls._stop)
        threading.Thread(target=cls._end_with_parent, daemon=True).start()

    @staticmethod
    def _end_with_parent():
        """A process whose parent was killed would wait for work for ever."""
        multiprocessing.parent_process().join()
        os._exit(1)

    @classmethod
    def _stop(cls, *_):
        """By SIGTERM. A process that ended while it sends a result would leave the parent waiting for the rest."""
        cls.is_stopped = True
        if cls.is_making:
            raise KeyboardInterrupt

    @classmethod
    def pack(cls, numbers):
        cls.is_making = True
        try:
            if cls.is_stopped:
                raise KeyboardInterrupt
            return [_shards.pack(make_sample(cls.definition, number, cls.definition.pictures, *cls.gl)) for number in numbers]
        except Exception:
            if cls.is_stopped:  # leaving a half-written archive raises an error of its own
                raise KeyboardInterrupt from None
            raise
        finally:
            cls.is_making = False


@contextlib.contextmanager
def _sigint_blocked():
    """Processes that start meanwhile never get SIGINT: Ctrl-C is the parent's, which ends its workers."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _packed_by_processes(definition, gl, numbers, count, jobs):
    """What pack() returns of each of `count` numbers, in order."""
    size = max(1, min(_MAX_CHUNK, count // (4 * jobs)))
    chunks = iter(lambda: list(itertools.islice(numbers, size)), [])
    others = set(multiprocessing.active_children())
    multiprocessing.resource_tracker.ensure_running()  # which would unblock SIGINT
    pool = concurrent.futures.ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _Worker.start, (definition, gl))
    waiting = collections.deque()

    def submit(count):
        with _sigint_blocked():  # any call may start a process
            waiting.extend(pool.submit(_Worker.pack, chunk) for chunk in itertools.islice(chunks, count))

    try:
        submit(_CHUNKS_AHEAD * jobs)
        while waiting:
            made = waiting.popleft()
            if isinstance(made.exception(), KeyboardInterrupt):  # of a signal to that process
                raise concurrent.futures.BrokenExecutor
            submit(1)
            yield from made.result()
        pool.shutdown()
    except concurrent.futures.BrokenExecutor:
        time.sleep(_SIGNALS_APART_S)  # a signal to this process, too, is raised here and tells more
        raise make_error("a process that makes samples was killed; a smaller scene or picture, or fewer jobs, may help "
                         "if memory ended", 75) from None
    finally:
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()
        pool.shutdown(cancel_futures=True)


def _packed(definition, run, numbers, count):
    jobs = min(run.jobs, count)
    if jobs > 1:
        return _packed_by_processes(definition, run.gl, numbers, count, jobs)
    return (_shards.pack(make_sample(definition, number, definition.pictures, *run.gl)) for number in numbers)


def _make_shards(definition, run, lacking, result, on_progress):
    numbers = itertools.chain.from_iterable(_shards.samples_of(definition, shard) for shard in lacking)
    count = sum(len(_shards.samples_of(definition, shard)) for shard in lacking)
    on_progress(0, count)

    def counted(packed):
        for row, files in packed:
            if "failure" in row:
                result.add_failure(row)
            yield row, files
            result.samples_made += 1
            on_progress(result.samples_made, count)

    samples = _packed(definition, run, numbers, count)
    try:
        for shard in lacking:
            first = next(samples)
            if result.samples_made == 0:  # it is known now that samples can be made
                (_shards.clear_folder if run.force else _shards.mark_incomplete)(definition, run.folder)
            others = itertools.islice(samples, len(_shards.samples_of(definition, shard)) - 1)
            _shards.write_shard(definition, run.folder, shard, counted(itertools.chain([first], others)))
            result.shards_made += 1
    finally:
        samples.close()


def run_sweep(definition, run, on_progress):
    """Makes the shard files that are not finished, and metadata.csv and manifest.json when all are. Calls on_progress with finished
    and all samples. Raises Error: code 2 if the folder has another sweep, naming a difference, 6 (finished shards stay), and what
    make_sample() raises; KeyboardInterrupt, with a message."""
    _shards.open_folder(definition, run.folder, run.force)
    result = Result()
    mine = range(run.shard[0], _shards.shard_count(definition), run.shard[1])
    result.shards = len(mine)
    try:
        lacking = [shard for shard in mine if run.force or _shards.find_index(definition, run.folder, shard) is None]
        if lacking:
            _make_shards(definition, run, lacking, result, on_progress)
        if all(os.path.lexists(_shards.index_path(run.folder, shard)) for shard in range(_shards.shard_count(definition))):
            _finish_folder(definition, run.folder, result)
    except KeyboardInterrupt as error:
        raise type(error)(f"interrupted: finished shards stay in {run.folder}; run it again for the others") from None
    finally:
        on_progress.end()
    return result


def _finish_folder(definition, folder, result):
    """Writes metadata.csv and the whole manifest, if all shards are finished."""
    whole = _shards.summary_of(definition, folder)
    if whole is None:
        return
    metadata, manifest = whole
    _shards.save_file(_shards.metadata_path(folder), metadata.encode())
    _shards.save_file(_shards.manifest_path(folder), _shards.json_text(manifest).encode())
    result.is_complete = True
    result.failed, result.first_failure = 0, ""
    for row in manifest["failures"]:
        result.add_failure(row)


def _shard_problem(definition, folder, shard):
    """What is wrong with a shard file; None if nothing is."""
    path = _shards.shard_path(folder, shard)
    index = _shards.find_index(definition, folder, shard)
    if index is None:
        return f"'{path}' " + ("does not fit its index; run the sweep again" if os.path.lexists(path) else
                               "is missing; run the sweep again")
    if sha256_of(path) != index["sha256"]:
        return f"'{path}' is damaged: its SHA-256 is another one than its index says; remove it, and run the sweep again"
    return None


def check_sweep(definition, folder, on_progress):
    """Reads all files again. Returns the problems: missing and damaged files, and those of another sweep."""
    problems = []

    def check(work, *arguments):
        try:
            problem = work(*arguments)
        except Error as error:
            if error.code != 2:
                raise
            problem = str(error)
        if problem:
            problems.append(problem)

    check(_shards.refuse_surplus_shards, definition, folder)
    count = _shards.shard_count(definition)
    for shard in range(count):
        on_progress(shard, count)
        check(_shard_problem, definition, folder, shard)
    if not problems:
        metadata, manifest = _shards.summary_of(definition, folder)
        texts = {_shards.metadata_path(folder): metadata, _shards.manifest_path(folder): _shards.json_text(manifest)}
        for path, expected in texts.items():
            if read_plain(path) != expected.encode():
                problems.append(f"'{path}' does not say what the shards hold; remove it, and run the sweep again")
    on_progress.end()
    return problems
