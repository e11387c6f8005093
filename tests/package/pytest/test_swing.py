"""A user's golden tests in pytest: a suite by the program, and one picture by the module."""

import subprocess

import corda


def test_golden():
    subprocess.run(["corda", "golden", "scenes", "--dir", "ref"], check=True)


def test_a_frame_is_the_kept_one():
    film = corda.Film("scenes/swing.toml", size=(320, 180))
    assert corda.compare(film.still(0.5), "kept.png").equal
    assert not corda.compare(film.still(0.6), "kept.png").equal
