"""A user's golden tests in pytest: a suite by the program, and one picture by the module."""

import subprocess

import corda
import corda.testing
import pytest


def test_golden():
    subprocess.run(["corda", "golden", "scenes", "--dir", "ref"], check=True)


def test_a_frame_is_the_kept_one():
    film = corda.Film("scenes/swing.toml", size=(320, 180))
    corda.testing.assert_matches_golden(film.still(0.5), "kept.png")
    with pytest.raises(AssertionError, match="differs from './kept.png': max"):
        corda.testing.assert_matches_golden(film.still(0.6), "kept.png")
