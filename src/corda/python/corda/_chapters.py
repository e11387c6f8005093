"""What the report of a scene says and shows: chapters of sentences, tables and figures."""

import dataclasses
import math
import typing

import numpy as np

from . import plot
from ._motion import first_turn, spread
from ._theory import period_of


@dataclasses.dataclass
class Table:
    """Rows of cells: numbers, texts, or None."""

    id: str  #: file name without ending
    title: str
    keys: list  #: of the columns, in CSV
    titles: list  #: for people
    rows: list
    note: str = ""


@dataclasses.dataclass
class Figure:
    """A plot, which `plot(ax)` draws, or a drawing of the film at some times."""

    id: str  #: file name without width and ending
    title: str  #: what it shows, for readers who cannot see it
    caption: str
    plot: typing.Callable = None
    times: list = None
    data: str = ""  #: the file with its numbers
    height_per_width: float = 0.62
    is_small: bool = False  #: stands beside its small neighbours on the page
    is_on_white: bool = True  #: a dark page shows it inverted


@dataclasses.dataclass
class Chapter:
    """One subject. `summary`: what the figures show, in a sentence; the page opens with those."""

    title: str
    summary: str = ""
    paragraphs: list = dataclasses.field(default_factory=list)
    tables: list = dataclasses.field(default_factory=list)
    figures: list = dataclasses.field(default_factory=list)


# Words.


def short_number(value):
    """Three significant digits, such as "1.23e-5" or "1230"; whole numbers below a million in full."""
    if math.isnan(value):
        return "NaN"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    shown = value if value == round(value) else float(f"{value:.2e}")
    if abs(shown) < 1e6 and (value == round(value) or abs(shown) >= 1e3):
        return f"{shown + 0.0:.0f}"
    digits, e, exponent = f"{value:.3g}".partition("e")
    return f"{digits}e{int(exponent)}" if e else digits


def quantity_text(value, unit):
    """ "1.23 kN": three digits and a prefix; without a unit "0.012" or "3.1e-12"."""
    if not unit:
        return short_number(value)
    title, size = plot._title("", unit, abs(value))
    return f"{short_number(value / size)} {title[2:-1]}"


def time_text(time):
    return f"{time:.4g} s"


def listed(words):
    """ "a, b and c" """
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]])) if words else ""


def bodies_text(bodies):
    """Names of bodies; of rows without labels the first and the last: "rope 0 to rope 5, net 1"."""
    parts = []
    for body in bodies:
        kind, _, number = body.name.partition(" ")
        last = parts[-1][-1].name.partition(" ") if parts else None
        is_next = (last is not None and number.isdigit() and last[2].isdigit() and kind in ("rope", "net") and last[0] == kind
                   and int(number) == int(last[2]) + 1)
        if is_next:
            parts[-1].append(body)
        else:
            parts.append([body])
    return ", ".join(part[0].name if len(part) == 1 else f"{part[0].name} to {part[-1].name}" for part in parts)


def tracked_text(motion):
    """The tracked particles: "the free ends of rope 0 to rope 5 (particle 2 of each)"."""
    ends = [track.body for track in motion.tracks if track.body.is_free_end]
    numbers = [body.tracked - body.particles.start for body in ends]
    others = [f"particle {body.tracked - body.particles.start} of {body.name} (the "
              f"{'most central' if body.is_net else 'middle one'} of its free ones)"
              for body in (track.body for track in motion.tracks) if not body.is_free_end]
    if not ends:
        return " and ".join(others)
    if len(ends) == 1:
        text = f"the free end of {ends[0].name} (particle {numbers[0]})"
    else:
        which = f"particle {numbers[0]} of each" if len(set(numbers)) == 1 else f"particles {', '.join(map(str, numbers))}"
        text = f"the free ends of {bodies_text(ends)} ({which})"
    return " and ".join([text, *others])


def left_out_text(motion):
    count = motion.moving_count - len(motion.tracks)
    return "" if count <= 0 else f" {count} more {'body is' if count == 1 else 'bodies are'} not shown."


def link_text(motion, extreme):
    body = motion.bodies[extreme.body]
    a, b = (int(end) - body.particles.start for end in body.ends[extreme.index])
    return f"link {extreme.index} of {body.name}, between its particles {a} and {b}"


