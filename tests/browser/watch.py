#!/usr/bin/env python3
"""Edits scenes under `corda watch` and looks at its page in headless Chromium.

Usage: watch.py CORDA [--saves N] [--figures FOLDER]
--saves: how often the scene is saved in a row (default 30).
--figures: where to keep pictures of the page.
"""

import argparse
import filecmp
import http.client
import http.server
import json
import os
import re
import select
import signal
import socket
import socketserver
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
import zlib

from chromium import Chromium

SCENE = """# A comment that stays.
schema = 1
[world]
duration = 4.0
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 80.0 }  # degrees
[video]
fps = 30
size = [1280, 720]
"""


class Watching:
    """The program and a page that shows it."""

    def __init__(self, corda, browser, scene):
        self.corda, self.scene, self.browser = corda, scene, browser
        self.start(0)
        browser.open(self.address)
        browser.wait("document.readyState === 'complete' && typeof film === 'object' && film !== null && drawn >= 0")

    def start(self, port):
        self.program = subprocess.Popen([self.corda, "watch", self.scene, "--host", "hub.localhost", "--port", str(port), "-q"],
                                        stdout=subprocess.PIPE, text=True, env={**os.environ, "XDG_RUNTIME_DIR": os.path.dirname(self.scene)})
        self.address = self.program.stdout.readline().strip()

    def save(self, text):
        """Saves the scene as an editor does, by another file in its place."""
        with open(self.scene + "~", "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(self.scene + "~", self.scene)

    def film(self):
        return self.browser.run("film.number")

    def end(self):
        self.program.send_signal(signal.SIGINT)
        return self.program.wait(timeout=20)


def pixels_of(browser):
    """CRC-32 of the RGBA pixels on the canvas."""
    return browser.run("""(() => {
        const bytes = pen.getImageData(0, 0, canvas.width, canvas.height).data;
        let crc = -1;
        for (const byte of bytes) {
            crc ^= byte;
            for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (0xEDB88320 & -(crc & 1));
        }
        return [canvas.width, canvas.height, (crc ^ -1) >>> 0];
    })()""")


def still_of(corda, scene, folder, frame, size):
    """The same of the picture that `still` writes."""
    path = os.path.join(folder, f"{frame}.y4m")
    picture = os.path.join(folder, "still.png")
    subprocess.run([corda, "still", scene, "--frame", str(frame), "--size", size, "-o", picture, "--force", "-q"],
                   check=True, stdout=subprocess.DEVNULL)
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", picture, "-f", "rawvideo", "-pix_fmt", "rgba", "-"], check=True,
                         stdout=subprocess.PIPE).stdout
    width, height = map(int, size.split("x"))
    assert len(raw) == 4 * width * height, path
    return [width, height, zlib.crc32(raw)]


def check(condition, message):
    if not condition:
        sys.exit("watch.py: " + message)


