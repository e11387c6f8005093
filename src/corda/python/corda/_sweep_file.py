"""Reading and checking of sweep files: see section "Sweep file" of src/corda/python/README.md."""

import dataclasses
import datetime
import difflib
import json
import math
import os
import re
import sys
import tomllib

from . import _corda
from ._arguments import make_error, path_bytes
from ._corda import Error
from ._distributions import SHAPES, Distribution, rounded

MAX_SAMPLES = 1_000_000_000
MAX_SHARD_SAMPLES = 1_000_000
PICTURES = ("mp4", "png", "npz", "none")
LABELS = ("positions", "velocities", "tensions", "energy", "pixels", "mask")
SUMMARY = ("period_s", "angle_max_deg", "tension_max_n", "speed_max_m_s", "strain_max", "energy_error", "error_estimate_m",
           "error_estimate_px", "horizon_s")
_MAX_FILE_BYTES = 16 << 20
_MAX_COMPONENTS = 1 << 16
_MAX_RANGE = 1_000_000


@dataclasses.dataclass
class Definition:
    """A sweep file that was read and checked, with the text of its scene. Processes hand it to each other."""

    source: str = ""  #: path of the file, as messages name it
    scene_name: str = ""  #: path of the scene, as the file gives it
    scene_source: str = ""  #: the same, from the current folder
    scene_toml: str = ""
    samples: int = 0
    is_grid: bool = False  #: every combination of the lists; the last key varies fastest
    seed: int = 0
    shard_samples: int = 256
    vary: dict = dataclasses.field(default_factory=dict)  #: a list of values or a Distribution by key, in the order of the file
    pictures: str = "mp4"
    encoder: str = ""  #: of "mp4", with its versions, on which clips depend: see find_encoder()
    labels: list = dataclasses.field(default_factory=lambda: list(LABELS))
    summary: list = dataclasses.field(default_factory=lambda: list(SUMMARY))
    splits: dict = dataclasses.field(default_factory=dict)  #: shares with the sum 1 by name, or none


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def number_text(value):
    """The shortest decimal text of a float, as C++ writes it: "0.08", "1e-9", "2"."""
    if not math.isfinite(value):
        return str(value)
    if value == 0.0:
        return "-0.0" if math.copysign(1.0, value) < 0.0 else "0"
    mantissa, _, exponent = repr(value).partition("e")
    mantissa = mantissa.removesuffix(".0")
    plain = f"{mantissa}e{int(exponent)}" if exponent else mantissa
    if 1e-3 <= abs(value) < 1e5:
        return plain
    short = re.sub(r"e\+?(-?)0*", r"e\1", f"{value:g}")
    return short if float(short) == value and len(short) < len(plain) else plain


