"""The class Film: a scene as pictures."""

import base64
import decimal
import numbers
import os
import tempfile

from . import _corda
from ._arguments import (answering, checked_text, frame_index, given_motion, gl_options, in_words_of_the_caller, make_error,
                         path_bytes, setting_lines, to_float)
from ._corda import Error


class Film:
    """A scene as pictures: planned and simulated once, then drawn in any order. A sequence of its frames, in the order of
    time: len(film), film[k], film[-1], film[0:10], for frame in film.

    path: a scene file; or `text`, the scene itself as TOML. Other keywords set keys of the scene, like --set of the program:
    size=(width, height), fps, duration, crf, preset, codec and jobs by these names, other keys by their own name with two
    underscores for the dot (world__drag=0.1), or in `settings`, a dictionary ({"rope[0].mass": 2}). Values are numbers of any
    kind, text, and lists, arrays and dictionaries of these; None leaves a key unchanged. `backend` and `require_gpu` choose
    OpenGL like --backend and --require-gpu.

    positions, times: a motion in place of a simulation, such as one of MuJoCo, a measurement or an integrator of your own:
    float64 of shape (n, particles, 2) in m, ropes before nets, at n increasing times in s, the first of them at most 0. Between
    these times, particles move along cubic polynomials. The bodies and their look are those of the scene, the duration is the
    last time unless the scene or a keyword gives it, and the plan's methods are "given". Velocities follow from the positions;
    tensions are NaN.

    Raises Error for a scene that cannot be read (code 6) or is invalid (3); reading or drawing raises Error for a motion that
    diverges (8), an unknown backend (2), and drawing without OpenGL (4). Warns before a simulation of many seconds. Ctrl-C ends
    every call. Threads may share a film; it serves one at a time, without holding the interpreter's lock.
    """

    #: Largest video in bytes that a notebook embeds.
    largest_embedded = 32_000_000

    #: For corda.plot: see corda/_motion.py.
    _motion = None

    def __init__(self, path=None, *, text=None, positions=None, times=None, settings=None, backend=None, require_gpu=False,
                 **keys):
        if (path is None) == (text is None):
            raise TypeError("Film takes a path or text=..., and not both")
        lines = setting_lines(settings, keys)
        source = path_bytes(path) if path is not None else b"text"
        self._gl = gl_options(backend, require_gpu)
        given = given_motion(positions, times)
        try:
            self._film = _corda.Film(checked_text(text or "", "text"), source, path is not None, list(lines), *self._gl, given)
        except Error as error:
            raise in_words_of_the_caller(error, lines) from None

    def __len__(self):
        """Number of frames of the scene's video."""
        return self._film.frame_count()

    def __getitem__(self, k):
        """film[k]: the same as frame(k). film[first:end:step]: a list of frames."""
        if isinstance(k, slice):
            return [self.frame(i) for i in range(*k.indices(len(self)))]
        return self.frame(k)

    def __iter__(self):
        """All frames, drawn one after the other."""
        return map(self.frame, range(len(self)))

    def __repr__(self):
        width, height = self.size
        return f"<corda.Film of {len(self)} frames, {width}x{height} at {self.fps:g} per second>"

    @property
    def size(self):
        """Width and height of a frame in pixels."""
        return self._film.size()

    @property
    def fps(self):
        """Frames per second; frame k is at exactly k / fps."""
        numerator, denominator = self._film.fps()
        return numerator / denominator

    def frame(self, k):
        """Frame `k`, -len(film) <= k < len(film), negative ones counted from the end, as numpy uint8 of shape (height, width,
        4). Raises IndexError for other numbers, TypeError for what is no integer."""
        return self._film.frame(frame_index(k, self))

    def still(self, time, shutter=0.0):
        """The picture at a time in seconds, 0 .. duration, like frame(); `shutter`, 0 .. 1, blurs it like video.shutter.
        Raises Error (code 2) for other values."""
        return self._film.still(to_float(time, "time"), to_float(shutter, "shutter"))

    def save_still(self, path, times, *, width_mm=None, ppi=None, font_pt=None, force=False):
        """Draws the poses at one or more times in s, 0 .. duration, in one picture, earlier ones fainter, like `corda still`
        and `corda strobe`; the extension of `path`, .png, .svg or .pdf, chooses the format.

        width_mm: its width in print, 1 .. 10000; without it, the picture has the pixels of a frame. ppi: pixels per inch, 1 ..
        10000; 96, or 300 with width_mm, whose pixels it sets. font_pt: the size of letters in points, 1 .. 100; with width_mm,
        8 unless the scene has overlay.text_px. force: replace an existing file. Raises Error: code 2 for times, sizes or
        extension, 6 for a file that exists or cannot be written, 4 without OpenGL for .png.
        """
        times = [times] if isinstance(times, (numbers.Real, decimal.Decimal)) else times
        times = sorted({to_float(time, "times") for time in times})
        sizes = []
        for name, value, most, unit in (("width_mm", width_mm, 10000.0, "mm"), ("ppi", ppi, 10000.0, "pixels per inch"),
                                        ("font_pt", font_pt, 100.0, "points")):
            if value is not None and not 1.0 <= to_float(value, name) <= most:
                raise make_error(f"{name}: takes 1 .. {most:.0f} {unit}, not {value!r}")
            sizes.append(value if value is None else float(value))
        self._film.save_still(path_bytes(path), times, *sizes, bool(force))

    @property
    def positions(self):
        """Positions of all particles in all frames, in metres: float64 of shape (frames, particles, 2), ropes before nets."""
        return self._film.positions()

    @property
    def velocities(self):
        """Velocities of all particles in all frames, in m/s, 0 for pinned ones; shaped like positions. The first of
        velocities, tensions and energy to be read simulates the motion once more."""
        return self._film.velocities()

    @property
    def tensions(self):
        """Tensions of all links in all frames, in N, positive if they pull: float64 of shape (frames, links), body by body.
        NaN where the method does not know them."""
        return self._film.tensions()

    @property
    def energy(self):
        """Kinetic, potential and total energy of all bodies in all frames, in J: float64 of shape (frames, 3). The potential
        energy of the weight is 0 in frame 0."""
        return self._film.energy()

    def to_pixels(self, positions):
        """Positions in m, of shape (..., 2), in pixels of a frame, y down: a pixel's centre is at (column + 0.5, row + 0.5).
        If the camera moves, positions are those of all frames, of shape (frames, n, 2). Raises ValueError for another shape."""
        return self._film.to_pixels(positions)

    def mask(self, k):
        """The body at each pixel of frame `k` without motion blur, as numpy uint8 of shape (height, width): 0 for the ground,
        else 1 + the index of the body in front (ropes before nets). A pixel belongs to a body that covers at least half of it;
        supports, annotations and bars beyond the links are not in it. Raises IndexError as frame(), and Error (code 2) for more
        than 255 bodies."""
        return self._film.mask(frame_index(k, self))

    @property
    def times(self):
        """Times of all frames, in seconds: float64 of shape (frames,)."""
        return self._film.times()

    @property
    def plan(self):
        """The plan of the film: a dictionary of methods (one per body), error_estimate_m, error_estimate_px, horizon_s and
        notes (a list of what to know about the choice); unknown values are None."""
        return self._film.plan()

    @property
    def camera(self):
        """center (x, y) and height in metres, and margin, a share of the shorter side."""
        return self._film.camera()

    def save(self, path, *, force=False, resume=False, on_progress=None):
        """Renders the video; the extension of `path` chooses the format. Returns the number of frames.

        force: replace an existing file. resume: of pictures ("frames/%06d.png"), draw those that are missing or damaged.
        on_progress: called with the number of finished frames and of all frames, at most every 50 ms and at the end; returning
        False stops, which raises Error (code 130): there is no video then, and pictures that are finished stay. It must not use
        this film, which raises Error (code 2).
        """
        return self._film.save(path_bytes(path), bool(force), bool(resume), answering(on_progress))

    def _repr_html_(self):
        """The film as a video in a notebook: MP4, or WebM if its background is transparent. Odd sides get one more pixel."""
        ending, fitted = self._film.for_browser(*self._gl)
        film = fitted or self._film
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "film" + ending)
            film.save(path, False, False, None)
            if os.path.getsize(path) > self.largest_embedded:
                return (f"<p>{os.path.getsize(path)} bytes of video are more than a notebook should hold; use "
                        "film.save(...), or a smaller size, rate or duration</p>")
            with open(path, "rb") as file:
                data = base64.b64encode(file.read()).decode("ascii")
        width, height = film.size()
        return (f'<video controls loop width="{width}" height="{height}" '
                f'src="data:video/{ending[1:]};base64,{data}"></video>')