# Chapters.


def _method_text(motion, plan):
    text = f"Method: {motion.solver}"
    if motion.reason is not None:
        text += f", because {motion.reason}"
    if motion.estimate is not None:
        how = ("; after that the motion cannot be predicted, and the figures show one possible motion"
               if plan["horizon_s"] is not None else ", from tighter runs")
        return f"{text}. The error estimate of the displayed positions is {motion.estimate}{how}."
    if plan["horizon_s"] is not None:
        return f"{text}. The motion cannot be predicted: the figures show one possible motion."
    return f"{text}. There is no estimate of its error."


def _largest_table(motion):
    rows = []
    for name, unit, extreme, what in (("speed", "m/s", motion.speed, "particle"), ("tension", "N", motion.tension, "link"),
                                      ("strain", "", motion.strain, "link")):
        if extreme is not None:
            rows.append([name, extreme.size, unit, extreme.time,
                         f"{what} {extreme.index} of {motion.bodies[extreme.body].name}"])
    if motion.pin_force_n is not None:
        rows.append(["force on a pin", motion.pin_force_n, "N", None, None])
    if motion.energy_error is not None:
        rows.append(["energy error", motion.energy_error, "", None, None])
    return Table("largest", "Largest figures, at frame times", ["quantity", "size", "unit", "t_s", "where"],
                 ["quantity", "size", "unit", "t [s]", "where"], rows,
                 "Links and particles are numbered from 0 within their bodies.")


def _drawings(motion, times):
    figures = []
    if len(times.strobe) > 1:
        poses = f"poses at t = {listed([f'{time:.4g}' for time in times.strobe])} s"
        end = "; the last is where the first swing ends" if times.is_swing else ""
        figures.append(Figure("strobe", f"{motion.name}, {poses}", f"Strobe: {poses}, the fainter the earlier{end}.",
                              times=times.strobe, is_on_white=motion.is_on_white))
    for number, time in enumerate(times.stills, 1):
        at = f"at t = {time_text(time)}"
        figures.append(Figure(f"still_{number}", f"{motion.name} {at}", f"The scene {at}.", times=[time],
                              is_small=len(times.stills) > 1, is_on_white=motion.is_on_white))
    return figures


def motion_chapter(motion, film, times):
    """Model, method and its error, and drawings."""
    chapter = Chapter("Motion", f"Modelled: {motion.system}; {'; '.join(motion.modelled)}. {_method_text(motion, film.plan)}")
    end = time_text(motion.times[-1])
    chapter.paragraphs.append(f"All numbers are at frame times, {motion.rate} per second: {len(motion.times)} of them, from 0 to "
                              f"{end}. Between them, curves of paths and angles are cubic polynomials that have the velocities "
                              "of the frames.")
    if motion.failure is not None:
        chapter.paragraphs.append(f"The motion ends early: {motion.failure}. The figures show the motion before that.")
        chapter.summary += f" It diverges after {end}; the figures show the motion before that."
    if motion.branched_s is not None:
        chapter.paragraphs.append(f"Before {time_text(motion.branched_s)} bars of a net lay in line, from where several motions "
                                  "were possible; the figures show one of them.")
    chapter.tables.append(_largest_table(motion))
    chapter.figures += _drawings(motion, times)
    return chapter


def path_chapter(motion, film):
    """The paths of the tracked particles."""
    chapter = Chapter("Path")
    if not motion.tracks:
        chapter.paragraphs.append("All particles are pinned: nothing moves.")
        return chapter
    speed = motion.speed
    chapter.summary = (f"The largest speed is {quantity_text(speed.size, 'm/s')} at {time_text(speed.time)} (particle "
                       f"{speed.index} of {motion.bodies[speed.body].name}).")
    origin = f" Counted from ({motion.origin[0]:g}, {motion.origin[1]:g}) m." if plot.is_far(motion) else ""
    path = np.concatenate([track.position for track in motion.tracks])
    width, height = np.maximum(np.ptp(path, axis=0), 1e-300)
    chapter.figures.append(Figure("path", "Path of the tip", f"Path of {tracked_text(motion)}.{origin}{left_out_text(motion)}",
                                  plot=lambda ax: plot.tip(film, ax), data="tip.csv",
                                  height_per_width=float(np.clip(height / width, 0.15, 1.1))))
    return chapter


