"""The folder of a sweep: shard files with their indices, metadata.csv and manifest.json. Section "Files" of
src/corda/python/README.md describes them. They may be of any origin. Functions raise Error: code 6 for files that cannot be read or
written, 2 for those of another sweep."""

import contextlib
import json
import os
import re

from ._arguments import make_error
from ._archive import OutputFile, TarWriter, csv_text, io_error, npz_bytes, plain_size, read_plain, save_file
from ._corda import __version__
from ._parameters import hash_text, identity_of
from ._sweep_file import is_number, value_text

_MANIFEST = "manifest.json"
_METADATA = "metadata.csv"
_MAX_NAMED = 20
_MAX_SHOWN = 64


def shard_count(sweep):
    return (sweep.samples - 1) // sweep.shard_samples + 1


def samples_of(sweep, shard):
    """The numbers of the samples of a shard file, a range."""
    first = shard * sweep.shard_samples
    return range(first, min(first + sweep.shard_samples, sweep.samples))


def shard_path(folder, shard):
    return os.path.join(folder, f"shard-{shard:06}.tar")


def index_path(folder, shard):
    return os.path.join(folder, f"shard-{shard:06}.json")


def metadata_path(folder):
    return os.path.join(folder, _METADATA)


def manifest_path(folder):
    return os.path.join(folder, _MANIFEST)


def _shard_of(name):
    """The number of a shard file or an index; None for another name."""
    match = re.fullmatch(r"shard-(\d{6}|[1-9]\d{6,18})\.(tar|json)", name, re.ASCII)
    return int(match[1]) if match else None


def _sweep_files(folder):
    try:
        names = os.listdir(folder)
    except FileNotFoundError:
        return []
    except OSError as error:
        raise io_error("read", folder, error) from None
    return sorted(name for name in names if name in (_MANIFEST, _METADATA) or _shard_of(name) is not None)


def _read_json(path):
    """The object in a file; None if there is none."""
    data = read_plain(path)
    try:
        value = json.loads(data) if data else None
    except (ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None


def json_text(value):
    return json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def _dense_text(value):
    return json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))


def _checksum_of(index):
    try:
        return hash_text(_dense_text({key: value for key, value in index.items() if key != "checksum"}))
    except (ValueError, RecursionError):
        return None


def _empty_manifest(sweep):
    return {"schema": 1, "corda": __version__, "made_from": identity_of(sweep), "complete": False}


def _origin_of(value):
    """The member "made_from" of a file; None if it has none."""
    origin = value.get("made_from") if value else None
    is_sound = isinstance(origin, dict) and all(isinstance(text, str) for text in origin.values())
    return origin if is_sound else None


def _require_same(sweep, origin, path):
    """Refuses what another sweep has made, naming the differences."""
    identity = identity_of(sweep)
    changes = []
    for key in [*sorted(identity), *sorted(set(origin) - set(identity))]:
        now, before = (values.get(key, "not given") for values in (identity, origin))
        if now != before:
            is_long = max(len(now), len(before)) > _MAX_SHOWN
            changes.append(f"{key} has other values" if is_long else f"{key} is {now} and was {before}")
    if changes:
        more = f", and {len(changes) - _MAX_NAMED} more" if len(changes) > _MAX_NAMED else ""
        raise make_error(f"'{path}' is of another sweep: {', '.join(changes[:_MAX_NAMED])}{more}; choose another folder, move it "
                         "away, or replace all shards (--force)")


def _fail_larger(path):
    raise make_error(f"'{path}' is of a sweep of more samples; move it away, or replace all shards (--force)")


def _manifest_origin(folder):
    """The origin in the manifest; None if there is no manifest."""
    path = manifest_path(folder)
    if not os.path.lexists(path):
        return None
    origin = _origin_of(_read_json(path))
    if origin is None:
        raise make_error(f"'{path}' is no manifest of a sweep; move it away, or choose another folder", 6)
    return origin


def open_folder(sweep, folder, force):
    """Makes the folder and its manifest. Raises Error: code 2 if it has another sweep, or one of more samples, and 6 if it has
    files of a sweep's names and no manifest. With `force`, another sweep is accepted, and stays until clear_folder()."""
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise io_error("make the folder", folder, error) from None
    files = _sweep_files(folder)  # first: another process makes the manifest before any other file
    origin = _manifest_origin(folder)
    has_manifest = origin is not None
    for name in files:
        if origin is None and name.endswith(".json"):
            origin = _origin_of(_read_json(os.path.join(folder, name)))
    if origin is None and files:
        raise make_error(f"'{os.path.join(folder, files[0])}' is there, and no manifest of a sweep; move it away, or choose "
                         "another folder", 6)
    if not has_manifest:
        with OutputFile(manifest_path(folder)) as file:
            file.write(json_text(_empty_manifest(sweep)).encode())
            file.flush()
            try:
                os.link(file.temporary, manifest_path(folder))  # unlike a rename, never replaces that of another process
            except OSError:
                origin = _manifest_origin(folder)
                if origin is None:
                    file.commit()  # a file system without links
    if not force:
        if origin is not None:
            _require_same(sweep, origin, manifest_path(folder))
        refuse_surplus_shards(sweep, folder)


