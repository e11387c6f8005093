"""`python3 -m corda sweep` and `python3 -m corda report`."""

import importlib
import sys

from . import Error, _console, _corda, __version__

_COMMANDS = {"sweep": "make many samples of a scene as a labelled data set",
             "report": "draw the figures that a paper shows of a scene"}


def _main(argv):
    at = next((k for k, word in enumerate(argv) if not word.startswith("-")), None)
    command = None if at is None else argv[at]
    if command in _COMMANDS:
        _corda.keep_memory()
        return importlib.import_module(f".{command}", __package__).main(argv[:at] + argv[at + 1:])
    console = _console.Console("--json" in argv)
    try:
        if command is None and "--version" in argv:
            _console.print_result(f"corda {__version__}")
            return 0
        if command is None and ("-h" in argv or "--help" in argv):
            lines = [f"  {name}  {what}" for name, what in _COMMANDS.items()]
            _console.print_result("\n".join(["usage: python3 -m corda COMMAND ...", "", *lines, "", "Each has --help."]))
            return 0
    except Error as error:
        return _console.fail(console, error.code, str(error))
    return _console.fail(console, 2, "give a command: sweep or report" if command is None else
                         f"there is no command {command!r} of Python; give sweep or report")


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
