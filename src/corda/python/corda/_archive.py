"""Files of sweeps and reports: arrays as .npz, samples as .tar, tables as .csv, and files that get their names when they are
complete."""

import contextlib
import csv
import hashlib
import io
import math
import os
import secrets
import stat
import tarfile
import zipfile

import numpy as np

from ._arguments import make_error

_DATE = (1980, 1, 1, 0, 0, 0)  # the first that a .zip can hold
_MAX_FILE_BYTES = 1 << 30


def io_error(action, path, error):
    """The Error (code 6) of an OSError."""
    return make_error(f"cannot {action} '{path}': {error.strerror or error}", 6)


def npz_bytes(arrays):
    """Arrays by name as a file for numpy.load. The same arrays give the same bytes; those of bytes are compressed."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            data = io.BytesIO()
            np.lib.format.write_array(data, np.ascontiguousarray(array), version=(1, 0), allow_pickle=False)
            entry = zipfile.ZipInfo(name + ".npy", _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED if array.dtype == np.uint8 else zipfile.ZIP_STORED
            archive.writestr(entry, data.getbuffer())
    return file.getvalue()


def _csv_cell(cell):
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    return f"{cell:.17g}" if isinstance(cell, float) else cell


def csv_text(head, rows):
    """Rows of cells as CSV (RFC 4180, but with LF): numbers have 17 significant digits, so that reading them gives the same bits;
    unknown ones are empty."""
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(map(_csv_cell, row) for row in rows)
    return table.getvalue()


def plain_size(path):
    """The bytes of an ordinary file of that name; None if there is none, or a link to one."""
    try:
        status = os.lstat(path)
    except OSError:
        return None
    return status.st_size if stat.S_ISREG(status.st_mode) else None


def refuse_unusual(path):
    if os.path.lexists(path) and plain_size(path) is None:
        raise make_error(f"'{path}' is no ordinary file; move it away, or choose another folder", 6)


def read_plain(path):
    """The bytes of an ordinary file of at most 1 GiB; None if there is none."""
    try:
        size = plain_size(path)
        if size is None or size > _MAX_FILE_BYTES:
            return None
        with open(path, "rb") as file:
            return file.read()
    except OSError as error:
        raise io_error("read", path, error) from None


def sha256_of(path):
    total = hashlib.sha256()
    try:
        with open(path, "rb") as file:
            while block := file.read(1 << 20):
                total.update(block)
    except OSError as error:
        raise io_error("read", path, error) from None
    return total.hexdigest()


class OutputFile:
    """A file under a temporary name beside its own, NAME.XXXXXXXX.tmp, which commit() replaces; a context manager that removes a
    file without commit. Counts its bytes in `size`, and sums them in `sha256`. Raises Error (code 6)."""

    def __init__(self, path):
        refuse_unusual(path)
        self.path = path
        self.temporary = f"{path}.{secrets.token_hex(4)}.tmp"
        self.size = 0
        self.sha256 = hashlib.sha256()
        self._file = None

    def __enter__(self):
        """Opens the file here, since a signal may come between a constructor and `with`."""
        try:
            self._file = open(self.temporary, "xb")
        except OSError as error:
            raise io_error("write", self.path, error) from None
        except KeyboardInterrupt:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        with contextlib.suppress(OSError):
            if self._file:
                self._file.close()
        with contextlib.suppress(OSError):
            os.unlink(self.temporary)

    def write(self, data):
        try:
            self._file.write(data)
        except OSError as error:
            raise io_error("write", self.path, error) from None
        self.size += len(data)
        self.sha256.update(data)
        return len(data)

    def tell(self):
        return self.size

    def flush(self):
        """Flushes all bytes so far to the disk."""
        try:
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise io_error("write", self.path, error) from None

    def commit(self):
        self.flush()
        try:
            self._file.close()
            os.replace(self.temporary, self.path)
        except OSError as error:
            raise io_error("write", self.path, error) from None


def save_file(path, data):
    """Writes or replaces an ordinary file; refuses links, pipes and devices."""
    with OutputFile(path) as file:
        file.write(data)
        file.commit()


class TarWriter:
    """Adds files of user 0, mode 0644 and time 0 to a POSIX ustar archive, so that the same files give the same bytes."""

    def __init__(self, output):
        self._tar = tarfile.open(fileobj=output, mode="w", format=tarfile.USTAR_FORMAT)

    def add(self, name, data):
        entry = tarfile.TarInfo(name)
        entry.size = len(data)
        self._tar.addfile(entry, io.BytesIO(data))

    def finish(self):
        self._tar.close()