def clear_folder(sweep, folder):
    """Removes the files of any sweep, and makes a new manifest."""
    for name in _sweep_files(folder):
        if name != _MANIFEST:
            with contextlib.suppress(OSError):
                os.unlink(os.path.join(folder, name))
    save_file(manifest_path(folder), json_text(_empty_manifest(sweep)).encode())


def mark_incomplete(sweep, folder):
    """Clears `complete` in the manifest."""
    manifest = _read_json(manifest_path(folder))
    if manifest is None or manifest.get("complete") is not False:
        save_file(manifest_path(folder), json_text(_empty_manifest(sweep)).encode())


def refuse_surplus_shards(sweep, folder):
    for name in _sweep_files(folder):
        if (_shard_of(name) or 0) >= shard_count(sweep):
            _fail_larger(os.path.join(folder, name))


def _is_sound_row(row):
    if not isinstance(row, dict) or not all(isinstance(row.get(name), str) for name in ("key", "split")):
        return False
    if not all(isinstance(row.get(name, {}), dict) for name in ("parameters", "summary")):
        return False
    failure = row.get("failure", {"code": 3, "message": ""})
    return isinstance(failure, dict) and isinstance(failure.get("code"), int) and isinstance(failure.get("message"), str)


def find_index(sweep, folder, shard):
    """The index of a shard file: its size, its checksum and the rows of its samples. It is written after the shard, so a shard
    with an index is finished. None if there is no sound one for these samples with a shard file of its size. Raises Error (code 2)
    if it is of another sweep, or of one of more samples."""
    index = _read_json(index_path(folder, shard))
    checksum = _checksum_of(index) if index else None
    if checksum is None or index.get("checksum") != checksum:
        return None
    origin, rows, path = _origin_of(index), index.get("rows"), shard_path(folder, shard)
    if origin is None or not isinstance(rows, list):
        return None
    _require_same(sweep, origin, path)
    samples = samples_of(sweep, shard)
    if len(rows) > len(samples):
        _fail_larger(path)
    if len(rows) != len(samples) or not all(map(_is_sound_row, rows)) or not isinstance(index.get("sha256"), str):
        return None
    size = plain_size(path)
    return index if size is not None and size == index.get("bytes") else None


def pack(sample):
    """The row of a sample in its index, and its files in the order of the tar: pairs of name and bytes."""
    row = {"key": sample.key, "split": sample.split, "parameters": sample.parameters}
    if sample.failure:
        code, message = sample.failure
        row["failure"] = {"code": code, "message": message.encode("utf-8", "replace").decode()}
        return row, []
    row["summary"] = sample.info["summary"]
    files = [(sample.key + extension, data) for extension, data in sample.pictures.items()]
    files.append((sample.key + ".json", json_text(sample.info).encode()))
    files.append((sample.key + ".npz", npz_bytes(sample.arrays)))
    return row, files


def write_shard(sweep, folder, shard, packed):
    """Writes a shard file of the samples in `packed`, an iterable of what pack() returns, and then its index."""
    index = {"schema": 1, "made_from": identity_of(sweep), "rows": []}
    with OutputFile(shard_path(folder, shard)) as file:
        tar = TarWriter(file)
        for row, files in packed:
            index["rows"].append(row)
            for name, data in files:
                tar.add(name, data)
        tar.finish()
        file.commit()
    index["bytes"] = file.size
    index["sha256"] = file.sha256.hexdigest()
    index["checksum"] = _checksum_of(index)
    save_file(index_path(folder, shard), (_dense_text(index) + "\n").encode())


def _csv_row(sweep, shard, row):
    parameters, summary = row.get("parameters", {}), row.get("summary", {})
    cells = [row["key"], os.path.basename(shard_path("", shard)), row["split"]]
    cells += [value_text(parameters[key]) if key in parameters else "" for key in sweep.vary]
    cells += [value_text(summary[name]) if is_number(summary.get(name)) else "" for name in sweep.summary]
    return [*cells, row["failure"]["message"] if "failure" in row else ""]


def summary_of(sweep, folder):
    """The contents of metadata.csv and manifest.json as text; None if a shard is not finished."""
    table = []
    shards, failures, splits = [], [], {}
    for shard in range(shard_count(sweep)):
        index = find_index(sweep, folder, shard)
        if index is None:
            return None
        for row in index["rows"]:
            table.append(_csv_row(sweep, shard, row))
            if "failure" in row:
                failures.append({"key": row["key"], "failure": row["failure"]})
            elif sweep.splits:
                splits[row["split"]] = splits.get(row["split"], 0) + 1
        failed = sum("failure" in row for row in index["rows"])
        shards.append({"file": os.path.basename(shard_path("", shard)), "bytes": index["bytes"], "sha256": index["sha256"],
                       "samples": len(index["rows"]) - failed, "failed": failed})
    manifest = _empty_manifest(sweep) | {"complete": True, "samples": sweep.samples - len(failures), "failed": len(failures),
                                         "splits": splits, "shards": shards, "failures": failures}
    head = ["key", "shard", "split", *sweep.vary, *sweep.summary, "failure"]
    return csv_text(head, table), manifest


def rows_of(sweep, folder):
    """The rows of all finished shards, in order, each with the number of its sample."""
    for shard in range(shard_count(sweep)):
        index = find_index(sweep, folder, shard)
        if index is not None:
            yield from zip(samples_of(sweep, shard), index["rows"])