def _period_text(motion, track):
    """ "The period is 2.1529 s, by 11 passages below the pin; that of a point pendulum of this amplitude is 2.1529 s." """
    swing = track.swing
    whose = f" of {track.body.name}" if len(motion.tracks) > 1 else ""
    if swing.period is None:
        return f"No period{whose} is stated: {swing.reason}."
    text = f"The period{whose} is {swing.period:.5g} s, by {len(swing.passes)} passages below the pin"
    theory = period_of(motion, swing.amplitude_deg, track.body)
    if theory is None:
        return f"{text}; this report has no theory for it."
    return f"{text}; that of {theory.model} is {theory.seconds:.5g} s."


def angle_chapter(motion, film):
    """The angles about the pins over time, and the periods, compared with theory; without a figure if one body has no pin or
    comes close to it."""
    chapter = Chapter("Angle")
    others = sum(not track.turns for track in motion.tracks)
    if others == len(motion.tracks):
        return chapter
    if others:
        chapter.summary = (f"There is no figure of the angle: the free ends of {others} of the {len(motion.tracks)} bodies do "
                           "not turn about one pin, or come near to it.")
        return chapter
    chapter.summary = " ".join(_period_text(motion, track) for track in motion.tracks)
    swing = motion.tracks[0].swing
    has_theory = len(motion.bodies) == 1 and swing.period is not None and period_of(motion, swing.amplitude_deg)
    circles = (f" Circles: passes below the pin by the period of {has_theory.model.rstrip(',')}, counted from the first."
               if has_theory else "")
    chapter.figures.append(Figure(
        "angle", "Angle over time", f"Angle of the line from the pin to {tracked_text(motion)}, from straight down, positive "
        f"towards +x.{circles}{left_out_text(motion)}", plot=lambda ax: plot.angle(film, ax), data="tip.csv"))
    return chapter


def phase_chapter(motion, film):
    """The phase portraits."""
    chapter = Chapter("Phase portrait")
    if not motion.tracks:
        return chapter
    if all(track.turns for track in motion.tracks):
        caption = (f"the angle of the line from the pin to {tracked_text(motion)}, from straight down, positive towards +x, "
                   "turns counted on, and its rate of change")
    else:
        caption = (f"the horizontal position of {tracked_text(motion)}, counted from the pin of its body or, if that has none "
                   "or several, from the start, and the horizontal velocity")
    chapter.figures.append(Figure("phase", "Phase portrait", f"Phase portrait: {caption}.{left_out_text(motion)}",
                                  plot=lambda ax: plot.phase(film, ax), data="tip.csv"))
    return chapter


def _why_energy_changes(motion):
    if motion.drag > 0.0:
        return "drag takes energy, and wind gives some" if motion.has_wind else "drag takes energy"
    if motion.has_moves:
        return "supports that move do work"
    if motion.has_events:
        return "parts that are cut or let go take energy along"
    return "the method takes energy"


def energy_chapter(motion, film):
    """Energies over time, and the energy error."""
    summary = (f"There is no energy error to tell: {_why_energy_changes(motion)}." if motion.energy_error is None else
               "The energy error, | E - E(0) | over the sum of weight times length of all bodies, or over E(0) without a "
               f"force, is at most {quantity_text(motion.energy_error, '')}.")
    elastic = ", elastic" if motion.is_elastic else ""
    caption = f"Energy of all free particles over time: kinetic, that of the weight since the start{elastic}, and their sum."
    return Chapter("Energy", summary, figures=[Figure("energy", "Energy over time", caption,
                                                      plot=lambda ax: plot.energy(film, ax), data="energy.csv")])


def _unknown_text(motion, bodies):
    """Why the tensions of some bodies are not known."""
    names = bodies_text(bodies)
    if all(not body.knows_tensions for body in bodies):
        return (f"Tensions of {names} are not known: method relaxation moves particles until bars have their lengths, without "
                "forces in them.")
    also = ", and method relaxation knows no forces in bars" if any(not body.knows_tensions for body in bodies) else ""
    return f"Tensions of {names} are not known: bars that depend on each other share them in any way{also}."