def toml_of(value):
    """A value of TOML on one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return number_text(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_quoted(key)} = {toml_of(value[key])}" for key in sorted(value)) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_of, value)) + "]"
    return _quoted(value) if isinstance(value, str) else str(value)


def value_text(value):
    """A value as it stands in CSV and in messages: text without quotes."""
    return value if isinstance(value, str) else toml_of(value)


def _quoted(text):
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def short_text(text):
    """Text of a file as it may stand in a message, on one line of at most 60 characters."""
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    return shown if len(shown) <= 60 else shown[:60] + "..."


def _described(value):
    if isinstance(value, dict):
        return "this is a table"
    if isinstance(value, list):
        return f"this is a list of {len(value)}"
    if isinstance(value, str):
        return f'"{short_text(value)}" is a string'
    if isinstance(value, bool):
        return f"{toml_of(value)} is a boolean"
    if isinstance(value, int):  # hexadecimal ones may have more digits than Python prints
        return f"{value} is an integer" if -2**63 <= value < 2**63 else "this is an integer beyond 64 bits"
    if isinstance(value, float):
        if value.is_integer() and abs(value) < 1e15:
            return f"{value:.1f} is a number with a point"
        return f"{number_text(value)} is a number with a fraction"
    return "this is a date or a time"


def _is_plain(value):
    """Whether a value has neither dates and times nor numbers that a scene cannot hold."""
    if isinstance(value, (list, dict)):
        return all(map(_is_plain, value.values() if isinstance(value, dict) else value))
    if isinstance(value, int):
        return -2**63 <= value < 2**63
    return not isinstance(value, (datetime.date, datetime.time)) and (not isinstance(value, float) or math.isfinite(value))


def nearest(word, known):
    """The known word that a misspelt one, or the beginning of one, probably stands for; None if there is none."""
    begun = [one for one in known if word and one.startswith(word)]
    close = begun if len(begun) == 1 else difflib.get_close_matches(word, known, 1, 0.7)
    return close[0] if close else None


def key_steps(key):
    """The names and indices of a dotted key: ("rope", 0, "mass")."""
    return tuple(int(step) if step.isascii() and step.isdecimal() else step for step in re.findall(r"[^.\[\]\s]+", key))


def section_of(key):
    """The section of a dotted key, without indices, and its name, "" if it has no dot: "rope.hang" and "links"."""
    path = re.sub(r"\[[^\]]*\]?", "", key)
    section, dot, name = path.rpartition(".")
    return (section, name) if dot else (path, "")


class _Places:
    """Lines and columns of keys and values in TOML text whose keys stand on lines of their own, as they do in sweep files."""

    _HEADER = re.compile(r"\s*\[\s*([^\[\]]+?)\s*\]\s*(?:#.*)?$")
    _KEY = re.compile(r"""\s*("(?:[^"\\]|\\.)*"|'[^']*'|[\w-]+(?:\s*\.\s*[\w-]+)*)\s*=\s*""")

    def __init__(self, text, document):
        self._places = {}
        section = ()
        for line, content in enumerate(text.split("\n"), 1):
            header = self._HEADER.match(content)
            if header and isinstance(document.get(self._steps(header[1])[0]), dict):  # not a line of a list, such as [0.0, 1.0]
                section = self._steps(header[1])
                self._places.setdefault(section, ((line, header.start(1)), (line, header.start(1))))
            elif key := self._KEY.match(content):
                place = (line, key.start(1) + 1), (line, key.end() + 1)
                self._places.setdefault(section + self._steps(key[1]), place)
                if not content.startswith("{", key.end()):
                    continue
                for inner in self._KEY.finditer(content, key.end() + 1):
                    place = (line, inner.start(1) + 1), (line, inner.end() + 1)
                    self._places.setdefault(section + self._steps(key[1]) + self._steps(inner[1]), place)

    @staticmethod
    def _steps(name):
        if name[0] == '"':
            try:
                return (json.loads(name),)
            except ValueError:
                return (name,)
        return (name[1:-1],) if name[0] == "'" else tuple(part.strip() for part in name.split("."))

    def of(self, path, is_key=False):
        for length in range(len(path), 0, -1):
            for known, places in self._places.items():
                if known[:length] == path[:length]:
                    return places[0 if is_key else 1]
        return 1, 1


