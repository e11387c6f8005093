"""One sample of a sweep: its film, its arrays, its figures and its pictures."""

import dataclasses
import math
import os

import numpy as np

from . import _corda, _parameters
from ._corda import Error, __version__
from ._motion import _cubic, _root

#: Codes of errors that say that a scene is not one that Corda makes. They refuse a sample and do not end the sweep.
REFUSALS = (2, 3, 8)
_OF_A_SUMMARY = ("times", "positions", "velocities", "tensions")


@dataclasses.dataclass
class Sample:
    """A sample, or the reason why there is none: then the members after the fifth are None."""

    number: int
    key: str
    split: str  #: "" if the file names none
    parameters: dict
    failure: tuple = None  #: exit code and message
    info: dict = None  #: the contents of its .json
    arrays: dict = None
    pictures: dict = None  #: bytes of its files by their extension, in order


def make_sample(sweep, number, pictures, backend="auto", require_gpu=False):
    """Makes a sample. `pictures`: "mp4" and "png" make files, "npz" the array "frames", "none" nothing. Raises Error for what
    may be wrong with more than this sample, which the message names."""
    sample = Sample(number, _parameters.key_of(number), _parameters.split_of(sweep, number), {})
    try:
        sample.parameters = _parameters.parameters_of(sweep, number)
        settings = _parameters.settings_of(sample.parameters)
        film = _corda.sample_film(sweep.scene_toml, os.fsencode(sweep.scene_source), settings, backend, require_gpu)
        facts = _corda.sample_facts(film)  # simulates the motion to its end
        more = [label for label in sweep.labels if label not in _OF_A_SUMMARY]
        arrays = _corda.labels(film, [*_OF_A_SUMMARY, *more])
        sample.info = _info(sweep, sample, film, facts, _summary(film.plan(), facts, arrays))
        sample.arrays = {name: arrays[name] for name in ("times", *sweep.labels)}
        _draw(film, pictures, sample)
    except Error as error:
        if error.code not in REFUSALS:
            if error.code not in (130, 143):
                error.args = (f"sample {sample.key}: {error}",)
            raise
        sample.failure = (error.code, str(error))
        sample.info = sample.arrays = sample.pictures = None
    return sample


def _draw(film, pictures, sample):
    sample.pictures = {}
    if pictures == "none":
        return
    if pictures == "npz":
        sample.arrays["frames"] = _corda.frames(film)
    elif pictures == "mp4":
        (sample.pictures[".mp4"],) = _corda.files(film, f"{sample.key}.mp4")
    else:
        files = _corda.files(film, "%06d.png")
        sample.pictures = {f".{k:06}.png": file for k, file in enumerate(files)}


def _info(sweep, sample, film, facts, summary):
    width, height = film.size()
    numerator, denominator = film.fps()
    camera = film.camera()
    return {"schema": 1,
            "corda": __version__,
            "sample": sample.number,
            "key": sample.key,
            "seed": sweep.seed,
            "split": sample.split or None,
            "parameters": sample.parameters,
            "frames": film.frame_count(),
            "fps": f"{numerator}/{denominator}" if denominator != 1 else str(numerator),
            "width": width,
            "height": height,
            "camera": {"center": list(camera["center"]), "height": camera["height"]},
            "px_per_m": height / camera["height"],
            "method": facts["method"],
            "error_estimate_m": summary["error_estimate_m"],
            "error_estimate_px": summary["error_estimate_px"],
            "horizon_s": summary["horizon_s"],
            "summary": {name: summary[name] for name in sweep.summary}}


def _summary(plan, facts, arrays):
    """All columns of the summary: section "Summary columns" of src/corda/python/README.md has the formulas."""
    velocities = arrays["velocities"]
    tensions = np.abs(arrays["tensions"][~np.isnan(arrays["tensions"])])
    speeds = np.sqrt(velocities[..., 0] * velocities[..., 0] + velocities[..., 1] * velocities[..., 1])
    period_s, angle_max_deg = None, None
    if facts["pin"] is not None:
        particle, pin = facts["particle"], facts["pin"]
        arm = arrays["positions"][:, particle] - arrays["positions"][:, pin]
        period_s, angle_max_deg = _swing(arrays["times"], arm, velocities[:, particle] - velocities[:, pin])
    columns = {"period_s": period_s,
               "angle_max_deg": angle_max_deg,
               "tension_max_n": float(tensions.max()) if tensions.size else None,
               "speed_max_m_s": float(speeds.max()),
               "strain_max": facts["strain_max"],
               "energy_error": facts["energy_error"],
               "error_estimate_m": plan["error_estimate_m"],
               "error_estimate_px": plan["error_estimate_px"],
               "horizon_s": plan["horizon_s"]}
    return {name: value if value is not None and math.isfinite(value) else None for name, value in columns.items()}


def _swing(times, arm, velocity):
    """The period in s, or None, and the largest angle from straight down in degrees of a particle that is at `arm` (frames, 2) m
    from its pin and moves with `velocity` (frames, 2) m/s relative to it."""
    (x, y), (vx, vy) = arm.T, velocity.T
    step = np.diff(times)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = (x * vy - y * vx) / (x * x + y * y)
    angle = angle_of(-y, x)
    at = np.flatnonzero((rate[:-1] * rate[1:] < 0.0) & (np.abs(np.diff(angle)) < 0.5 * np.pi))
    value, slope = _cubic(angle[at], step[at] * rate[at], angle[at + 1], step[at] * rate[at + 1])
    largest = float(np.abs(np.concatenate([angle, value(_root(slope, len(at)))])).max())
    _, period_s, _ = _corda.swing(times, arm, velocity)
    return period_s, largest * (180.0 / np.pi)


def angle_of(x, y):
    """The angles of vectors from the x axis in rad, -pi .. pi; 0 for the zero vector.

    By arithmetic and square roots alone, so that they have the same bits with every C library and CPU: t = tan(a / 4) from the
    half-angle formula tan(a / 2) = sin a / (1 + cos a), taken twice, then 25 terms of a = 4 arctan t.
    """
    radius = np.sqrt(x * x + y * y)
    t = y / np.where(radius > 0.0, radius + np.abs(x), 1.0)
    t = t / (1.0 + np.sqrt(1.0 + t * t))
    total = np.zeros_like(t)
    for k in range(24, -1, -1):
        total = 1.0 / (2 * k + 1) - total * t * t
    angle = 4.0 * t * total
    return np.where(x < 0.0, np.where(y < 0.0, -np.pi, np.pi) - angle, angle)
