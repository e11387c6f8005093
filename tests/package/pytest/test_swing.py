"""A user's golden tests in pytest: a suite by the program, and one picture by the module."""

import corda
import corda.testing
import pytest


@pytest.mark.parametrize("scene", corda.testing.golden_scenes("scenes"))
def test_golden(scene):
    corda.testing.assert_golden(scene, "ref")


def test_no_picture_is_stale():
    corda.testing.assert_golden("scenes", "ref", "--stale")


def test_a_frame_is_the_kept_one():
    film = corda.Film("scenes/swing.toml", size=(320, 180))
    corda.testing.assert_matches_golden(film.still(0.5), "kept.png")
    with pytest.raises(AssertionError, match="differs from './kept.png': max.*accept it: CORDA_UPDATE_GOLDENS=1 python3 -m pytest"):
        corda.testing.assert_matches_golden(film.still(0.6), "kept.png")