class _Reader:
    """Reads the tables of a sweep file into a Definition, and collects their problems."""

    def __init__(self, document, text, sweep):
        self._document = document
        self._places = _Places(text, document)
        self._sweep = sweep
        self._problems = {}

    def read(self):
        sweep, document = self._sweep, self._document
        self._refuse_others((), document,
                            ("schema", "scene", "samples", "grid", "seed", "shard_samples", "vary", "output", "split"))
        if self._integer("schema", 1, 1) is None:
            self._missing("schema", "give schema = 1")
        name = document.get("scene")
        if name == "-":
            self._fail(("scene",), '"-" is standard input, which the sweep file alone may be; give the path of a scene (./- for a '
                       "file of this name)")
        elif isinstance(name, str) and name:
            sweep.scene_name = name
        elif name is not None:
            self._fail(("scene",), f"{_described(name)}; give the path of a scene, relative to this file")
        self._missing("scene", "give the path of a scene, relative to this file")
        self._read_vary()
        self._read_samples()
        sweep.seed = self._integer("seed", 0, 2**63 - 1) or 0
        sweep.shard_samples = self._integer("shard_samples", 1, MAX_SHARD_SAMPLES) or 256
        self._read_output()
        self._read_split()
        self.raise_if_any()

    def check_scene_keys(self):
        """Refuses keys of [vary] that overlap or do not fit the scene, before every sample does."""
        sweep = self._sweep
        for inner in sweep.vary:
            for outer in sweep.vary:
                if inner != outer and key_steps(inner)[: len(key_steps(outer))] == key_steps(outer):
                    self._fail(("vary", inner), f'lies within "{outer}", which varies, too; leave one of them out')
        self.raise_if_any()
        for key in sweep.vary:
            misfit = _corda.misfit(sweep.scene_toml, os.fsencode(sweep.scene_source), key)
            if misfit:
                self._fail(("vary", key), f"does not fit {sweep.scene_name}: {misfit}")
        self.raise_if_any()

    def raise_if_any(self):
        """Raises all problems, one per line in the order of the file."""
        if self._problems:
            raise make_error("\n".join(f"{self._sweep.source}:{line}:{column}: {key}: {problem}" for key, (line, column, problem) in
                                       sorted(self._problems.items(), key=lambda item: item[1])), 3)

    def place(self, *path):
        return ":".join(map(str, (self._sweep.source, *self._places.of(path))))

    def _fail(self, path, problem, name=None, is_key=False):
        shown = name or ".".join([path[0], *(_quoted(step) if path[0] == "vary" else step for step in path[1:2]), *path[2:]])
        self._problems.setdefault(shown, (*self._places.of(path, is_key), problem))

    def _missing(self, key, remedy):
        if key not in self._document:
            self._fail((key,), f"is missing; {remedy}")

    def _refuse_others(self, path, table, known):
        for key in table:
            if key in known:
                continue
            meant = nearest(key, known)
            remedy = f'did you mean "{meant}"?' if meant else f"there are {', '.join(known)}"
            self._fail((*path, key), f'unknown key "{short_text(key)}"; {remedy}', is_key=True)

    def _integer(self, key, low, high):
        value = self._document.get(key)
        if value is None or (isinstance(value, int) and not isinstance(value, bool) and low <= value <= high):
            return value
        wanted = f"give {low}" if low == high else f"give an integer, {low} .. {high}"
        self._fail((key,), f"{_described(value)}; {wanted}")
        return None

    def _table(self, key):
        value = self._document.get(key)
        if value is None or isinstance(value, dict):
            return value
        self._fail((key,), f"{_described(value)}; give a table [{key}]")
        return None

    def _read_samples(self):
        sweep = self._sweep
        grid = self._document.get("grid", False)
        if not isinstance(grid, bool):
            self._fail(("grid",), f"{_described(grid)}; give true or false")
        sweep.is_grid = bool(grid)
        samples = self._integer("samples", 1, MAX_SAMPLES)
        if not sweep.is_grid:
            self._missing("samples", "give a number of samples, or grid = true for every combination of lists")
            sweep.samples = samples or 0
            return
        if samples is not None:
            self._fail(("samples",), "a grid has a sample for each combination; leave it out")
        for key, values in sweep.vary.items():
            if isinstance(values, Distribution):
                self._fail(("vary", key), "a distribution has no combinations; give a list of values, or leave out grid")
        sweep.samples = math.prod(len(values) for values in sweep.vary.values() if isinstance(values, list))
        if sweep.samples > MAX_SAMPLES:
            self._fail(("grid",), f"more than {MAX_SAMPLES} combinations; give shorter lists")

    def _read_vary(self):
        vary = self._table("vary")
        if vary is None and "vary" in self._document:
            return
        if not vary:
            self._fail(("vary",), "no key varies; give [vary] with keys of the scene and their values")
            return
        for key, value in vary.items():
            problem = _key_problem(key)
            if problem:
                self._fail(("vary", key), problem, is_key=True)
            elif isinstance(value, list):
                for one in value:
                    if not _is_plain(one):
                        self._fail(("vary", key), f"{_described(one)}; no key of a scene takes a date, a time, inf or nan")
                if not value:
                    self._fail(("vary", key), "an empty list; give values to choose from")
                self._sweep.vary[key] = value
            elif isinstance(value, dict) and "range" in value:
                self._read_range(key, value)
            elif isinstance(value, dict):
                self._read_distribution(key, value)
            else:
                self._fail(("vary", key), f"{_described(value)}; give a list of values, or a distribution such as "
                           "{ uniform = [1.0, 2.0] }")

    def _read_range(self, key, table):
        """The list of the numbers from the first to the last."""
        path = ("vary", key)
        if len(table) > 1:
            self._fail(path, "a range and a distribution; give one")
            return
        ends = table["range"]
        numbers = _numbers(ends, True) if isinstance(ends, list) and len(ends) == 3 else None
        first, last, step = numbers or (0.0, 0.0, 0.0)
        if step == 0.0 or not 0.0 <= (last - first) / step < math.inf:
            self._fail(path, "range is [first, last, step], three numbers; the step leads from the first to the last")
            return
        if (last - first) / step >= _MAX_RANGE:
            self._fail(path, f"range has more than {_MAX_RANGE} numbers; give a larger step")
            return
        count = 1 + math.floor((last - first) / step * (1.0 + 1e-12))
        if all(isinstance(end, int) for end in ends):
            first, step = ends[0], ends[2]
        self._sweep.vary[key] = [rounded(first + k * step) for k in range(count)]

    def _read_distribution(self, key, table):
        path = ("vary", key)
        self._refuse_others(path, table, (*SHAPES, "range", "min", "max"))
        shapes = [shape for shape in SHAPES if shape in table]
        if not shapes:
            if all(name in ("min", "max") for name in table):
                self._fail(path, f"no distribution; give {', '.join(SHAPES)}, range")
            return
        if len(shapes) > 1:
            self._fail(path, "two distributions; give one")
            return
        (shape,) = shapes
        is_sound, remedy, _ = SHAPES[shape]
        ends = table[shape]
        is_vector = isinstance(ends, list) and len(ends) == 2 and isinstance(ends[0], list)
        first, second = (_numbers(end, is_vector) for end in ends) if isinstance(ends, list) and len(ends) == 2 else (None, None)
        if not first or not second or len(first) != len(second) or not all(map(is_sound, first, second)):
            self._fail(path, f"{shape} {remedy}")
            return
        low, high = (self._bound(key, table, name, shape, is_vector, len(first)) for name in ("min", "max"))
        if any(a >= b for a, b in zip(low, high)):
            self._fail(path, "min is not less than max")
        self._sweep.vary[key] = Distribution(shape, is_vector, first, second, low, high)

    def _bound(self, key, table, name, shape, is_vector, count):
        open_bound = [-math.inf if name == "min" else math.inf] * count
        if name not in table:
            return open_bound
        given = _numbers(table[name], is_vector)
        if shape != "normal":
            self._fail(("vary", key, name), f"{name} bounds a normal distribution only; leave it out", f"vary.{_quoted(key)}")
        elif given and len(given) == count:
            return given
        else:
            self._fail(("vary", key, name), f"{name}: {_described(table[name])}; give as many numbers as normal has",
                       f"vary.{_quoted(key)}")
        return open_bound

    def _read_output(self):
        output = self._table("output")
        if output is None:
            return
        sweep = self._sweep
        self._refuse_others(("output",), output, ("pictures", "labels", "summary"))
        if self._word(("output", "pictures"), output.get("pictures", "mp4"), PICTURES):
            sweep.pictures = output.get("pictures", "mp4")
        # A mask is a picture, and takes as long to draw.
        default = [label for label in LABELS if label != "mask" or sweep.pictures != "none"]
        labels = self._words("labels", output, LABELS, default)
        sweep.labels = [label for label in LABELS if label in labels]
        sweep.summary = list(dict.fromkeys(self._words("summary", output, SUMMARY, SUMMARY)))

    def _word(self, path, value, known, name=None):
        if isinstance(value, str) and value in known:
            return True
        meant = nearest(value, known) if isinstance(value, str) else None
        remedy = f'did you mean "{meant}"?' if meant else f"give {', '.join(known)}"
        self._fail(path, f"{_described(value)}; {remedy}", name)
        return False

    def _words(self, key, output, known, default):
        given = output.get(key, list(default))
        if not isinstance(given, list):
            self._fail(("output", key), f"{_described(given)}; give a list of {', '.join(known)}")
            return []
        return [word for i, word in enumerate(given) if self._word(("output", key), word, known, f"output.{key}[{i}]")]

    def _read_split(self):
        split = self._table("split")
        if split is None:
            return
        for name, share in split.items():
            if not is_number(share) or not 0.0 <= share <= 1.0:
                self._fail(("split", name), f"{_described(share)}; give a share, 0 .. 1")
            if not name.isprintable() or not name or set(name) & set(',"/ '):
                self._fail(("split", name), "no name of a split; give a word such as train")
        sound = {name: float(share) for name, share in split.items() if is_number(share) and 0.0 <= share <= 1.0}
        total = sum(sound.values())
        if len(sound) == len(split) and not abs(total - 1.0) < 1e-9:
            self._fail(("split",), f"the shares have the sum {total:.6g}; give shares with the sum 1")
        self._sweep.splits = sound