def tension_chapter(motion, film):
    """The largest tension over time, and that along the rope when it is largest of all; or why it is not known."""
    chapter = Chapter("Tension")
    unknown = motion.unknown_tensions()
    if unknown:
        chapter.paragraphs.append(_unknown_text(motion, unknown))
    largest = motion.tension
    if largest is None:
        chapter.summary = "".join(chapter.paragraphs[:1])
        return chapter
    chapter.summary = (f"The largest tension is {quantity_text(largest.size, 'N')} at {time_text(largest.time)} "
                       f"({link_text(motion, largest)}).")
    known = [track for track in motion.tracks if track.body not in unknown]
    of_each = " of each body" if len(known) > 1 else ""
    is_plain = plot._hangs_alone(motion)
    if known:
        rest = " Dashed: the largest at rest, the weight of the rope." if is_plain else ""
        chapter.figures.append(Figure(
            "tension", "Largest tension over time", f"Largest tension of a link{of_each} over time; one that pushes counts by "
            f"the size of its force.{rest}{left_out_text(motion)}", plot=lambda ax: plot.tension(film, ax), data="tension.csv"))
    body = motion.bodies[largest.body]
    if not body.is_net and len(body.rest_m) >= 3:
        rest = " Dashed: at rest." if is_plain else ""
        chapter.figures.append(Figure(
            "tension_along", "Tension along the rope", f"Tension of the links of {body.name} at {time_text(largest.time)}, when "
            f"that of one is largest, against the distance of their middles from particle 0 along the rope at rest.{rest}",
            plot=lambda ax: plot.tension_along(film, ax), data="tension_along.csv"))
    return chapter


def strain_chapter(motion, film):
    """The largest strain over time, unless it is rounding."""
    chapter = Chapter("Strain")
    largest = motion.strain
    if largest is None:
        return chapter
    if largest.size < 1e-13:
        chapter.summary = (f"The links keep their lengths: the largest strain is {quantity_text(largest.size, '')}, which is "
                           "rounding.")
        return chapter
    stretches = any(body.compliance > 0.0 for body in motion.bodies)
    whose = "" if stretches else ": an error of the method, because these links do not stretch"
    chapter.summary = (f"The largest strain, | length / rest length - 1 |, is {quantity_text(largest.size, '')} at "
                       f"{time_text(largest.time)} ({link_text(motion, largest)}){whose}.")
    if motion.tracks:
        of_each = " of each body" if len(motion.tracks) > 1 else ""
        chapter.figures.append(Figure(
            "strain", "Largest strain over time", f"Largest strain of a link{of_each} over time; a slack link of a string counts "
            f"as 0.{left_out_text(motion)}", plot=lambda ax: plot.strain(film, ax), data="strain.csv"))
    return chapter


def chapters_of(motion, film, times):
    """All chapters that have something to say."""
    chapters = [motion_chapter(motion, film, times)]
    chapters += [make(motion, film) for make in (path_chapter, angle_chapter, phase_chapter, energy_chapter, tension_chapter,
                                                 strain_chapter)]
    return [chapter for chapter in chapters if chapter.summary or chapter.paragraphs or chapter.figures]


class Times(typing.NamedTuple):
    """The times of a report's drawings, in s."""

    strobe: list
    stills: list
    is_swing: bool = False  #: the strobe shows the first swing


def drawing_times(motion, asked):
    """The times that were asked for, as far as the motion goes. Without any, the strobe has six from the start to where the
    first tracked particle first turns back, about its pin or in x, or else to the end; and the stills are five from the start to
    the end. All of these are frame times."""
    if asked:
        end = motion.times[-1] if motion.failure is not None else motion.duration
        times = sorted({time for time in asked if time <= end})
        return Times(times, times)

    turn = first_turn(motion.tracks[0].position, motion.tracks[0].pin) if motion.tracks else None
    return Times(spread(motion.times, turn, 6), spread(motion.times, None, 5), turn is not None)
