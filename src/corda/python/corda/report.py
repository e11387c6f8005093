"""`python3 -m corda report`: the figures that a paper needs of a scene, for print, and a page with all of them.

See section "Reports" of src/corda/python/README.md.
"""

import fractions
import io
import math
import os
import pathlib
import re
import sys
import time

import numpy as np

from . import Error, Film, __version__, _console, _corda
from ._archive import csv_text, save_file
from ._arguments import make_error, path_bytes
from ._motion import motion_of

#: Widths of figures in print, a column and a page of a journal, and the resolution of PNGs in pixels per inch.
WIDTHS_MM = (85, 170)
PPI = 300
_MM_PER_INCH = 25.4
_PT_PER_INCH = 72.0


def _parser():
    parser = _console.Parser(prog="python3 -m corda report", description="Write the figures that a paper needs of a scene, for "
                             "print (SVG, PDF and PNG), their numbers as CSV, and a page with all of them.")
    parser.add_argument("scene", metavar="SCENE", help="scene file (TOML), or - for standard input")
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="folder of the report")
    times = parser.add_mutually_exclusive_group()
    times.add_argument("--at", metavar="T[,T...]", help="times of the strobe and the stills in seconds, e.g. 0,0.5,1.25")
    times.add_argument("--frame", metavar="K[,K...]", help="the same as frames of the video from 0, or ranges FIRST:END")
    parser.add_argument("--font-pt", type=float, default=9.0, metavar="PT", help="size of all letters in points (9)")
    parser.add_argument("--fps", metavar="R", help="rows per second (--set video.fps)")
    parser.add_argument("--duration", metavar="S", help="seconds (--set world.duration)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                        help="override a key of the scene, e.g. rope[0].mass=2")
    parser.add_argument("--backend", metavar="NAME", help="how to reach OpenGL: auto, device, device:N, surfaceless or default")
    parser.add_argument("--require-gpu", action="store_true", help="refuse to draw on the CPU (exit 4)")
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument("--dry-run", action="store_true", help="check everything but OpenGL, and write nothing")
    return parser


def main(argv):
    """Runs the command `report` with the arguments after its name; returns its exit code."""
    return _console.run(argv, _parser(), _report)


def _film(options):
    """The film of the scene; a bad --fps or --duration is a wrong command line, and not a bad scene."""
    for name in ("output", "scene", "at", "frame", "fps", "duration", "backend"):
        if getattr(options, name) == "":
            raise make_error(f"--{name}: the value is empty; give one, or leave it out")
    own = [f"{key}={value}" for key, value in (("video.fps", options.fps), ("world.duration", options.duration)) if value]
    is_path = options.scene != "-"
    if not is_path and sys.stdin is None:
        raise make_error("standard input is closed; give a scene file", 6)
    text = b"" if is_path else sys.stdin.buffer.read()
    source = os.fsencode(options.scene) if is_path else b"stdin"
    gl = (options.backend or os.environ.get("CORDA_BACKEND") or "auto", options.require_gpu)

    def load(settings):
        film = Film.__new__(Film)
        film._gl = gl
        film._film = _corda.Film(text, source, is_path, settings, *gl, None)
        return film

    try:
        return load(options.settings + own)
    except Error as error:
        if error.code == 3 and own:
            load(options.settings)  # raises if the scene is bad without them, too
            error.code = 2
        raise


def _frames(word, count):
    """The frames that a word of --frame names."""
    first, colon, end = word.partition(":")
    try:
        first = int(first) if first or not colon else 0
        end = (int(end) if end else count) if colon else first + 1
    except ValueError:
        raise make_error(f"--frame {word}: is neither a frame number nor a range FIRST:END of them") from None
    if not 0 <= first < end <= count:
        raise make_error(f"--frame {word}: the frames are 0 to {count - 1}, all of them the range 0:{count}; world.duration sets "
                         "the end")
    return range(first, end)


def _asked_times(options, film, facts):
    """The times of --at or --frame in s, increasing."""
    if not 1.0 <= options.font_pt <= 18.0:
        raise make_error(f"--font-pt {options.font_pt:g}: takes 1 .. 18 points")
    try:
        times = [float(word) for word in options.at.split(",")] if options.at else []
    except ValueError:
        raise make_error(f"--at {options.at}: takes times in seconds, such as 0,0.5,1.25") from None
    duration, rate = facts["duration"], fractions.Fraction(facts["rate"])
    for time_s in times:
        if not 0.0 <= time_s <= duration:
            raise make_error(f"--at {time_s:g}: is not within 0 .. {duration:g} s; world.duration sets the end")
    for word in options.frame.split(",") if options.frame else []:
        times += [float(k / rate) for k in _frames(word, len(film))]
    return sorted(set(times))


class Folder:
    """The folder of a report. A file has its name only if it is complete."""

    def __init__(self, path, force, dry_run):
        self.path = pathlib.Path(path)
        self.files = []
        try:
            there = next(part for part in (self.path.absolute(), *self.path.absolute().parents) if os.path.lexists(part))
            if not there.is_dir():
                raise make_error(f"{there}: exists and is not a folder; choose another name", 6)
            if not os.access(there, os.W_OK | os.X_OK):
                raise make_error(f"{there}: this folder cannot be written to; choose another one", 6)
            if not dry_run:
                self.path.mkdir(parents=True, exist_ok=True)
            if not force and self.path.is_dir() and any(self.path.iterdir()):
                raise make_error(f"{path}: is not empty; give --force to replace files of the same names", 6)
        except OSError as error:
            raise make_error(f"{error.filename}: cannot be written: {error.strerror}; choose another folder", 6) from None

    def write(self, name, data):
        """Writes bytes or a text as the file of that name."""
        path = self.path / name
        try:
            if path.is_symlink():
                path.unlink()  # --force replaces the link itself
        except OSError as error:
            raise make_error(f"{path}: cannot be replaced: {error.strerror}", 6) from None
        save_file(path, data.encode("utf-8", "surrogateescape") if isinstance(data, str) else data)
        self.note(name)

    def note(self, name):
        """Counts a file that other code has written."""
        self.files.insert(0, str(self.path / name))


# CSV files.


def _columns(motion):
    """The files of numbers with a row per frame: their columns as pairs of a key with its unit and an array."""
    total = motion.energies.sum(axis=1)
    tip, tension, strain = [], [], [("largest", np.abs(motion.strains).max(axis=1, initial=0.0))]
    for track in motion.tracks:
        body = track.body
        position = track.position + np.asarray(motion.origin)
        tip += [(f"{body.key}_{what}", values) for what, values in
                zip(("x_m", "y_m", "vx_m_s", "vy_m_s"), (*position.T, *track.velocity.T))]
        if track.arm is not None:
            tip += list(zip((f"{body.key}_angle_rad", f"{body.key}_angular_velocity_rad_s"), track.angle))
        tension += list(zip((f"{body.key}_largest_n", f"{body.key}_link"), motion.largest(motion.tensions, body)))
        strain += list(zip((f"{body.key}_largest", f"{body.key}_link"), motion.largest(motion.strains, body)))
    energy = [*zip(("kinetic_j", "weight_since_start_j", "elastic_j"), motion.energies.T), ("total_since_start_j", total),
              ("energy_error", motion.energy_errors)]
    return {"tip.csv": tip, "energy.csv": energy, "tension.csv": tension, "strain.csv": strain}


def _write_numbers(motion, folder):
    for name, columns in _columns(motion).items():
        rows = np.stack([motion.times, *(values for _, values in columns)], axis=1).tolist()
        folder.write(name, csv_text(["t_s", *(key for key, _ in columns)], rows))
    if motion.tension is not None:
        body = motion.bodies[motion.tension.body]
        tensions = motion.tensions[motion.times == motion.tension.time][0, body.links]
        rows = np.stack([np.arange(len(tensions)), body.rest_m, tensions], axis=1).tolist()
        folder.write("tension_along.csv", csv_text(["link", "rest_length_m", "tension_n"], rows))


# Figures.


def _in_millimetres(svg):
    """An SVG of matplotlib with its size in millimetres in place of points."""
    def size(found):
        return b'%s="%.6gmm"' % (found[1], float(found[2]) / _PT_PER_INCH * _MM_PER_INCH)

    def tag(found):
        return re.sub(rb'\b(width|height)="([0-9.]+)pt"', size, found[0])

    return re.sub(rb"<svg [^>]*", tag, svg, count=1)


def _plot_files(figure, width_mm, font_pt):
    """The bytes of a plot by the endings of its files, the same on every run."""
    import matplotlib
    from matplotlib.figure import Figure

    style = {"font.size": font_pt, "font.family": "DejaVu Sans", "axes.labelsize": font_pt, "xtick.labelsize": font_pt,
             "ytick.labelsize": font_pt, "axes.linewidth": 0.5, "xtick.major.width": 0.5, "ytick.major.width": 0.5,
             "svg.hashsalt": "corda", "svg.fonttype": "path", "pdf.fonttype": 42, "pdf.compression": 6,
             "figure.facecolor": "white", "savefig.facecolor": "white"}
    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # whatever the user's own style is
        matplotlib.rcParams.update(style)
        width, letter = width_mm / _MM_PER_INCH, font_pt / _PT_PER_INCH  # in inches
        page = Figure(figsize=(width, width), layout="constrained")
        axes = page.add_subplot()
        figure.plot(axes)
        # Beside the axes are a title and numbers, and above them names, whose rows are as high as 1.6 letters.
        legend = axes.get_legend()
        rows = math.ceil(len(legend.get_texts()) / legend._ncols) if legend else 0
        page.set_figheight(figure.height_per_width * (width - 5.0 * letter) + (4.0 + 1.6 * rows) * letter)
        for _ in range(3):  # a long name of the vertical axis needs a higher page
            page.draw_without_rendering()
            name = axes.yaxis.label.get_window_extent()
            beyond = max(-name.y0, name.y1 - page.bbox.y1) / page.dpi
            if beyond <= 0.0:
                break
            page.set_figheight(page.get_figheight() + 2.0 * beyond + 0.5 * letter)
        page.set_layout_engine("none")  # the layout is the same in all formats
        made = {"Creator": f"corda {__version__}", "Title": figure.title}
        files = {}
        for ending, metadata in (("svg", {"Date": None, **made}), ("png", {"Software": f"corda {__version__}"}),
                                 ("pdf", {"CreationDate": None, **made})):
            file = io.BytesIO()
            page.savefig(file, format=ending, dpi=PPI, metadata=metadata)
            files[ending] = file.getvalue()
    files["svg"] = _in_millimetres(files["svg"])
    return files


def _write_figure(figure, film, folder, options, svgs):
    """Writes the files of a figure, and keeps the SVG of the page."""
    shown_mm = WIDTHS_MM[0] if figure.is_small else WIDTHS_MM[-1]
    for width_mm in WIDTHS_MM:
        files = _plot_files(figure, width_mm, options.font_pt) if figure.plot else {}
        for ending in ("svg", "png", "pdf"):
            name = f"{figure.id}_{width_mm}mm.{ending}"
            if figure.plot:
                folder.write(name, files[ending])
            else:
                film._film.save_report_still(path_bytes(folder.path / name), figure.times, width_mm, options.font_pt, options.force)
                folder.note(name)
            if ending == "svg" and width_mm == shown_mm:
                svgs[figure.id] = (folder.path / name).read_bytes()


def _in_language(language, chapters):
    """Translates headings of chapters and tables, and gives sentences the decimal sign of the language."""
    def localized(text):
        return text if language == 0 else re.sub(r"(?<=\d)\.(?=\d)", ",", text)

    for chapter in chapters:
        chapter.title = _corda.translated(chapter.title, language)
        chapter.summary = localized(chapter.summary)
        chapter.paragraphs = [localized(paragraph) for paragraph in chapter.paragraphs]
        for table in chapter.tables:
            table.title = _corda.translated(table.title, language)
        for figure in chapter.figures:
            figure.title = localized(_corda.translated(figure.title, language))
            figure.caption = localized(figure.caption)
    return localized


class _Report:
    """A report that is being written."""

    def __init__(self, film, motion, options, folder, chapters):
        self.film, self.options, self.folder, self.chapters = film, options, folder, chapters
        self.motion = motion
        self.localized = _in_language(motion.language, chapters)
        self.svgs = {}

    def draw(self, progress):
        """Draws all figures."""
        figures = [figure for chapter in self.chapters for figure in chapter.figures]
        for table in (table for chapter in self.chapters for table in chapter.tables):
            self.folder.write(f"{table.id}.csv", csv_text(table.keys, table.rows))
        for done, figure in enumerate(figures):
            progress(done, len(figures))
            _write_figure(figure, self.film, self.folder, self.options, self.svgs)
        progress(len(figures), len(figures))

    def write_page(self, ends_early=None):
        """Writes the page with the figures that are drawn."""
        from ._page import Page

        motion, localized = self.motion, self.localized
        title = motion.title or _corda.translated("Report of {}", motion.language).replace("{}", motion.name)
        setting = [("Bodies", motion.system), ("Method", motion.solver), ("Duration", f"{motion.duration:g} s"),
                   ("Rows", f"{motion.rate} per second")]
        rest = [("Corda", __version__)] + ([("Ends early", ends_early)] if ends_early else [])
        self.folder.write("setting.csv", csv_text(["name", "value"], setting + rest))
        shown = [(name, localized(value)) for name, value in setting] + rest
        page = Page(WIDTHS_MM, self.svgs, motion.language)
        self.folder.write("report.html", page.html(title, self.chapters, _corda.translated("Setting", motion.language), shown))


def _with_files(error, folder):
    files = folder.files
    written = f"{len(files)} files are written, the last of them is {files[0]}" if files else "nothing was written"
    return f"{error or 'interrupted'}; {written}"


def _write_report(film, asked, options, console, folder):
    """Writes the report; returns its motion. After an interruption and most errors, there is a page of the figures so far."""
    from . import _chapters

    progress = _console.Progress(console, "draw")
    report = None
    try:
        motion = motion_of(film)
        _write_numbers(motion, folder)
        chapters = _chapters.chapters_of(motion, film, _chapters.drawing_times(motion, asked))
        report = _Report(film, motion, options, folder, chapters)
        report.draw(progress)
        report.write_page()
    except (KeyboardInterrupt, Error) as error:
        progress.end()
        if report is not None and getattr(error, "code", 130) != 6:
            report.write_page(str(error) or "interrupted")
        error.args = (_with_files(error, folder),)
        raise
    progress.end()
    if motion.failure is not None:
        raise make_error(_with_files(motion.failure, folder), 8)
    return motion


def _json_of(film, facts):
    plan, camera = film.plan, film.camera
    return {"schema": 1, "method": facts["method"], "solver": facts["solver"], "particles": len(facts["mass_kg"]),
            "bars": facts["bars"], "links": sum(len(body["rest_m"]) for body in facts["bodies"]),
            "error_estimate_m": plan["error_estimate_m"], "error_estimate_px": plan["error_estimate_px"],
            "horizon_s": plan["horizon_s"], "camera": {"center": list(camera["center"]), "height": camera["height"]},
            "notes": plan["notes"], "simulation_passes": facts["simulation_passes"]}


def _report(console, options):
    start = time.monotonic()
    try:
        from . import plot as _  # noqa: F401
    except ImportError as error:
        raise make_error(str(error)) from None
    film = _film(options)
    facts = film._film.facts()
    asked = _asked_times(options, film, facts)
    if not options.dry_run:
        film.still(0.0)  # raises without usable OpenGL, before anything is written
    folder = Folder(options.output, options.force, options.dry_run)
    for note in film.plan["notes"]:
        console.warning(note)
    if facts["estimate"] is not None:
        console.info(f"{facts['solver']}; error estimate {facts['estimate']}, from tighter runs")
    if options.dry_run:
        console.info(f"would write a report into {options.output}")
        console.report(_json_of(film, facts))
        return 0
    _write_report(film, asked, options, console, folder)
    seconds = time.monotonic() - start
    console.info(f"{len(folder.files)} files in {seconds:.3g} s")
    for path in folder.files:
        console.result(path)
    console.report({**_json_of(film, film._film.facts()), "folder": options.output, "files": folder.files, "wall_s": seconds})
    return 0
