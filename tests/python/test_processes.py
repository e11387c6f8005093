"""Films in threads, in other processes, at the end of the interpreter, and under Ctrl-C."""

import concurrent.futures
import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest

import corda

SCENE = """schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 60.0 }
[video]
size = [160, 90]
fps = 30
"""
REPEATS = 20 if os.environ.get("CORDA_TEST_LONG") else 3


def total_of_frame(k):
    return int(corda.Film(text=SCENE).frame(k).sum())


def run(program, **options):
    """Runs a Python program with SCENE defined; returns the result of subprocess.run."""
    text = f"import corda, os, threading, time\nSCENE = {SCENE!r}\n" + textwrap.dedent(program)
    return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, **options)


def test_threads_draw_films_of_their_own():
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        totals = list(pool.map(total_of_frame, [3] * 8))
    assert set(totals) == {total_of_frame(3)}


def test_spawned_processes_draw():
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map_async(total_of_frame, [3, 5]).get(60) == [total_of_frame(3), total_of_frame(5)]


def test_golden_pictures_hold_in_all_workers_of_xdist(tmp_path):
    (tmp_path / "test_pictures.py").write_text(textwrap.dedent(f"""
        import pytest, corda, corda.testing
        film = corda.Film(text={SCENE!r})
        @pytest.mark.parametrize("k", range(8))
        def test_frame(k):
            corda.testing.assert_matches_golden(film.frame(k), f"frame_{{k}}.png", folder={str(tmp_path)!r})
    """))
    command = [sys.executable, "-m", "pytest", "-q", "-n", "2", "-p", "no:cacheprovider", str(tmp_path)]
    for more in ({"CORDA_UPDATE_GOLDENS": "1"}, {}):
        ended = subprocess.run(command, capture_output=True, text=True, timeout=60, env={**os.environ, **more}, cwd=tmp_path)
        assert "8 passed" in ended.stdout, ended.stdout + ended.stderr
    (tmp_path / "frame_3.png").write_bytes((tmp_path / "frame_4.png").read_bytes())
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert "1 failed, 7 passed" in ended.stdout, ended.stdout


def test_processes_forked_before_any_drawing_draw():
    ended = run("""
        import multiprocessing
        def total(k): return int(corda.Film(text=SCENE).frame(k).sum())
        with multiprocessing.get_context("fork").Pool(2) as pool:
            print(pool.map_async(total, [3, 5]).get(30))
    """)
    assert ended.stdout == f"[{total_of_frame(3)}, {total_of_frame(5)}]\n", ended.stderr


def test_a_film_that_was_drawing_during_a_fork_draws_in_the_child(tmp_path):
    ended = run("""
        film = corda.Film(text=SCENE, duration=60)
        def fork(done, total):
            child = os.fork()
            if child == 0:
                os.write(1, f"{film.frame(3).sum()} ".encode())
                os._exit(0)
            os.waitpid(child, 0)
            return False
        try:
            film.save("film.mp4", on_progress=fork)
        except corda.Error:
            pass
        print(film.frame(3).sum())
    """, cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    in_child, in_parent = ended.stdout.split()
    assert in_child == in_parent


DAEMONS = {
    "frames": "film = corda.Film(text=SCENE)\ndef work():\n    while True: film.frame(3)",
    "films": "def work():\n    while True: corda.Film(text=SCENE, duration=5)",
    "save": "film = corda.Film(text=SCENE, duration=60)\ndef work(): film.save('film.mp4', on_progress=lambda done, total: True)",
}


@pytest.mark.parametrize("name", DAEMONS)
def test_the_interpreter_ends_while_a_daemon_thread_works(name, tmp_path):
    for repeat in range(REPEATS):
        start = f"\nthreading.Thread(target=work, daemon=True).start()\ntime.sleep({0.2 + 0.05 * repeat})"
        (tmp_path / str(repeat)).mkdir()
        ended = run(DAEMONS[name] + start, cwd=tmp_path / str(repeat))
        assert (ended.returncode, ended.stderr) == (0, "")


def test_films_work_in_functions_that_run_at_exit():
    ended = run("""
        import atexit
        film = corda.Film(text=SCENE)
        atexit.register(lambda: print(film.frame(3).sum()))
    """)
    assert ended.stdout == f"{total_of_frame(3)}\n", ended.stderr


def test_a_film_left_in_a_module_ends_with_the_interpreter():
    ended = run("film = corda.Film(text=SCENE)\nfilm.frame(0)\nother = film")
    assert (ended.returncode, ended.stderr) == (0, "")


def test_ctrl_c_ends_the_reading_of_a_large_scene(tmp_path):
    points = ",".join(f"[{i},0]" for i in range(300_000))
    (tmp_path / "large.toml").write_text(f"schema = 1\n[[rope]]\npoints = [{points}]\n")
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent("""
        import threading, corda
        threading.Thread(target=lambda: print("other threads run", flush=True)).start()
        print("begins", flush=True)
        corda.Film("large.toml")
    """)], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while "begins" not in process.stdout.readline():
        pass
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    _, words = process.communicate(timeout=30)
    assert process.returncode != 0
    assert "KeyboardInterrupt" in words
