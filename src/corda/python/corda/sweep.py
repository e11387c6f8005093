"""Sweeps: many samples of one scene, as a sequence in Python, or as files by `python3 -m corda sweep`.

See section "Sweeps" of src/corda/python/README.md.
"""

import collections.abc
import fractions
import operator
import os
import time
import warnings

from . import _console, _corda, _parameters, _sample, _sweep_file
from ._arguments import gl_options, make_error

__all__ = ["Sweep"]

_OF_A_SAMPLE = ("key", "sample", "split", "parameters", "fps", "camera", "px_per_m", "method", "error_estimate_m",
                "error_estimate_px", "horizon_s", "summary")
_PLAIN_SCENE = "schema = 1\n[[rope]]\nhang = { links = 1, length = 1.0 }\n"


def _known_gl(backend, require_gpu):
    """How to reach OpenGL. Raises Error (code 2) for an unknown backend, which would refuse every sample."""
    gl = gl_options(backend, require_gpu)
    _corda.Film(_PLAIN_SCENE, b"text", False, [], *gl, None)
    return gl


class Sweep:
    """The samples of a sweep file: a sequence of dictionaries, made when they are asked for. No file is written.

    sweep[i] is a function of the file, its seed and i alone, so samples can be made in any order and in any process. A slice is a
    Sweep of its samples. len(sweep), shuffling and splitting make no sample; pickling hands the contents of the files on.

    A sample has "key", "sample" (its number), "split" (None without splits), "parameters" (a dictionary by the keys of the scene),
    "fps" (a Fraction), "camera" (center and height in m), "px_per_m", "method", "error_estimate_m", "error_estimate_px",
    "horizon_s" and "summary", whose unknown values are None; "times" in s; the arrays of output.labels of the file, "positions",
    "velocities", "tensions", "energy", "pixels" and "mask", which are those of a Film for all frames; and "frames", numpy uint8 of
    shape (frames, height, width, 4), unless output.pictures is "none".

    path: the sweep file. backend, require_gpu: as for Film. Raises Error for a file that cannot be read: code 6, or 3 with all that
    is wrong in it, and 2 for an unknown backend. A sample that the scene refuses, or whose motion diverges, raises Error (code 3, 2
    or 8) if it is asked for by its number, and is left out with a warning when the sweep is iterated; `failures` has the reasons so
    far by number. Threads may share a sweep. Ctrl-C ends the making of a sample.
    """

    def __init__(self, path, *, backend=None, require_gpu=False):
        self._gl = _known_gl(backend, require_gpu)
        self._definition = _sweep_file.load(path)
        self._numbers = range(self._definition.samples)
        self.failures = {}

    def __len__(self):
        return len(self._numbers)

    def __repr__(self):
        return f"<corda.Sweep of {len(self)} samples of {self._definition.source!r}>"

    def __getitem__(self, index):
        if isinstance(index, slice):
            return self._of(self._numbers[index])
        try:
            number = self._numbers[operator.index(index)]
        except TypeError:
            raise TypeError(f"a sample has a whole number, not {index!r}") from None
        except IndexError:
            raise IndexError(f"there is no sample {index}: the sweep has {len(self)}") from None
        sample = self._make(number)
        if sample.failure:
            raise make_error(self._failure_text(sample), sample.failure[0])
        return _dictionary(sample)

    def __iter__(self):
        for number in self._numbers:
            sample = self._make(number)
            if sample.failure:
                warnings.warn(f"{self._failure_text(sample)} (left out)", stacklevel=2)
            else:
                yield _dictionary(sample)

    def shard(self, index, count):
        """The samples of the shard files index, index + count, ... of `python3 -m corda sweep`, 0 <= index < count: a Sweep."""
        try:
            index, count = map(operator.index, (index, count))
        except TypeError:
            raise TypeError(f"shard: takes two integers, index and count, not {index!r} and {count!r}") from None
        if not 0 <= index < count:
            raise make_error(f"shard: takes index and count with 0 <= index < count, not {index} and {count}")
        return self._of(_shard_numbers(self._numbers, self._definition.shard_samples, index, count))

    def split(self, name):
        """The samples of a split of the file: a Sweep. Goes through all numbers once, without making a sample."""
        splits = self._definition.splits
        if name not in splits:
            raise make_error(f"split: {name!r} is no split of {self._definition.source}; " +
                             (f"it has {', '.join(splits)}" if splits else "give it a table [split]"))
        return self._of(tuple(number for number in self._numbers if _parameters.split_of(self._definition, number) == name))

    def parameters(self, index):
        """The parameters of a sample, without making it: a dictionary by the keys of the scene."""
        return _parameters.parameters_of(self._definition, self._numbers[index])

    def _of(self, numbers):
        part = object.__new__(type(self))
        part.__dict__.update(self.__dict__, _numbers=numbers, failures={})
        return part

    def _make(self, number):
        pictures = "none" if self._definition.pictures == "none" else "npz"
        sample = _sample.make_sample(self._definition, number, pictures, *self._gl)
        if sample.failure:
            self.failures[number] = sample.failure[1]
        return sample

    def _failure_text(self, sample):
        return f"{self._definition.source}: sample {sample.key}: {sample.failure[1]}"


