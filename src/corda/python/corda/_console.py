"""Messages, progress and exit codes of `python3 -m corda`, like those of the program."""

import argparse
import contextlib
import errno
import json
import os
import signal
import sys
import time

from ._arguments import make_error
from ._corda import Error

_SECONDS_BETWEEN_BARS = 0.1
_SECONDS_BETWEEN_LINES = 2.0
_SECONDS_BEFORE_LINES = 1.0
_BAR_CELLS = 30


class UsageError(Exception):
    """A wrong command line."""


class Parser(argparse.ArgumentParser):
    """A parser that raises UsageError, and takes no abbreviated options."""

    def __init__(self, **named):
        super().__init__(allow_abbrev=False, **named)
        self.add_argument("--json", action="store_true", help="print the result as JSON on standard output")
        self.add_argument("-q", "--quiet", action="store_true", help="print only results and errors")
        self.add_argument("-v", "--verbose", action="store_true", help="print more details")

    def error(self, message):
        raise UsageError(f"{message}; see --help")

    def print_help(self, file=None):
        if file is None:
            print_result(self.format_help().rstrip("\n"))
        else:
            super().print_help(file)


def printable(text):
    """A text whose lines hold no control characters."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape", "backslashreplace").decode() for c in text)


def _is_terminal(stream):
    return stream is not None and stream.isatty()  # Python has None for a stream that is closed


def _discard(stream):
    """Leads a stream that takes no more to /dev/null, or the interpreter would fail when it writes the rest at its end."""
    with contextlib.suppress(OSError, ValueError), open(os.devnull, "wb") as nothing:
        os.dup2(nothing.fileno(), stream.fileno())


def print_result(text):
    """Prints a line on standard output. Raises Error (code 6) if it is closed or full; if its reader left, as head(1) does, the
    line is dropped."""
    try:
        if sys.stdout is None:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        sys.stdout.buffer.write(text.encode("utf-8", "surrogateescape") + b"\n")
        sys.stdout.buffer.flush()
    except BrokenPipeError:
        _discard(sys.stdout)
    except OSError as error:
        if sys.stdout is not None:
            _discard(sys.stdout)
        raise make_error(f"writing to standard output: {error.strerror}", 6) from None


def _print_message(text, end="\n"):
    """Prints on standard error. A closed or full one must not end the work."""
    if sys.stderr is None:
        return
    try:
        print(text, end=end, file=sys.stderr, flush=True)
    except BlockingIOError:
        pass  # a full pipe may take the next message
    except (OSError, ValueError):
        _discard(sys.stderr)


class Console:
    """Results on standard output, and all else on standard error."""

    def __init__(self, is_json=False, is_quiet=False, is_verbose=False):
        self.is_json = is_json
        self.is_quiet = is_quiet
        self._is_verbose = is_verbose
        self.draws_bar = _is_terminal(sys.stderr)
        self._uses_color = self.draws_bar and not os.environ.get("NO_COLOR")

    def _say(self, label, color, text):
        shown = f"\x1b[{color}m{label}\x1b[0m" if label and self._uses_color else label
        _print_message(f"corda: {shown}{printable(text)}")

    def info(self, text):
        if not self.is_quiet:
            self._say("", "", text)

    def detail(self, text):
        if self._is_verbose:
            self.info(text)

    def warning(self, text):
        if not self.is_quiet:
            self._say("warning: ", "33", text)

    def error(self, text):
        self._say("error: ", "31", text)

    def result(self, text):
        if not self.is_json:
            print_result(printable(text) if _is_terminal(sys.stdout) else text)

    def report(self, value):
        if self.is_json:
            print_result(json.dumps(value, indent=2, sort_keys=True, ensure_ascii=_is_terminal(sys.stdout)))


def _duration_text(seconds):
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    return f"{whole // 60} min {whole % 60:02} s" if whole < 3600 else f"{whole // 3600} h {whole // 60 % 60:02} min"


class Progress:
    """A bar with the time left on a terminal, else a line every few seconds. Called with finished and all things."""

    def __init__(self, console, what):
        self._console = console
        self._what = what
        self._start = self._last = time.monotonic()
        self._next_line = self._start + _SECONDS_BEFORE_LINES
        self._next_percent = 0
        self._first_done = None
        self._is_drawn = False

    def __call__(self, done, total):
        if self._console.is_quiet or total == 0:
            return
        now = time.monotonic()
        if self._first_done is None and done > 0:
            self._first_done, self._start = done, now
        percent = 100 * done // total
        if self._console.draws_bar:
            if now - self._last >= _SECONDS_BETWEEN_BARS or done == total:
                cells = _BAR_CELLS * done // total
                _print_message(f"\r\x1b[K{self._what} [{'#' * cells}{'.' * (_BAR_CELLS - cells)}] {percent:3} % "
                               f"{done}/{total}, {self._time_left(done, total, now)}", end="")
                self._last, self._is_drawn = now, True
        elif percent >= self._next_percent and now >= self._next_line:
            self._next_line, self._next_percent = now + _SECONDS_BETWEEN_LINES, percent // 10 * 10 + 10
            self._console.info(f"{self._what} {percent // 10 * 10} % ({done} of {total}), {self._time_left(done, total, now)}")

    def _time_left(self, done, total, now):
        since = done - (self._first_done or 0)
        if since <= 0 and done < total:
            return "starting"
        return _duration_text((now - self._start) * (total - done) / max(1, since)) + " left"

    def end(self):
        if self._is_drawn:
            _print_message("\r\x1b[K", end="")
            self._is_drawn = False


class Terminated(KeyboardInterrupt):
    """SIGTERM, which ends the work as Ctrl-C does."""


def _terminate(*_):
    raise Terminated


def counted(count, what):
    return f"{count} {what}" + ("" if count == 1 else "s")


def run(argv, parser, action):
    """Runs action(console, options), and turns exceptions into exit codes: see src/corda/app/README.md. The first Ctrl-C ends the
    work in order, and a second one at once."""
    console = Console("--json" in argv, "-q" in argv or "--quiet" in argv)
    handlers = {signal.SIGTERM: _terminate, signal.SIGINT: signal.default_int_handler}  # also in the background of a script
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    try:
        options = parser.parse_args(argv)
        console = Console(options.json, options.quiet, options.verbose)
        return action(console, options)
    except SystemExit as error:  # --help
        return error.code or 0
    except UsageError as error:
        return fail(console, 2, str(error))
    except Error as error:
        return fail(console, error.code, str(error))
    except KeyboardInterrupt as error:
        return fail(console, 143 if isinstance(error, Terminated) else 130, str(error) or "interrupted")
    except MemoryError:
        return fail(console, 75, "out of memory; a smaller scene or picture, or fewer jobs, may help")
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def fail(console, code, message):
    """Reports an error; returns its exit code."""
    console.error(message)
    try:
        console.report({"schema": 1, "error": {"code": code, "message": printable(message)}})
    except Error:
        pass  # standard output takes no more; the exit code still tells
    return code