def _numbers(value, is_vector):
    """The numbers of a value as floats; None if it has others."""
    entries = value if is_vector else [value]
    if not isinstance(entries, list) or not 0 < len(entries) <= _MAX_COMPONENTS or not all(map(is_number, entries)):
        return None
    try:
        numbers = [float(entry) for entry in entries]
    except OverflowError:
        return None
    return numbers if all(map(math.isfinite, numbers)) else None


def _key_problem(key):
    """Why a text is no key of a scene; "" if it is one."""
    section, name = section_of(key)
    if not name:
        return ('no key of a scene; quote a dotted key, such as "rope[0].hang.angle_deg" (see corda help scene)')
    keys = _corda.scene_keys(section)
    if name in keys:
        return ""
    meant = nearest(name, list(keys))
    return (f'no key of a scene; did you mean "{meant}" in place of "{short_text(name)}"?' if meant else
            "no key of a scene (see corda help scene)")


def _read_text(path, what):
    """The text of a file, or of standard input for "-"."""
    shown = "stdin" if path == "-" else path
    try:
        if path == "-":
            data = sys.stdin.buffer.read(_MAX_FILE_BYTES + 1)
        else:
            with open(path, "rb") as file:
                data = file.read(_MAX_FILE_BYTES + 1)
    except OSError as error:
        raise make_error(f"{shown}: cannot read the {what} file: {error.strerror}; give the path of a TOML file", 6) from None
    if len(data) > _MAX_FILE_BYTES:
        raise make_error(f"{shown}: more than {_MAX_FILE_BYTES} bytes, the limit; give a shorter file", 3)
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise make_error(f"{shown}:{line}: the {what} file is no UTF-8 text; save it as UTF-8", 3) from None


