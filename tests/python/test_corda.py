"""The Python module, against the program: the same frames, positions and videos, byte for byte."""

import ast
import base64
import concurrent.futures
import gc
import inspect
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import corda
import corda.plot
import corda.testing

PROGRAM = os.environ["CORDA_PROGRAM"]
EXAMPLES = pathlib.Path(os.environ["CORDA_EXAMPLES"])
SCENE = str(EXAMPLES / "first.toml")
SMALL = {"size": (320, 180), "duration": 1}
OPTIONS = ["--size", "320x180", "--duration", "1"]


def run(*arguments):
    subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True)


@pytest.fixture(scope="module")
def film():
    return corda.Film(SCENE, **SMALL)


def test_frames_are_those_of_the_program(film, tmp_path):
    run("still", SCENE, *OPTIONS, "--frame", "0,17,59", "-o", tmp_path / "stills")
    stills = sorted((tmp_path / "stills").iterdir())
    assert len(stills) == 3
    for k, path in zip((0, 17, 59), stills):
        frame = film.frame(k)
        assert frame.dtype == np.uint8 and frame.shape == (180, 320, 4)
        assert np.array_equal(frame, corda.read_png(path))
        assert corda.compare(frame, path).equal
    run("still", SCENE, *OPTIONS, "--at", "0.123", "-o", tmp_path / "at.png")
    assert np.array_equal(film.still(0.123), corda.read_png(tmp_path / "at.png"))


