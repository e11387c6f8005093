#!/usr/bin/env python3
"""Runs the program on random scenes that follow its own JSON Schema.

Every run has limits of address space and of the CPU's time, which a busy machine does not change. It must end with a
documented exit code, never by a signal, an internal error or a timeout: after TIME_S the run gets SIGTERM, which it must
answer within ANSWER_S. Scene i is a function of i alone, so that a failure can be repeated.

Usage: random_scenes.py CORDA [--first I] [--count N] [--keep FOLDER]
N is 200, or 10 000 with CORDA_TEST_LONG=1.
"""

import argparse
import concurrent.futures
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time

MEMORY_BYTES = 2 << 30
TIME_S = 10.0 if os.environ.get("CORDA_TEST_LONG") else 1.5
ANSWER_S = 5.0
HANGS_S = 300.0  # of the clock: a run that waits for something uses no time of the CPU
ALLOWED = {0: "ok", 2: "usage", 3: "invalid scene", 5: "encoder", 8: "diverged", 75: "temporary", 143: "stopped by SIGTERM"}
MAX_PARTICLES = 60
# The keys of [solver] that a method uses, which the schema does not contain. One scene in ten ignores this.
METHOD_KEYS = {"auto": {"tolerance_px"}, "exact": {"tolerance", "implicit"}, "rattle": {"order", "step"},
               "relaxation": {"step", "reach", "sweeps", "delta", "force"}}