def _parse(text, source):
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise make_error(f"{source}: lists or tables are nested too deeply; no sweep needs that", 3) from None
    except ValueError as error:  # TOMLDecodeError, and integers of thousands of digits
        message = str(error)
        place = re.fullmatch(r"(.*) \(at line (\d+), column (\d+)\)", message, re.DOTALL)
        if place:
            line = text.split("\n")[int(place[2]) - 1]
            key = re.match(r"\s*([\w-]+(?:\[\d+\]|\.[\w-]+)*\[\d+\][\w.\[\]-]*)\s*=", line)
            problem = f'a key with an index needs quotes; write "{short_text(key[1])}" = ...' if key else place[1]
            raise make_error(f"{source}:{place[2]}:{place[3]}: {problem}", 3) from None
        end = text.rstrip("\n").count("\n") + 1
        raise make_error(f"{source}:{end}: {message.removesuffix(' (at end of document)')}", 3) from None


def load(path):
    """The definition in a sweep file, or in standard input for "-", with its scene.

    Raises Error: code 6 if a file cannot be read; 3 with all that is wrong in the sweep file, one problem per line with file, line,
    column and key, or with what is wrong in the scene.
    """
    path = os.fsdecode(path_bytes(path))
    sweep = Definition(source="stdin" if path == "-" else path)
    text = _read_text(path, "sweep").removeprefix("\ufeff")  # the mark of UTF-8 that some editors write
    reader = _Reader(_parse(text, sweep.source), text, sweep)
    reader.read()
    sweep.scene_source = os.path.join("" if path == "-" else os.path.dirname(path), sweep.scene_name)
    try:
        path_bytes(sweep.scene_source)
        sweep.scene_toml = _read_text(sweep.scene_source, "scene")
    except Error as error:
        raise make_error(f"{reader.place('scene')}: scene: {error}", error.code) from None
    _corda.check_scene(sweep.scene_toml, os.fsencode(sweep.scene_source))
    reader.check_scene_keys()
    return sweep


def find_encoder(sweep):
    """Sets the encoder of the clips of a sweep. Raises Error (code 2) if there is none for its scene."""
    if sweep.pictures == "mp4":
        sweep.encoder = _corda.encoder_of(sweep.scene_toml, os.fsencode(sweep.scene_source), "clip.mp4")