def test_positions_are_those_of_the_program(film, tmp_path):
    run("simulate", SCENE, "--set", "video.size=[320,180]", "--duration", "1", "-o", tmp_path / "rows.csv")
    rows = np.genfromtxt(tmp_path / "rows.csv", delimiter=",", skip_header=1, comments="#")
    assert np.array_equal(film.times, rows[: len(film), 0])
    assert film.positions.shape == (60, rows.shape[1] // 2, 2)
    assert np.array_equal(film.positions.reshape(60, -1), rows[: len(film), 1:])


def test_videos_are_those_of_the_program(film, tmp_path):
    run("render", SCENE, *OPTIONS, "-o", tmp_path / "program.mp4")
    assert film.save(tmp_path / "module.mp4") == 60
    assert (tmp_path / "module.mp4").read_bytes() == (tmp_path / "program.mp4").read_bytes()


def test_a_film_tells_what_it_is(film):
    assert len(film) == 60
    assert film.size == (320, 180)
    assert film.fps == 60
    assert repr(film) == "<corda.Film of 60 frames, 320x180 at 60 per second>"
    assert film.plan["methods"] == ["exact"]
    assert 0 < film.plan["error_estimate_px"] < 0.1
    assert film.plan["horizon_s"] is None
    assert film.camera["height"] > 0
    assert corda.__version__ in subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout


def test_a_film_is_a_sequence_of_frames(film):
    assert np.array_equal(film[17], film.frame(17)) and np.array_equal(film[np.int64(-1)], film.frame(59))
    assert np.array_equal(film.frame(-60), film.frame(0)) and np.array_equal(film.mask(-1), film.mask(59))
    some = film[50:1000:4]
    assert isinstance(some, list) and [np.array_equal(some[i], film.frame(50 + 4 * i)) for i in range(3)] == [True] * 3
    assert len(film[:-4:-1]) == 3 and film[3:3] == []
    short = corda.Film(SCENE, size=(32, 18), duration=0.1)
    assert [frame.tobytes() for frame in short] == [short.frame(k).tobytes() for k in range(len(short))]
    for wrong in (60, 1000, -61, 2**70):
        for call in (film.frame, film.mask, film.__getitem__):
            with pytest.raises(IndexError, match=rf"frame {wrong} is not within 0 \.\. 59"):
                call(wrong)
    with pytest.raises(TypeError):
        film[1.5]


def test_a_module_for_another_python_says_so(tmp_path):
    package = tmp_path / "corda"
    package.mkdir()
    for path in pathlib.Path(corda.__file__).parent.glob("*.py"):
        (package / path.name).write_text(path.read_text())
    (package / "_corda.cpython-399-x86_64-linux-gnu.so").touch()
    ended = subprocess.run([sys.executable, "-c", "import corda"], env={**os.environ, "PYTHONPATH": str(tmp_path)},
                           capture_output=True, text=True)
    this = f"{sys.version_info.major}.{sys.version_info.minor}"
    assert f"ImportError: the module corda is built for 3.99, this is {this}; run python3.99" in ended.stderr


def test_settings_are_those_of_the_command_line(tmp_path):
    settings = {"rope[0].mass": 2, "style.theme": "paper", "overlay.title": 'say "rope"'}
    film = corda.Film(SCENE, **SMALL, fps="30000/1001", world__drag=0.25, settings=settings)
    run("still", SCENE, *OPTIONS, "--fps", "30000/1001", "--set", "world.drag=0.25", "--set", "rope[0].mass=2",
        "--set", "style.theme=paper", "--set", 'overlay.title="say \\"rope\\""', "--frame", "7", "-o", tmp_path / "a.png")
    assert np.array_equal(film.frame(7), corda.read_png(tmp_path / "a.png"))


def test_a_scene_can_be_text(film):
    text = pathlib.Path(SCENE).read_text()
    assert np.array_equal(corda.Film(text=text, **SMALL).frame(5), film.frame(5))
    with pytest.raises(TypeError, match="a path or text"):
        corda.Film(SCENE, text=text)
    with pytest.raises(TypeError, match="a path or text"):
        corda.Film()


def test_errors_have_the_exit_codes_of_the_program(film, tmp_path):
    def code_of(call):
        with pytest.raises(corda.Error) as raised:
            call()
        assert str(raised.value)
        return raised.value.code

    assert code_of(lambda: corda.Film(tmp_path / "none.toml")) == 6
    assert code_of(lambda: corda.Film(text="schema = 1")) == 3
    assert code_of(lambda: corda.Film(SCENE, world__gravty=1)) == 3
    assert code_of(lambda: corda.Film(SCENE, backend="magic").frame(0)) == 2
    assert code_of(lambda: film.still(-1.0)) == 2
    assert code_of(lambda: film.save(tmp_path / "a.magic")) == 2
    (tmp_path / "there.mp4").touch()
    assert code_of(lambda: film.save(tmp_path / "there.mp4")) == 6
    with pytest.raises(corda.Error, match='did you mean "gravity"'):
        corda.Film(SCENE, world__gravty=1)


def test_pictures_can_be_written_read_and_compared(tmp_path):
    picture = np.zeros((3, 5, 4), np.uint8)
    picture[..., 3] = 255
    other = picture.copy()
    other[1, 2, 0] = 7
    assert corda.compare(picture, picture) == (True, True, 0, 0.0, 0.0)
    difference = corda.compare(picture, other)
    assert (difference.equal, difference.max, difference.share) == (False, 7, pytest.approx(1 / 15))
    assert not corda.compare(picture, picture[:2]).same_size
    corda.write_png(tmp_path / "a.png", other[..., :3])
    assert np.array_equal(corda.read_png(tmp_path / "a.png"), other)
    with pytest.raises(corda.Error) as raised:
        corda.write_png(tmp_path / "a.png", other)
    assert raised.value.code == 6
    corda.write_png(tmp_path / "a.png", other, force=True)
    for wrong in (np.zeros((3, 5), np.uint8), np.zeros((3, 5, 2), np.uint8), np.zeros((0, 5, 4), np.uint8)):
        with pytest.raises(ValueError):
            corda.write_png(tmp_path / "b.png", wrong)


def test_frames_outlive_their_film():
    film = corda.Film(SCENE, **SMALL)
    frame = film.frame(3)
    copy = frame.copy()
    assert frame.base is not None  # numpy holds the picture itself
    del film
    gc.collect()
    assert np.array_equal(frame, copy)


def test_threads_share_films(film):
    expected = [film.frame(k) for k in range(10)]
    other = corda.Film(SCENE, size=(160, 90), duration=1)
    small = [other.frame(k) for k in range(10)]
    wrong = []

    def draw(which, frames):
        for k in (*range(10), *reversed(range(10))):
            if not np.array_equal(which.frame(k), frames[k]):
                wrong.append(k)

    threads = [threading.Thread(target=draw, args=arguments) for arguments in [(film, expected), (other, small)] * 2]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_other_threads_run_meanwhile(film, tmp_path):
    counted = 0
    done = threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        film.save(tmp_path / "a.mp4")
    finally:
        done.set()
        thread.join()
    assert counted > 5


def test_progress_is_told_and_can_stop(film, tmp_path):
    heard = []
    film.save(tmp_path / "a.mp4", on_progress=lambda done, total: heard.append((done, total)))
    assert heard[-1] == (60, 60)
    with pytest.raises(corda.Error) as raised:
        film.save(tmp_path / "b.mp4", on_progress=lambda done, total: False)
    assert raised.value.code == 130
    assert not (tmp_path / "b.mp4").exists()

    def fail(done, total):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        film.save(tmp_path / "c.mp4", on_progress=fail)
    other = corda.Film(SCENE, size=(32, 18))
    film.save(tmp_path / "d.mp4", on_progress=lambda done, total: other.still(0.5))
    assert (tmp_path / "d.mp4").read_bytes() == (tmp_path / "a.mp4").read_bytes()


def test_a_progress_callback_may_use_its_film(film, tmp_path):
    film.save(tmp_path / "a.mp4")
    third = film.frame(3)
    calls = 0

    def use(done, total):
        nonlocal calls
        calls += 1
        assert np.array_equal(film.frame(3), third)
        assert film.positions.shape[0] == len(film)
        return True

    film.save(tmp_path / "b.mp4", on_progress=use)
    assert calls > 0
    assert (tmp_path / "b.mp4").read_bytes() == (tmp_path / "a.mp4").read_bytes()


def test_threads_draw_one_film_at_once(film):
    expected = [film.frame(k) for k in range(12)]
    with concurrent.futures.ThreadPoolExecutor(3) as threads:
        drawn = list(threads.map(film.frame, range(12)))
    assert all(np.array_equal(a, b) for a, b in zip(drawn, expected))


def test_a_stopped_video_leaves_nothing_and_stopped_pictures_are_gone_on_with(tmp_path):
    film = corda.Film(SCENE, size=(320, 180), fps=60, duration=1)
    with pytest.raises(corda.Error, match="nothing was written") as raised:
        film.save(tmp_path / "a.mp4", on_progress=lambda done, total: done < 30)
    assert raised.value.code == 130
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(corda.Error, match="--resume continues pictures alone"):
        film.save(tmp_path / "a.mp4", resume=True)
    pictures = tmp_path / "%03d.png"
    with pytest.raises(corda.Error, match="the frames so far are in"):
        film.save(pictures, on_progress=lambda done, total: not (tmp_path / "010.png").exists())
    assert 11 <= len(list(tmp_path.iterdir())) < 60
    kept = (tmp_path / "003.png").stat().st_mtime_ns
    assert film.save(pictures, resume=True) == 60
    assert (tmp_path / "003.png").stat().st_mtime_ns == kept
    assert len(list(tmp_path.iterdir())) == 60


def test_ctrl_c_ends_a_render(tmp_path):
    script = textwrap.dedent(f"""
        import corda
        film = corda.Film({SCENE!r}, size=(640, 360), duration=600)
        print("ready", flush=True)
        try:
            film.save({str(tmp_path / "long.mp4")!r})
        except KeyboardInterrupt:
            film.frame(7)
            print("stopped", flush=True)
    """)
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    time.sleep(1.0)
    child.send_signal(signal.SIGINT)
    out, _ = child.communicate(timeout=60)
    assert out == "stopped\n"
    assert child.returncode == 0
    assert not (tmp_path / "long.mp4").exists()


def test_a_film_shows_itself_in_a_notebook():
    film = corda.Film(SCENE, size=(128, 72), duration=0.5)
    html = film._repr_html_()
    data = base64.b64decode(re.search(r'src="data:video/mp4;base64,([^"]*)"', html).group(1))
    assert data[4:8] == b"ftyp"
    film.largest_embedded = 100
    assert "film.save" in film._repr_html_()


def test_a_thousand_frames_take_no_memory(film):
    def peak_mib():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    for k in range(100):
        film.frame(k % 60)
    before = peak_mib()
    for k in range(1000):  # 230 MB of pictures
        film.frame(k % 60)
    assert peak_mib() - before < 20  # measured: 0


def test_golden_pictures(film, tmp_path, monkeypatch, capfd):
    check = corda.testing.assert_matches_golden
    monkeypatch.setenv("CORDA_GOLDEN_DIR", str(tmp_path / "ref"))
    with pytest.raises(AssertionError, match="there is no golden picture"):
        check(film.frame(17), "first.png")
    monkeypatch.setenv("CORDA_UPDATE_GOLDENS", "1")
    check(film.frame(17), "first.png")
    assert "written" in capfd.readouterr().err
    monkeypatch.delenv("CORDA_UPDATE_GOLDENS")
    check(film.frame(17), "first.png")
    check(tmp_path / "ref/first.png", "first.png", folder=tmp_path / "ref")
    monkeypatch.setenv("CORDA_GOLDEN_ARTIFACTS", str(tmp_path / "out"))
    with pytest.raises(AssertionError, match="max [1-9]"):
        check(film.frame(18), "first.png")
    assert np.array_equal(corda.read_png(tmp_path / "out/first.new.png"), film.frame(18))
    check(film.frame(18), "first.png", max=255)
    with pytest.raises(AssertionError):
        check(film.frame(18), "first.png", max=255, share=0)
    with pytest.raises(corda.Error, match="ends in .png"):
        check(film.frame(18), "first.jpg")
    monkeypatch.setenv("CORDA_UPDATE_GOLDENS", "1")
    check(film.frame(18), "first.png", film=film)
    monkeypatch.delenv("CORDA_UPDATE_GOLDENS")
    other = corda.Film(SCENE, **SMALL, world__drag=0.3)
    with pytest.raises(AssertionError, match="world.drag is 0.3 and was .*repeat the test: python3 -m pytest .*test_golden_pictures.*; "
                       "accept it: CORDA_UPDATE_GOLDENS=1 python3 -m pytest"):
        check(other.frame(18), "first.png", film=other)


def test_golden_scenes_are_test_cases(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", os.path.dirname(os.environ["CORDA_PROGRAM"]) + os.pathsep + os.environ["PATH"])
    monkeypatch.chdir(tmp_path)
    text = pathlib.Path(SCENE).read_text()
    for name, more in (("b", "[golden]\nat = [0.0]\nsize = [64, 48]\n"), ("a/c", "golden.at = [0.1]\n"), ("plain", "")):
        path = tmp_path / "scenes" / f"{name}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(more + text if more.startswith("golden.at") else text + more)
    scenes = corda.testing.golden_scenes("scenes")
    assert scenes == ["scenes/a/c.toml", "scenes/b.toml"]
    with pytest.raises(AssertionError, match="missing(.|\n)*repeat: corda golden scenes/b.toml --dir ref\naccept: .*--update"):
        corda.testing.assert_golden(scenes[1], "ref")
    for scene in scenes:
        corda.testing.assert_golden(scene, "ref", "--update")
        corda.testing.assert_golden(scene, "ref")
    corda.testing.assert_golden("scenes", "ref", "--stale")


def test_stubs_tell_all_names_and_parameters():
    stub = ast.parse((pathlib.Path(corda.__file__).parent / "__init__.pyi").read_text())
    names = {node.name: node for node in stub.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert set(corda.__all__) - {"__version__"} <= set(names)

    def check(function, node):
        arguments = node.args
        told = [one.arg for one in arguments.posonlyargs + arguments.args + arguments.kwonlyargs]
        assert told == [name for name, one in inspect.signature(function).parameters.items()
                        if one.kind not in (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)]
        assert function.__doc__ or function.__name__.startswith("__")

    for name in ("compare", "read_png", "write_png"):
        check(getattr(corda, name), names[name])
    of_testing = ast.parse((pathlib.Path(corda.__file__).parent / "testing.pyi").read_text()).body
    functions = [node for node in of_testing if isinstance(node, ast.FunctionDef)]
    assert {node.name for node in functions} == set(corda.testing.__all__)
    for node in functions:
        check(getattr(corda.testing, node.name), node)
    of_plot = ast.parse((pathlib.Path(corda.__file__).parent / "plot.pyi").read_text()).body
    plots = {node.name: node for node in of_plot if isinstance(node, ast.FunctionDef)}
    assert set(plots) == set(corda.plot.__all__)
    for name, node in plots.items():
        check(getattr(corda.plot, name), node)
    for kind in (corda.Film, corda.Sweep):
        methods = {node.name: node for node in names[kind.__name__].body if isinstance(node, ast.FunctionDef)}
        for name, value in vars(kind).items():
            if inspect.isfunction(value) and (not name.startswith("_") or name in methods):
                check(value, methods[name])
            elif isinstance(value, property):
                assert name in methods and value.__doc__


def test_pictures_are_of_bytes(film):
    frame = film.frame(0)
    for other in (frame / 255.0, frame.astype(int), frame.tolist()):
        with pytest.raises(TypeError, match="uint8"):
            corda.compare(frame, other)
    assert corda.compare(frame[:, ::-1], frame[:, ::-1].copy()).equal  # strides of any kind


def test_forked_workers_draw_after_their_parent_has_drawn(tmp_path):
    if "LP_NUM_THREADS" in os.environ:
        pytest.skip("llvmpipe draws with threads that the user asks for")
    program = textwrap.dedent("""
        import multiprocessing, os, sys
        import corda
        SMALL = {"size": (160, 90), "duration": 0.2}
        film = corda.Film(sys.argv[1], **SMALL)
        drawn = film.frame(3).tobytes()

        def own(k):
            return corda.Film(sys.argv[1], **SMALL).frame(k).tobytes() == drawn

        def tinted(k):  # with OpenGL functions that the parent has not called
            film = corda.Film(sys.argv[1], settings={"style.color_by": "speed"}, **SMALL)
            return len(set(film.frame(k).tobytes())) > 9

        def inherited(k):
            return film.frame(k).tobytes() == drawn

        def grandchild(k):
            with multiprocessing.get_context("fork").Pool(1) as pool:
                return pool.map_async(own, [k]).get(timeout=60)[0]

        def save(k):
            return corda.Film(sys.argv[1], **SMALL).save(f"{sys.argv[2]}/{os.getpid()}.mkv", force=True) > 0

        for work in (tinted, own, inherited, save):
            with multiprocessing.get_context("fork").Pool(2) as pool:
                print(pool.map_async(work, [3, 3]).get(timeout=60), flush=True)
        child = os.fork()
        if child == 0:
            sys.exit(0 if grandchild(3) else 1)
        print(os.waitpid(child, 0)[1])
    """)
    # A child that stores a shader, because the cache has none, would wait for a thread of its parent.
    done = subprocess.run([sys.executable, "-c", program, SCENE, str(tmp_path)], capture_output=True, text=True, timeout=300,
                          env={**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache")})
    assert done.stdout.split("\n")[:5] == 4 * ["[True, True]"] + ["0"], done.stderr


@pytest.mark.long
def test_the_example_notebook_runs(tmp_path):
    notebook = tmp_path / "notebook.ipynb"  # its outputs go into the same folder
    notebook.write_bytes((EXAMPLES / "notebook.ipynb").read_bytes())
    subprocess.run([sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--inplace", str(notebook)],
                   check=True, capture_output=True)
    text = notebook.read_text()
    assert "data:video/mp4;base64," in text and "image/png" in text
