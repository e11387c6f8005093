"""`python3 -m corda sweep` and `python3 -m corda report`."""

import importlib
import sys

from . import _console, __version__

_COMMANDS = {"sweep": "make many samples of a scene as a labelled data set",
             "report": "draw the figures that a paper shows of a scene"}


def _main(argv):
    if argv and argv[0] in _COMMANDS:
        return importlib.import_module(f".{argv[0]}", __package__).main(argv[1:])
    console = _console.Console("--json" in argv)
    if argv == ["--version"]:
        print(f"corda {__version__}")
        return 0
    if argv and argv[0] in ("-h", "--help"):
        lines = [f"  {name}  {what}" for name, what in _COMMANDS.items()]
        print("\n".join(["usage: python3 -m corda COMMAND ...", "", *lines, "", "Each has --help."]))
        return 0
    console.error(f"there is no command {argv[0]!r} of Python; give sweep or report" if argv else "give a command: sweep or report")
    return 2


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