class Generator:
    """Random values of one scene: each is legal by itself as the schema describes it."""

    def __init__(self, schema, seed):
        self.schema = schema
        self.random = random.Random(seed)

    def scene(self):
        table = {"schema": 1}
        properties = self.schema["properties"]
        for name in ("world", "solver", "video", "style", "overlay", "camera"):
            if self.random.random() < 0.7:
                table[name] = self.value(properties[name])
        for name, share in (("rope", 0.8), ("net", 0.3)):
            if self.random.random() < share:
                item = properties[name]["items"]
                table[name] = [self.body(name, item) for _ in range(self.random.choice((1, 1, 1, 2, 3)))]
        if "rope" not in table and "net" not in table:
            table["rope"] = [self.body("rope", properties["rope"]["items"])]
        solver = table.get("solver", {})
        solver.pop("bodies", None)  # names every body and its method: `corda plan --toml` writes it
        if self.random.random() < 0.9:
            self.fit_keys(table)
        self.limit_work(table)
        return table

    def fit_keys(self, table):
        """Removes keys that other keys of the scene exclude."""
        solver = table.get("solver", {})
        used = METHOD_KEYS[solver.get("method", "auto")] | {"method"}
        table["solver"] = {key: value for key, value in solver.items() if key in used}
        self.fit_pictures(table)
        by_link = table.get("style", {}).get("color_by") == "link"
        for body in table.get("rope", []) + table.get("net", []):
            if isinstance(body.get("color"), list) and not by_link:
                body["color"] = "teal"
            if "points" not in body:
                body.pop("closed", None)
            if not body.get("compliance"):
                body.pop("link_length", None)
                if "grid" in body or "bars" in body or body.get("closed"):
                    body.pop("string", None)

    def fit_pictures(self, table):
        """The same of tables that change pictures alone."""
        style, overlay, camera, video = (table.get(name, {}) for name in ("style", "overlay", "camera", "video"))
        plots = overlay.get("plots", [])
        ranges = overlay.get("plot_range", {})
        has_balls = any(body.get("payload") for body in table.get("rope", [])) and style.get("payload", True)
        for its, key, is_used in ((style, "color_range", style.get("color_by") in ("tension", "speed", "strain")),
                                  (style, "arrow_scale", style.get("arrows", "none") != "none"),
                                  (style, "trail_of", style.get("trail_s", 0) > 0), (style, "payload_radius", has_balls),
                                  (overlay, "energy_zero", "energy" in plots), (overlay, "font", False),
                                  (camera, "follow", "path" not in camera), (video, "loop", False)):
            if not is_used:
                its.pop(key, None)
        if plots:
            overlay["plots"] = sorted(set(plots))
        for name in [name for name in ranges if name not in plots]:
            del ranges[name]
        for its, key in [(style, "color_range"), *((ranges, name) for name in ranges)]:
            if key in its:
                its[key] = [min(its[key]), max(its[key]) + 1.0]
        if "speed" in video:
            video["speed"] = self.random.choice((0.25, 2, "1/3"))

    def limit_work(self, table):
        """Limits the time and disk space of random values. Extreme ones remain: a signal ends them."""
        if self.random.random() < 0.9:
            table.setdefault("world", {})["duration"] = self.random.choice((0.02, 0.1, 0.5))
        video = table.setdefault("video", {})
        if self.random.random() < 0.9:
            video["size"] = self.random.choice(([160, 90], [64, 64], [320, 200], [98, 2]))
            video["fps"] = self.random.choice((30, 60, "30000/1001"))

    def value(self, node):
        """A value of the schema's node; tables have each key that is not required with a chance of 0.3."""
        for key in ("anyOf", "oneOf"):
            if key in node and "type" not in node:
                return self.value(self.random.choice(node[key]))
        if "enum" in node:
            return self.random.choice(node["enum"])
        kind = node["type"]
        if kind == "boolean":
            return self.random.random() < 0.5
        if kind in ("number", "integer"):
            return self.number(node, kind == "integer")
        if kind == "string":
            return self.text(node)
        if kind == "array":
            least = node.get("minItems", 0)
            count = self.random.randint(least, min(node.get("maxItems", least + 3), least + 3))
            return [self.value(node["items"]) for _ in range(count)]
        required = node.get("required", [])
        return {k: self.value(v) for k, v in node["properties"].items() if k in required or self.random.random() < 0.3}

    def number(self, node, whole):
        """Mostly ordinary values, sometimes values at or near a limit of the schema, large or tiny ones."""
        least = node.get("minimum", node.get("exclusiveMinimum", -1e9))
        most = node.get("maximum", node.get("exclusiveMaximum", 1e9))
        choice = self.random.random()
        if choice < 0.75:
            value = self.random.choice((node.get("default", 1), self.random.uniform(0, 10), self.random.uniform(-3, 3)))
        elif choice < 0.9:
            value = self.random.choice((-1, 1)) * 10.0 ** self.random.uniform(-12, 12)
        else:
            value = self.random.choice((least, most))
        value = min(max(value, least), most)
        if value == node.get("exclusiveMinimum"):
            value += 0.01
        if value == node.get("exclusiveMaximum"):
            value -= 0.01
        return round(value) if whole else float(value)

    def text(self, node):
        if "fps" in node.get("pattern", "") or node.get("pattern", "").startswith("^[0-9]"):
            return self.random.choice(("24000/1001", "25", "120"))
        if "pattern" in node:
            return self.random.choice(("#102030", "#ffffff80", "teal", "black"))
        return self.random.choice(("", "A title", "Two words, and a third\nline", "x" * 300, "\u00fc \u03b1"))

    def body(self, name, node):
        shape = self.random.choice([choice["required"][0] for choice in node["oneOf"]])
        shapes = {choice["required"][0] for choice in node["oneOf"]}
        keys = {k: v for k, v in node["properties"].items() if k not in shapes | {"origin", "bars"}}
        body = self.value({"type": "object", "properties": keys})
        body[shape], particles, links = self.shape(shape)
        if name == "net" and shape == "points":
            body["bars"] = [[i, i + 1] for i in range(particles - 1)]
        self.fit_lists(body, particles, links)
        return body

    def shape(self, shape):
        """A shape with its numbers of particles and links."""
        count = self.random.choice((2, 3, 5, self.random.randint(2, MAX_PARTICLES)))
        size = self.random.choice((1.0, 1.0, 1.0, 1e-6, 1e6))
        if shape == "line":
            return {"particles": count, "from": self.point(5), "step": self.point(size)}, count, count - 1
        if shape == "hang":
            angle = self.random.choice((0.0, 45.0, 90.0, 180.0, self.random.uniform(-360, 360)))
            return {"links": count, "length": size, "angle_deg": angle}, count + 1, count
        if shape == "grid":
            columns, rows = self.random.randint(1, 8), self.random.randint(2, 8)
            links = columns * (rows - 1) + rows * (columns - 1) + 2 * (columns - 1) * (rows - 1)
            return {"columns": columns, "rows": rows, "spacing": size}, columns * rows, links
        return [self.point(size) for _ in range(count)], count, count - 1

    def point(self, size):
        return [self.random.uniform(-size, size), self.random.uniform(-size, size)]

    def fit_lists(self, body, particles, links):
        """Adapts the lengths of lists and the range of indices to the body."""
        for key, count in (("mass", particles), ("velocity", particles), ("link_length", links), ("color", links)):
            value = body.get(key)
            is_pair = key == "velocity" and value and not isinstance(value[0], list)
            if isinstance(value, list) and not is_pair:
                body[key] = [self.random.choice(value) for _ in range(count)] if value else value
                if not value:
                    del body[key]
        if "pinned" in body:
            body["pinned"] = sorted({self.random.randrange(particles) for _ in range(self.random.choice((0, 1, 1, 2)))})
        if "moves" in body:
            pins = body.setdefault("pinned", [0])
            body["moves"] = [self.fit_move(pin, move) for pin, move in zip(pins, body["moves"])]
            if not body["moves"]:
                del body["moves"]
        if "release" in body:
            pins = body.setdefault("pinned", [0])
            body["release"] = [release | {"pin": pin} for pin, release in zip(pins, body["release"])]
        if "cut" in body:
            cuts = body["cut"][:1] if body.get("closed") else body["cut"]
            most = (links + 1) // 2 if "grid" in body else links  # more than half of a grid's bars are no diagonals
            body["cut"] = [cut | {"link": link} for link, cut in zip(self.random.sample(range(most), min(len(cuts), most)), cuts)]
        for key in ("release", "cut"):
            if body.get(key) == []:
                del body[key]
            for event in body.get(key, []):
                event["t"] = self.random.choice((0.0, event["t"], self.random.uniform(0.0, 1.0)))

    def fit_move(self, pin, move):
        """Adapts a move to its pin, and a path's start and order."""
        path = [{"t": 0.0, "by": [0.0, 0.0]}, *sorted(move.get("path", []), key=lambda key: key["t"])]
        path = [key for i, key in enumerate(path) if i == 0 or key["t"] > path[i - 1]["t"]]
        return move | {"pin": pin, "path": path}