def resident_kib(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


def processor_ms(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        ticks = file.read().rsplit(")", 1)[1].split()[11:13]
    return 1000 * sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def check_scrubbing(watching, corda, folder):
    browser = watching.browser
    choose_size(browser, 16384, 1280)
    for frame in (0, 7, 119, 60):
        browser.run(f"timeline.value = {frame}, timeline.dispatchEvent(new Event('input'))")
        browser.wait(f"drawn === {frame}")
        check(pixels_of(browser) == still_of(corda, watching.scene, folder, frame, "1280x720"), f"frame {frame} is not that of still")
    choose_size(browser, 320, 320)
    check(browser.run("byId('side').value") == "320", "the page does not say its size")
    choose_size(browser, 640, 640)
    # Keys go to the film, whatever was clicked last.
    for clicked in ("document.body", "timeline", "byId('play')", "byId('speed')", "byId('render')", "rows.get('world.duration').slider"):
        browser.run(f"{clicked}.focus(), {clicked}.dispatchEvent(new Event('pointerup'))")
        for key, expected in (("Home", 0), ("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", 119)):
            browser.press(key)
            browser.wait(f"drawn === {expected}", 5)
    browser.run("document.activeElement.blur()")
    browser.press(" ", "Space", " ")
    browser.wait("playing !== null && drawn > 5 && drawn < 100")
    browser.press(" ", "Space", " ")
    browser.wait("playing === null")


def choose_size(browser, px, width):
    browser.run(f"byId('side').value = '{px}', byId('side').dispatchEvent(new Event('change'))")
    browser.wait(f"film.width === {width} && canvas.width === {width}")


def check_outputs(watching):
    """Save frame and Render give the files of the program with the numbers of the page."""
    browser, scene = watching.browser, watching.scene
    angle = "rows.get('rope[0].hang.angle_deg')"
    film = watching.film()
    browser.run(f"{angle}.field.value = 50, {angle}.field.dispatchEvent(new Event('change'))")
    browser.wait(f"film.number > {film} && canvas.dataset.frame.startsWith(film.number + ':')")
    browser.run("seek(15)")
    check(browser.run("byId('download').download") == "scene_0.5s.png", "another name of a frame")
    address = watching.address + browser.run("byId('download').getAttribute('href')")
    saved = urllib.request.urlopen(address).read()
    made = os.path.join(os.path.dirname(scene), "made.png")
    numbers = ["--set", "rope[0].hang.angle_deg=50"]
    subprocess.run([watching.corda, "still", scene, "--frame", "15", *numbers, "-o", made, "-q"], check=True, stdout=subprocess.DEVNULL)
    with open(made, "rb") as file:
        check(saved == file.read(), "Save frame is not the file of still")
    browser.run("byId('render').click()")
    browser.wait("byId('rendered').textContent.endsWith('120 frames written')")
    made = os.path.join(os.path.dirname(scene), "made.mp4")
    subprocess.run([watching.corda, "render", scene, *numbers, "-o", made, "-q"], check=True, stdout=subprocess.DEVNULL)
    check(filecmp.cmp(os.path.join(os.path.dirname(scene), "scene.mp4"), made, False), "Render is not the file of render")
    browser.run("byId('discard').click()")
    browser.wait("byId('writing').hidden")


def check_tabs(watching):
    """Pages share the six connections of a browser, and none of them keeps one for long."""
    version = 0
    while (answer := urllib.request.urlopen(f"{watching.address}state?after={version}")).status != 204:
        version = json.loads(answer.read())["version"]
    start = time.monotonic()
    for _ in range(6):
        answer = urllib.request.urlopen(f"{watching.address}state?after={version}")
        check(answer.status == 204, "a state that is known is sent again")
    check(time.monotonic() - start < 6 * 0.5, "a request for the state waits for long")


def check_next_program(watching):
    """A page that is open takes up the next program at its port."""
    browser = watching.browser
    port = int(re.search(r":(\d+)/", watching.address)[1])
    watching.end()
    watching.start(port)
    check(watching.address.endswith("/"), "no address")
    watching.end()
    watching.start(port)
    browser.open(watching.address)
    browser.wait(f"location.href === {watching.address!r} && typeof film === 'object' && film !== null && drawn >= 0")
    film, address = watching.film(), watching.address
    check(watching.end() == 130, "another status after Ctrl-C")
    browser.wait("byId('status').textContent.startsWith('corda watch has ended')")
    watching.start(port)
    check(watching.address == address, "the address has changed")
    browser.wait(f"film.number > {film} && canvas.dataset.frame.startsWith(film.number + ':') && !byId('status').classList.contains('bad')")
    check(browser.run("byId('problems').hidden"), "a problem is shown")


def check_errors(watching):
    browser, film = watching.browser, watching.film()
    before = pixels_of(browser)
    watching.save(SCENE.replace("length = 1.0", "lenght = 1.0"))
    text = browser.wait("!byId('problems').hidden && byId('problems').textContent")
    check("line 6, column" in text and "length" in text, f"the error reads: {text}")
    check(pixels_of(browser) == before and watching.film() == film, "the last good picture did not stay")
    watching.save(SCENE.replace("links = 3", "links = 4"))
    browser.wait(f"film.number > {film} && byId('problems').hidden && canvas.dataset.frame.startsWith(film.number + ':')")
    check(pixels_of(browser) != before, "the picture did not change")


def check_numbers(watching):
    browser = watching.browser
    watching.save(SCENE)
    browser.wait("rows.has('rope[0].hang.angle_deg') && rows.get('rope[0].hang.links').slider.value === '3'")
    film = watching.film()
    browser.run("(() => { const {slider} = rows.get('rope[0].hang.angle_deg'); slider.value = 45; slider.dispatchEvent(new Event('input')); })()")
    browser.wait(f"film.number > {film} && !byId('writing').hidden")
    with open(watching.scene, encoding="utf-8") as file:
        check(file.read() == SCENE, "a slider wrote to the file")
    browser.run("byId('write').click()")
    browser.wait("byId('writing').hidden")
    with open(watching.scene, encoding="utf-8") as file:
        written = file.read()
        check(written == SCENE.replace("80.0", "45.0"), f"writing made of the file: {written}")


def check_faults(watching):
    """Requests that fail are made again, or leave a number that can be changed."""
    browser = watching.browser
    browser.run("""(() => {
        const whole = window.fetch;
        let left = 2;
        window.fetch = (path, ...rest) => path.startsWith('frame/90') && left-- > 0 ? Promise.resolve(new Response('', {status: 503}))
            : path === 'number' ? Promise.reject(new Error('cut off')) : whole(path, ...rest);
        window.mend = () => { window.fetch = whole; };
        seek(90);
    })()""")
    browser.wait("drawn === 90")
    slide = "(() => { const {slider} = rows.get('rope[0].hang.angle_deg'); slider.value = %d; slider.dispatchEvent(new Event('input')); })()"
    browser.run(slide % 50)
    browser.wait("!byId('problems').hidden && byId('problems').textContent === 'cut off' && sending.size === 0")
    film = watching.film()
    browser.run("mend()")
    browser.run(slide % 55)
    browser.wait(f"film.number > {film}")


class Tunnel(socketserver.ThreadingTCPServer):
    """Another port of this machine that leads to the server's, as that of ssh -L."""

    daemon_threads = True

    def __init__(self, port):
        class Handler(socketserver.BaseRequestHandler):
            def handle(self):
                with socket.create_connection(("127.0.0.1", port)) as far:
                    ends = {self.request: far, far: self.request}
                    while True:
                        for end in select.select(list(ends), [], [])[0]:
                            part = end.recv(1 << 16)
                            if not part:
                                return
                            ends[end].sendall(part)

        super().__init__(("127.0.0.1", 0), Handler)
        threading.Thread(target=self.serve_forever, daemon=True).start()


class Proxy(http.server.ThreadingHTTPServer):
    """Serves /proxy/PORT/... from that port, as Jupyter's proxy does. `host`: the Host header that it sends; None: that of the browser."""

    daemon_threads = True

    def __init__(self, port, host):
        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                prefix = f"/proxy/{port}"
                if not self.path.startswith(prefix + "/"):
                    self.send_error(404)
                    return
                far = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
                headers = {**self.headers, **({"Host": host} if host else {})}
                body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
                far.request(self.command, self.path[len(prefix):], body, headers)
                answer = far.getresponse()
                text = answer.read()
                self.send_response(answer.status)
                for name in ("Content-Type", "Content-Security-Policy"):
                    self.send_header(name, answer.getheader(name))
                self.send_header("Content-Length", str(len(text)))
                self.end_headers()
                self.wfile.write(text)

            do_POST = do_GET

            def log_message(self, *_):
                pass

        super().__init__(("127.0.0.1", 0), Handler)
        threading.Thread(target=self.serve_forever, daemon=True).start()


def check_ways(watching):
    """The page works by an ssh tunnel and behind a proxy at a path, and changes the film by both."""
    browser = watching.browser
    port, path = re.fullmatch(r"http://127\.0\.0\.1:(\d+)(/.*)", watching.address).groups()
    tunnel, proxy, renaming = Tunnel(int(port)), Proxy(int(port), None), Proxy(int(port), "127.0.0.1:" + port)
    for angle, address in enumerate((f"http://localhost:{tunnel.server_address[1]}{path}",
                                     f"http://127.0.0.1:{proxy.server_address[1]}/proxy/{port}{path}",
                                     f"http://hub.localhost:{renaming.server_address[1]}/proxy/{port}{path}")):
        browser.open(address)
        browser.wait(f"location.href === {address!r} && document.readyState === 'complete' && typeof film === 'object' && film !== null && drawn >= 0")
        film = watching.film()
        browser.run(f"(() => {{ const {{field}} = rows.get('rope[0].hang.angle_deg'); field.value = {30 + angle}; field.dispatchEvent(new Event('change')); }})()")
        browser.wait(f"film.number > {film} && canvas.dataset.frame.startsWith(film.number + ':')")
    # Another page may read nothing and change nothing, even if it knows the address.
    for headers in ({"Origin": "http://evil.example"}, {"Host": "evil.example"}):
        far = http.client.HTTPConnection("127.0.0.1", tunnel.server_address[1], timeout=60)
        far.request("POST", path + "number", "{}", headers)
        check(far.getresponse().status == 403, f"{headers} are not refused")
    for server in (tunnel, proxy, renaming):
        server.shutdown()
    browser.open(watching.address)
    browser.wait(f"location.href === {watching.address!r} && document.readyState === 'complete' && typeof film === 'object' && film !== null && drawn >= 0")


def check_saves(watching, count):
    """Saves the scene again and again; prints the milliseconds from each save to its picture, and what it takes."""
    browser = watching.browser
    browser.run("seek(20)")
    times_ms = []
    kib = []
    cpu_ms = processor_ms(watching.program.pid)
    for i in range(count):
        film = watching.film()
        text = SCENE.replace("angle_deg = 80.0", f"angle_deg = {20 + i % 60}.5")
        # The page notes the time, because asking it takes time.
        done = browser.run(f"""window.shownAt = new Promise((resolve) => {{
            const look = () => film.number > {film} && drawn === frame && canvas.dataset.frame === film.number + ':' + frame
                ? resolve(Date.now()) : setTimeout(look, 1);
            look();
        }}), 0""")
        check(done == 0, "no promise")
        start = time.time()
        watching.save(text)
        times_ms.append(browser.run("shownAt") - 1000 * start)
        kib.append(resident_kib(watching.program.pid))
    check(max(kib[len(kib) // 2:]) < 1.1 * max(kib[:len(kib) // 2]), f"memory grows: {kib[0]} to {kib[-1]} KiB")
    times_ms.sort()
    print(f"from a save to its picture, {count} saves: median {statistics.median(times_ms):.0f} ms, "
          f"95 % {times_ms[int(0.95 * count)]:.0f} ms; {(processor_ms(watching.program.pid) - cpu_ms) / count:.0f} ms of CPU "
          f"each; memory {kib[0] >> 10} MiB after the first, {kib[-1] >> 10} MiB after the last")


def keep_figures(watching, folder):
    browser = watching.browser
    os.makedirs(folder, exist_ok=True)
    for name, width, height, scale, mobile in (("desktop", 1440, 900, 1, False), ("phone", 390, 844, 2, True)):
        browser.resize(width, height, scale, mobile)
        for scheme in ("light", "dark"):
            browser.use_scheme(scheme)
            time.sleep(0.5)
            browser.screenshot(os.path.join(folder, f"{name}-{scheme}.png"), mobile)
    browser.resize(1440, 900)
    watching.save(SCENE.replace("length = 1.0", "lenght = -1.0").replace("fps = 30", "fps = 0"))
    browser.wait("!byId('problems').hidden")
    browser.screenshot(os.path.join(folder, "error.png"))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("corda")
    parser.add_argument("--saves", type=int, default=30)
    parser.add_argument("--figures")
    options = parser.parse_args()
    corda = os.path.abspath(options.corda)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        scene = os.path.join(folder, "scene.toml")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(SCENE)
        with Chromium(folder) as browser:
            watching = Watching(corda, browser, scene)
            try:
                check_scrubbing(watching, corda, folder)
                check_errors(watching)
                check_numbers(watching)
                check_faults(watching)
                check_outputs(watching)
                check_tabs(watching)
                check_ways(watching)
                check_next_program(watching)
                check_saves(watching, options.saves)
                if options.figures:
                    keep_figures(watching, options.figures)
            finally:
                status = watching.end()
            check(status == 130, f"ends with {status} after Ctrl-C")


main()