def _dictionary(sample):
    info = dict(sample.info)
    info["fps"] = fractions.Fraction(info["fps"])
    info["camera"] = {"center": tuple(info["camera"]["center"]), "height": info["camera"]["height"]}
    return {name: info[name] for name in _OF_A_SAMPLE} | sample.arrays


class _ShardNumbers(collections.abc.Sequence):
    """Of the numbers 0, 1, ..., those in the groups index, index + count, ... of `size` numbers, at some positions of these."""

    def __init__(self, size, index, count, positions):
        self._size, self._index, self._count, self._positions = size, index, count, positions

    def __len__(self):
        return len(self._positions)

    def __getitem__(self, position):
        found = self._positions[position]
        if isinstance(found, range):
            return _ShardNumbers(self._size, self._index, self._count, found)
        group, place = divmod(found, self._size)
        return (group * self._count + self._index) * self._size + place


def _shard_numbers(numbers, size, index, count):
    if not isinstance(numbers, range) or numbers.step != 1:
        return tuple(number for number in numbers if number // size % count == index)

    def position(number):
        """How many numbers of the groups are below `number`."""
        cycles, rest = divmod(number, size * count)
        return cycles * size + min(max(rest - index * size, 0), size)

    return _ShardNumbers(size, index, count, range(position(numbers.start), position(numbers.stop)))


def _parser():
    parser = _console.Parser(prog="python3 -m corda sweep", description="Make many samples of a scene as a labelled data set.")
    parser.add_argument("sweep", metavar="SWEEP", help="sweep file: a scene and the keys that vary, or - for standard input")
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="folder of the shards, metadata.csv and manifest.json")
    parser.add_argument("--backend", default="", help="how to reach OpenGL, as for corda render")
    parser.add_argument("--require-gpu", action="store_true", help="draw with a GPU or not at all")
    parser.add_argument("--jobs", type=int, default=0, metavar="N", help="processes that make samples; 0: one per core")
    parser.add_argument("--shard", metavar="I/N", help="make only every N-th shard file, from shard file I (0 .. N - 1) on")
    parser.add_argument("--check", action="store_true", help="read all shards again, and make none")
    parser.add_argument("--plot", action="append", default=[], metavar="Y:X",
                        help="draw a figure of the samples over another one, or over a key that varies; may be repeated")
    parser.add_argument("--sheet", action="store_true", help="draw a contact sheet of 36 samples or fewer")
    parser.add_argument("--resume", action="store_true", help="make the shards that are missing, as without this option")
    parser.add_argument("--force", action="store_true",
                        help="replace the shards of another sweep, and make finished ones again")
    return parser


