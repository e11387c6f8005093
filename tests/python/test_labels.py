"""Labels of a film: velocities, tensions, energy, pixel coordinates and masks."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import corda

PROGRAM = os.environ["CORDA_PROGRAM"]
SCENE = str(pathlib.Path(os.environ["CORDA_EXAMPLES"]) / "first.toml")

PENDULUM = """
schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 1, length = 0.8, angle_deg = 60.0 }
mass = [1.0, 2.5]
[solver]
method = "exact"
tolerance = 1e-12
[style]
rope_width_px = 0.4    # covers less than half of any pixel: the mask shows the ball alone
halo = false
[video]
size = [320, 240]
fps = 30
"""


def test_fields_are_those_of_the_program(tmp_path):
    film = corda.Film(SCENE, size=(320, 180), duration=1)
    subprocess.run([PROGRAM, "simulate", SCENE, "--set", "video.size=[320,180]", "--duration", "1", "--velocity", "--tension",
                    "-o", tmp_path / "rows.csv"], check=True, capture_output=True)
    rows = np.genfromtxt(tmp_path / "rows.csv", delimiter=",", names=True, comments="#")
    for array, prefix in ((film.velocities, "v"), (film.tensions, "tension")):
        names = [name for name in rows.dtype.names if name.startswith(prefix)]
        expected = np.stack([rows[name] for name in names], axis=1)[: len(film)]
        assert np.array_equal(array.reshape(len(film), -1), expected)


def test_a_pendulum_has_the_energy_and_the_tension_of_the_textbook():
    film = corda.Film(text=PENDULUM)
    mass, length, g = 2.5, 0.8, 9.81
    position, velocity = film.positions[:, 1], film.velocities[:, 1]
    assert film.energy.shape == (30, 3) and film.tensions.shape == (30, 1)
    square = (velocity**2).sum(axis=1)
    kinetic, potential, total = film.energy.T
    assert np.allclose(kinetic, 0.5 * mass * square, rtol=1e-13)
    assert np.allclose(potential, mass * g * (position[:, 1] - position[0, 1]), atol=1e-13)
    assert np.abs(total).max() < 1e-13  # measured 9e-15
    # T = m (g cos(angle) + v^2 / L)
    tension = mass * (-g * position[:, 1] / length + square / length)
    assert np.allclose(film.tensions[:, 0], tension, rtol=1e-14)  # measured 5e-16


def test_a_method_without_tensions_gives_nan():
    film = corda.Film(text=PENDULUM, settings={"solver": {"method": "relaxation"}})
    assert np.isnan(film.tensions).all()
    assert np.isfinite(film.velocities).all()


CAMERAS = ["margin = 0.08", 'follow = "tip"', "path = [{ t = 0 }, { t = 1, center = [0.1, -0.2], height = 3 }]"]


@pytest.mark.parametrize("camera", CAMERAS)
def test_pixel_coordinates_are_those_of_the_drawn_ball(camera):
    film = corda.Film(text=PENDULUM + "[camera]\n" + camera)
    pixels = film.to_pixels(film.positions)
    assert pixels.shape == film.positions.shape
    for k in (0, 7, 29):
        rows, columns = np.nonzero(film.mask(k))
        assert len(rows) > 50
        centroid = np.array([columns.mean() + 0.5, rows.mean() + 0.5])
        assert np.abs(centroid - pixels[k, 1]).max() < 0.3  # measured 0.16
    if camera != CAMERAS[0]:
        with pytest.raises(ValueError, match="of all frames"):
            film.to_pixels(film.positions[3, 1])
        return
    assert np.array_equal(film.to_pixels(film.positions[3, 1]), pixels[3, 1])
    with pytest.raises(ValueError, match="shape"):
        film.to_pixels([1.0, 2.0, 3.0])


def test_a_mask_is_the_silhouette_of_the_drawn_body():
    style = {"style.background": "#ffffff", "style.supports": False, "style.payload": False, "style.palette": ["#000000"],
             "overlay.time": False, "overlay.scale_bar": False}
    film = corda.Film(text=PENDULUM.replace("0.4", "7.0"), settings=style)
    for k in (0, 11):
        mask = film.mask(k)
        assert mask.dtype == np.uint8 and mask.shape == (240, 320)
        assert np.array_equal(mask == 1, film.frame(k)[:, :, 0] < 128)
    with pytest.raises(IndexError):
        film.mask(1000)


def test_a_mask_shows_the_body_in_front():
    crossing = "[[rope]]\nline = { particles = 2, from = [-0.3, -0.2], step = [0.8, 0.0] }\npinned = [0, 1]\n"
    film = corda.Film(text=PENDULUM.replace("0.4", "7.0") + crossing)
    mask = film.mask(0)
    assert set(np.unique(mask)) == {0, 1, 2}
    column, row = np.floor(film.to_pixels([0.0 + 0.2 * np.tan(np.pi / 3), -0.2])).astype(int)
    assert (mask[row - 1 : row + 2, column - 1 : column + 2] == 2).all()