def to_toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {to_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(to_toml(item) for item in value) + "]"
    return json.dumps(value)  # JSON and TOML write numbers, texts and booleans alike


def command_of(index, corda, scene, folder):
    return (
        [corda, "plan", scene, "--json"],
        [corda, "simulate", scene, "-o", os.path.join(folder, "out.csv"), "--force", "-q"],
        [corda, "still", scene, "--at", "0.01", "-o", os.path.join(folder, "out.png"), "--force", "-q"],
        [corda, "render", scene, "-o", os.path.join(folder, "out.mp4"), "--force", "-q", "--jobs", "1"],
    )[index % 4]


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def used_s(process):
    """The CPU's time that a process has used, in s."""
    try:
        with open(f"/proc/{process.pid}/stat", encoding="utf-8", errors="replace") as file:
            ticks = file.read().rpartition(")")[2].split()[11:13]
    except OSError:
        return 0.0  # it has ended
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def ends_within(process, limit_s):
    """Waits for a process until it has used more time of the CPU."""
    latest = time.monotonic() + HANGS_S
    while used_s(process) < limit_s and time.monotonic() < latest:
        try:
            process.wait(0.02)
            return True
        except subprocess.TimeoutExpired:
            pass
    return process.poll() is not None


def run(command):
    """Returns the exit status and the text on stderr; the status is "hangs" if SIGTERM is not answered."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, preexec_fn=limit_memory)
    with process.stderr:
        if ends_within(process, TIME_S):
            return process.returncode, process.stderr.read()
        process.send_signal(signal.SIGTERM)
        if ends_within(process, used_s(process) + ANSWER_S):
            return process.returncode, process.stderr.read()
        process.kill()
        process.wait()
        return "hangs", process.stderr.read()


def check(index, corda, schema, keep):
    """Runs scene `index`; returns its status and a description of the failure, or None."""
    text = "".join(f"{key} = {to_toml(value)}\n" for key, value in Generator(schema, index).scene().items())
    with tempfile.TemporaryDirectory() as folder:
        scene = os.path.join(folder, "scene.toml")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(text)
        command = command_of(index, corda, scene, folder)
        start = time.monotonic()
        status, words = run(command)
        took_s = time.monotonic() - start
    if status in ALLOWED:
        return status, None
    if keep:
        with open(os.path.join(keep, f"{index}.toml"), "w", encoding="utf-8") as file:
            file.write(text)
    return status, f"scene {index}, {command[1]}: status {status} after {took_s:.1f} s: {words.decode(errors='replace')[-300:]}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("corda")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=10_000 if os.environ.get("CORDA_TEST_LONG") else 200)
    parser.add_argument("--keep", help="folder for scenes that fail")
    arguments = parser.parse_args()
    schema = json.loads(subprocess.run([arguments.corda, "schema"], check=True, capture_output=True).stdout)
    counts = {}
    failures = []
    indices = range(arguments.first, arguments.first + arguments.count)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for status, failure in pool.map(lambda i: check(i, arguments.corda, schema, arguments.keep), indices):
            counts[status] = counts.get(status, 0) + 1
            if failure:
                failures.append(failure)
    print(", ".join(f"{ALLOWED.get(status, status)}: {count}" for status, count in sorted(counts.items(), key=str)))
    # If nearly all scenes were invalid, only the reader would be tested.
    ran = counts.get(0, 0) + counts.get(143, 0)
    if ran < 0.2 * arguments.count:
        failures.append(f"only {ran} of {arguments.count} scenes ran")
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