def _check_options(options):
    for one, other in (("check", "shard"), ("check", "plot"), ("check", "sheet"), ("check", "force"), ("shard", "force"),
                       ("resume", "force")):
        if getattr(options, one) and getattr(options, other):
            raise _console.UsageError(f"--{one} excludes --{other}; leave one of them out")
    if not 0 <= options.jobs <= 1024:
        raise _console.UsageError(f"--jobs {options.jobs} is not within 0 .. 1024")
    if not options.output or options.output == "-":
        raise _console.UsageError(f"-o {options.output}: a sweep has several files; give a folder")


def _shard_of(text):
    """The pair (I, N) of "I/N"."""
    if text is None:
        return 0, 1
    index, slash, count = text.partition("/")
    if slash and index.isascii() and index.isdecimal() and count.isascii() and count.isdecimal() and int(index) < int(count):
        return int(index), int(count)
    raise _console.UsageError(f"--shard {text}: give I/N, 0 <= I < N, such as 0/8")


def _check(console, definition, folder):
    from ._run_sweep import check_sweep
    problems = check_sweep(definition, folder, _console.Progress(console, "check"))
    for problem in problems:
        console.warning(problem)
    if not problems:
        console.result(f"{folder}: all shards are as they were written")
    console.report({"schema": 1, "output": folder, "ok": not problems, "problems": problems})
    return 7 if problems else 0


def _sweep(console, options):
    from . import _run_sweep
    start = time.monotonic()
    _check_options(options)
    shard = _shard_of(options.shard)
    definition = _sweep_file.load(options.sweep)
    _sweep_file.find_encoder(definition)
    folder = options.output
    if options.plot or options.sheet:
        from . import _sweep_figures  # matplotlib is not needed without figures
        for columns in options.plot:
            _sweep_figures.find_columns(definition, columns)
    if options.check:
        return _check(console, definition, folder)
    how = _run_sweep.Run(folder, shard, options.jobs or len(os.sched_getaffinity(0)), options.force,
                         _known_gl(options.backend, options.require_gpu))
    console.detail(f"jobs: {how.jobs}, encoder: {definition.encoder or 'none'}")
    result = _run_sweep.run_sweep(definition, how, _console.Progress(console, "sweep"))
    wall_s = time.monotonic() - start
    _tell(console, definition, result, wall_s)
    console.result(folder)
    figures = []
    for columns in options.plot:
        figures += _sweep_figures.write_plot(definition, folder, columns)
    if options.sheet:
        figures.append(_sweep_figures.write_sheet(definition, folder, how.gl))
    for path in figures:
        console.result(path)
    console.report({"schema": 1, "output": folder, "samples": definition.samples, "shards": result.shards,
                    "shards_made": result.shards_made, "samples_made": result.samples_made, "failed": result.failed,
                    "complete": result.is_complete, "figures": figures, "wall_s": wall_s})
    return 0


def _tell(console, definition, result, wall_s):
    """Tells what a run made; raises Error (code 3) if the scene refused all samples."""
    counted = _console.counted
    if result.shards_made < result.shards:
        console.info(f"{result.shards - result.shards_made} of {result.shards} shards were there already")
    if result.samples_made:
        console.info(f"{counted(result.shards_made, 'shard')} made, {counted(result.samples_made, 'sample')} in {wall_s:.3g} s, "
                     f"{result.samples_made / wall_s:.1f} per second")
    first = f"the first, {result.first_failure}, by {definition.source}"
    if result.is_complete and result.failed == definition.samples:
        raise make_error(f"all samples were refused; {first}", 3)
    if result.failed:
        console.warning(f'{counted(result.failed, "sample")} refused, see column "failure" of metadata.csv; {first}')
    if not result.is_complete:
        console.info("other shards are missing; run it without --shard when they are done")


def main(argv):
    """Runs `python3 -m corda sweep` with these arguments; returns the exit code."""
    return _console.run(argv, _parser(), _sweep)
