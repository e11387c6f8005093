"""Plots, against the textbook: the numbers of section 4 of src/corda/sim/README.md (R2 to R4) and closed forms."""

import math

import matplotlib
import numpy as np
import pytest

import corda

matplotlib.use("agg")

import corda.plot  # noqa: E402
from corda import _theory  # noqa: E402
from corda._motion import motion_of  # noqa: E402


@pytest.fixture(autouse=True)
def closed_figures():
    yield
    import matplotlib.pyplot

    matplotlib.pyplot.close("all")


T0 = 2.006066680710647  # s: small swings of a pendulum of 1 m


def film(toml, **settings):
    return corda.Film(text="schema = 1\n" + toml, **settings)


def pendulum(world="duration = 1.0", fps=200):
    """2 kg on a link of 1 m, released from 60 degrees."""
    return film(f"[world]\n{world}\n[[rope]]\nhang = {{ links = 1, length = 1.0, angle_deg = 60.0, from = [3.0, 4.0] }}\n"
                f"mass = 2.0\n[solver]\nmethod = \"exact\"\n[video]\nsize = [320, 180]\nfps = {fps}\n")


def curve(ax, k=0):
    return np.asarray(ax.get_lines()[k].get_data())


def names(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()] if ax.get_legend() else []


@pytest.mark.parametrize("angle_deg, ratio", [
    (10, 1.0019071881432166), (45, 1.0399733431968039), (90, 1.1803405990160962), (120, 1.3728805006183502),
    (150, 1.762203729503756), (170, 2.4393627196738841), (179, 3.9010651603890857), (179.99, 6.832737338014762)])
def test_the_period_of_a_pendulum_is_the_elliptic_integral(angle_deg, ratio):
    # Measured 9e-16, at 179.99 degrees 6e-14, where the cosine of half the angle has lost digits.
    period = _theory.pendulum_period(math.sqrt(9.81), angle_deg)
    assert period == pytest.approx(ratio * T0, rel=3e-15 if angle_deg < 179.5 else 2e-13)


@pytest.mark.parametrize("particles, period", [(2, 2.161534078824117), (5, 2.027698701742412), (10, 1.981078706687632),
                                               (20, 1.957352357296146), (50, 1.942977482042899)])
def test_the_period_of_a_rod_is_that_of_its_inertia(particles, period):
    omega = _theory.rod_omega(particles, 1.0 / particles, 9.81)
    assert _theory.pendulum_period(omega, 90.0) == pytest.approx(period, rel=1e-15)  # measured 2e-16


@pytest.mark.parametrize("links, omega", [(5, 3.5955018679142), (10, 3.6766206576178), (20, 3.7202051499303), (50, 3.7474350221806)])
def test_the_frequency_of_a_hanging_rope_is_a_zero_of_a_laguerre_polynomial(links, omega):
    assert _theory.rope_omega(links, 1.0 / links, 9.81) == pytest.approx(omega, rel=4e-14)  # measured 1.4e-14, the digits of R4


def test_the_frequency_of_a_long_rope_is_that_of_a_chain_without_links():
    assert _theory.rope_omega(1, 1.0, 9.81) == pytest.approx(math.sqrt(9.81), rel=1e-15)
    # The difference falls with 1 / links: measured 2.5e-5.
    assert _theory.rope_omega(10_000, 1e-4, 9.81) == pytest.approx(3.766067388420843, rel=3e-5)


ROPE = "[[rope]]\nhang = { links = 10, length = 1.0, angle_deg = 5.0 }\n"


@pytest.mark.parametrize("toml, angle_deg, period", [
    ("[[rope]]\nhang = { links = 1, length = 1.0, angle_deg = 5.0 }\n", 90.0, 1.1803405990160962 * T0),
    (ROPE, 5.0, 2 * math.pi / 3.6766206576178),
    (ROPE + "[solver]\nmethod = \"relaxation\"\nforce = [0.0, -9.81]\nreach = 7\n", 90.0, 1.981078706687632),
    (ROPE + "mass = 1e-4\npayload = 1.0\n", 90.0, 1.1803405990160962 * T0),
    (ROPE + "payload = 1.0\n", 5.0, None), (ROPE + "compliance = 1e-3\n", 5.0, None), (ROPE + "pinned = [0, 1]\n", 5.0, None),
    (ROPE + "mass = [1,1,1,1,1,1,1,1,1,1,2]\n", 5.0, None), (ROPE + "[world]\ndrag = 0.1\n", 5.0, None),
    (ROPE + "[world]\ngravity = [1.0, -9.0]\n", 5.0, None), (ROPE + "[world]\ngravity = 0.0\n", 5.0, None),
    (ROPE + "cut = [{ link = 4, t = 0.01 }]\n", 5.0, None),
    (ROPE + "moves = [{ pin = 0, waves = [{ amplitude = [0.1, 0.0], frequency = 1.0 }] }]\n", 5.0, None),
    (ROPE + ROPE.replace("links = 10", "links = 1"), 5.0, 2 * math.pi / 3.6766206576178)])
def test_theory_knows_pendulum_rod_and_rope(toml, angle_deg, period):
    motion = motion_of(film(toml, duration=0.05, settings={"video.size": [320, 180]}))
    found = _theory.period_of(motion, angle_deg)
    assert (found is None) == (period is None)
    if period:
        assert found.seconds == pytest.approx(period, rel=1e-13)
    if len(motion.bodies) > 1:
        found = _theory.period_of(motion, angle_deg, motion.bodies[1])
        assert found.seconds == pytest.approx(1.0004761724859867 * T0, rel=1e-12)


def test_angle_shows_the_period_beside_the_theory():
    shown = pendulum("duration = 12.0")
    ax = corda.plot.angle(shown)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("t (s)", "angle (°)")
    times, degrees = curve(ax)
    assert times[0] == 0.0 and degrees[0] == pytest.approx(60.0, abs=1e-9)
    swing = motion_of(shown).tracks[0].swing
    assert len(swing.passes) == 11
    assert swing.period == pytest.approx(1.0731820071493645 * T0, abs=1e-11)  # measured 2e-12
    assert swing.amplitude_deg == pytest.approx(60.0, abs=1e-9)  # measured 2e-11
    # The circles of the theory are where the curve passes below the pin.
    passes, level = curve(ax, 1)
    assert names(ax) == ["theory"] and len(passes) == 11 and np.all(level == 0.0)
    assert np.interp(passes, times, degrees) == pytest.approx(np.zeros(11), abs=1e-4)  # measured 4e-6


def test_a_rope_in_its_first_mode_has_the_period_of_the_theory():
    links, omega = 10, 3.6766206576178
    # The eigenvector of the chain's equations to R4's frequency: tensions are the weights below.
    below = np.arange(links, 0, -1.0)
    stiffness = np.diag(below + np.append(below[1:], 0.0)) - np.diag(below[1:], 1) - np.diag(below[1:], -1)
    values, vectors = np.linalg.eigh(stiffness * 9.81 * links)
    assert math.sqrt(values[0]) == pytest.approx(omega, rel=1e-12)
    slopes = np.diff(np.append(0.0, vectors[:, 0]))
    slopes *= 1e-3 / np.abs(slopes).max()
    points = np.cumsum(np.stack([slopes, -np.sqrt(1 - slopes**2)], axis=1) / links, axis=0)
    shown = film("[world]\nduration = 8.0\n[[rope]]\npoints = " + str([[0.0, 0.0], *points.tolist()]) +
                 "\n[solver]\nmethod = \"exact\"\n[video]\nsize = [320, 180]\n")
    motion = motion_of(shown)
    swing = motion.tracks[0].swing
    theory = _theory.period_of(motion, swing.amplitude_deg)
    assert theory.model == "a hanging rope of 10 links at small angles"
    # Finite angles lengthen it by a share of about the square of 1e-3: measured 1e-7.
    assert swing.period == pytest.approx(theory.seconds, rel=1e-6)


def test_energy_and_tension_are_those_of_the_textbook():
    shown = pendulum()
    ax = corda.plot.energy(shown)
    assert ax.get_ylabel() == "energy (J)" and names(ax) == ["kinetic", "weight", "total"]
    fall = 4.0 - 0.5 - motion_of(shown).tracks[0].position[:, 1] - motion_of(shown).origin[1]
    assert curve(ax, 0)[1] == pytest.approx(2.0 * 9.81 * fall, abs=1e-6)  # m g h
    assert curve(ax, 1)[1] == pytest.approx(-2.0 * 9.81 * fall, abs=1e-6)
    assert curve(ax, 2)[1] == pytest.approx(0.0 * fall, abs=1e-6)
    ax = corda.plot.tension(shown)
    assert ax.get_ylabel() == "largest tension (N)" and names(ax) == ["at rest"]
    # m g cos(angle) + m v^2 / L, with v^2 = 2 g h
    assert curve(ax)[1] == pytest.approx(2.0 * 9.81 * (0.5 + fall) + 2.0 * 2.0 * 9.81 * fall, abs=1e-5)
    assert curve(ax, 1)[1][0] == pytest.approx(2.0 * 9.81)


def test_tension_along_a_hanging_rope_is_the_weight_below():
    shown = film("[world]\nduration = 0.1\n[[rope]]\nhang = { links = 5, length = 1.0, angle_deg = 0.0 }\nmass = 2.0\n"
                 "payload = 3.0\n[video]\nsize = [320, 180]\n")
    ax = corda.plot.tension_along(shown)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("distance along the rope (m)", "tension (N)")
    expected = 9.81 * np.array([13.0, 11.0, 9.0, 7.0, 5.0])
    assert curve(ax) == pytest.approx(np.array([[0.1, 0.3, 0.5, 0.7, 0.9], expected]), rel=1e-9)
    assert curve(ax, 1)[1] == pytest.approx(expected)


def test_phase_is_angle_and_rate_or_x_and_its_rate():
    ax = corda.plot.phase(pendulum("duration = 1.0", 10))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("angle (rad)", "angular velocity (rad/s)")
    angle, rate = curve(ax)
    assert len(angle) == 81 and angle[0] == pytest.approx(math.pi / 3)  # eight points per frame
    # rate^2 = 2 g / L (cos(angle) - cos(60 degrees)): measured 3e-3 with ten frames per second
    assert rate**2 == pytest.approx(2 * 9.81 * (np.cos(angle) - 0.5), abs=0.01)
    # The end of this double pendulum passes near its pin.
    near = film("[world]\nduration = 0.1\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0], [0.05, 0.0]]\n")
    ax = corda.plot.phase(near)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (mm)", "vx (mm/s)")
    assert curve(ax)[0, 0] == pytest.approx(50.0, abs=1e-9)
    with pytest.raises(corda.Error, match="corda.plot.angle: no rope of the scene turns about one pin") as raised:
        corda.plot.angle(near)
    assert raised.value.code == 2


def test_tip_is_a_smooth_path_with_equal_scales():
    ax = corda.plot.tip(pendulum("duration = 1.0", 10))
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_aspect()) == ("x (m)", "y (m)", 1.0)
    x, y = curve(ax)
    assert len(x) == 81 and (x[0], y[0]) == pytest.approx((3.0 + math.sqrt(0.75), 3.5))
    assert np.hypot(x - 3.0, y - 4.0) == pytest.approx(np.ones(81), abs=3e-4)  # measured 1.2e-4, with ten frames per second


def test_turns_are_counted_from_any_number_of_frames():
    # v^2 = 100 > 5 g L: it loops.
    toml = ("[world]\nduration = 3.0\n[[rope]]\npoints = [[0.0, 0.0], [0.0, -1.0]]\nvelocity = [10.0, 0.0]\n[solver]\n"
            "method = \"exact\"\n[video]\nfps = ")
    many, few = (motion_of(film(f"{toml}{fps}\n")).tracks[0].angle[0] for fps in (300, 5))
    assert np.all(np.diff(many) > 0.0) and many[-1] > 6 * math.pi
    assert len(few) == 16 and few[-1] == pytest.approx(many[-1], abs=1e-6)  # up to 2 rad between frames


def test_divergence_is_the_distance_of_two_tips():
    shown = film("[world]\nduration = 1.0\n[[rope]]\nhang = { links = 2, length = 1.0, angle_deg = 90.0 }\n"
                 "copies = { count = 2, angle_deg = 0.001 }\n[video]\nsize = [320, 180]\n")
    ax = corda.plot.divergence(shown)
    assert ax.get_yscale() == "log" and ax.get_ylabel() == "distance of the tips (m)"
    assert curve(ax)[1][0] == pytest.approx(math.radians(0.001), rel=1e-6)
    positions = shown.positions
    assert curve(ax)[1][: len(shown)] == pytest.approx(np.hypot(*(positions[:, 2] - positions[:, 5]).T), rel=1e-9)
    with pytest.raises(corda.Error, match="give it two"):
        corda.plot.divergence(pendulum())


def test_strain_and_elastic_energy_of_a_spring():
    # 1 kg on a spring of 100 N/m, released at rest length: it stretches by up to 2 m g / k.
    shown = film("[world]\nduration = 1.0\n[[rope]]\npoints = [[0.0, 0.0], [0.0, -1.0]]\ncompliance = 0.01\n[video]\nfps = 500\n")
    lowest = 2 * 9.81 / 100.0
    ax = corda.plot.strain(shown)
    assert ax.get_ylabel() == "largest strain"
    assert curve(ax)[1].max() == pytest.approx(lowest, abs=1e-4)
    ax = corda.plot.energy(shown)
    assert names(ax) == ["kinetic", "weight", "elastic", "total"]
    assert curve(ax, 2)[1].max() == pytest.approx(50.0 * lowest**2, abs=1e-3)
    assert np.abs(curve(ax, 3)[1]).max() < 1e-4


def test_bodies_are_told_apart_by_names_and_colours():
    rope = "[[rope]]\nhang = { links = 1, length = 2.0, angle_deg = 20 }\n"
    shown = film("[world]\nduration = 0.1\n" + rope + "label = \"8 kg\"\ncopies = { count = 2, angle_deg = 1 }\n" + rope +
                 "label = \"8 kg 2\"\n" + rope)
    ax = corda.plot.angle(shown)
    assert names(ax) == ["8 kg", "8 kg 2", "8 kg 2 2", "rope 3"]
    assert [body.key for body in motion_of(shown).bodies] == ["8_kg", "8_kg_2", "8_kg_2_2", "rope_3"]
    assert len({line.get_color() for line in ax.get_lines()}) == 4
    same = film("[world]\nduration = 0.1\n" + rope + "label = \"a\"\n" + rope + "label = \"a\"\n")
    assert names(corda.plot.tip(same)) == ["a", "a 2"]


@pytest.mark.parametrize("labels, shown", [
    (("_a", "_b"), ["_a", "_b"]),  # matplotlib leaves out names that begin so
    (("_a", "b"), ["_a", "b"]),
    ((r"5 $\foo$", "$x^2$"), [r"5 \$\foo\$", r"\$x^2\$"]),  # an invalid formula and a valid one
    (("5 $", r"\$ 5 $$"), [r"5 \$", r"\\$ 5 \$\$"])])
def test_labels_are_shown_as_they_are(labels, shown):
    rope = "[[rope]]\nhang = { links = 1, length = 2.0, angle_deg = 20 }\nlabel = '%s'\n"
    ropes = film("[world]\nduration = 0.1\n" + "".join(rope % label for label in labels))
    for function in (corda.plot.angle, corda.plot.tip):
        ax = function(ropes)
        assert names(ax) == shown
        ax.figure.canvas.draw()
        for text, label in zip(ax.get_legend().get_texts(), labels):
            # What is drawn has the width of the label without formulas.
            plain = ax.text(0, 0, label, parse_math=False, fontsize=text.get_fontsize())
            assert text.get_window_extent().width == pytest.approx(plain.get_window_extent().width, abs=1.0)
        legend = [handle.get_color() for handle in ax.get_legend().get_lines()]
        assert legend == [line.get_color() for line in ax.get_lines()[: len(labels)]]


def test_curves_have_the_colours_of_the_scene_on_paper():
    rope = "[[rope]]\nhang = { links = 1, length = 2.0, angle_deg = 20 }\n"

    def colors(toml, style=""):
        ax = corda.plot.angle(film(f"[world]\nduration = 0.1\n{toml}{style}"))
        return [line.get_color() for line in ax.get_lines()[: toml.count("[[rope]]")]]

    assert colors(rope + "color = \"#123456\"\n" + rope) == ["#123456", "#0072b2"]
    assert colors(rope, "[style]\npalette = [\"#123456\"]\n") == ["#123456"]
    copies = rope + "copies = { count = 3, angle_deg = 5.0 }\n[style]\npalette = [\"#000000\", \"#204060\"]\n"
    ax = corda.plot.angle(film(f"[world]\nduration = 0.1\n{copies}"))
    assert [line.get_color() for line in ax.get_lines()[:3]] == ["#000000", "#102030", "#204060"]
    # White, two of one colour, and colours that tell speed: the colours of plots.
    assert colors(rope + "color = \"white\"\n") == ["#0072b2"]
    assert colors(rope + rope, "[style]\npalette = [\"#123456\"]\n") == ["#0072b2", "#d55e00"]
    assert colors(rope, "[style]\npalette = [\"#123456\"]\ncolor_by = \"speed\"\n") == ["#0072b2"]


def test_six_of_many_bodies_are_shown_with_prefixed_units():
    rope = "[[rope]]\nhang = { links = 3, length = 2.0, angle_deg = 9.0 }\nmass = 1000.0\n"
    ax = corda.plot.tension(film("[world]\nduration = 0.05\n" + 8 * rope))
    assert ax.get_ylabel() == "largest tension (kN)"
    assert names(ax) == [f"rope {k}" for k in range(6)]
    assert curve(ax)[1].max() < 100.0


def test_unknown_tensions_are_left_out():
    rope = "[[rope]]\nhang = { links = 3, length = 1.0, angle_deg = 9.0 }\n"
    shown = film("[world]\nduration = 0.1\n" + 2 * rope + "[[solver.bodies]]\nropes = [0]\nmethod = \"relaxation\"\n"
                 "[[solver.bodies]]\nropes = [1]\nmethod = \"exact\"\n")
    assert names(corda.plot.tension(shown)) == ["rope 1"]
    assert motion_of(shown).tension.body == 1
    with pytest.raises(corda.Error, match="no tension is known"):
        corda.plot.tension(film("[world]\nduration = 0.1\n" + rope + "[solver]\nmethod = \"relaxation\"\n"))


def test_words_and_numbers_are_in_the_language_of_the_scene():
    shown = pendulum()
    german = corda.Film(text="schema = 1\n[world]\nduration = 0.5\n" + ROPE, settings={"overlay.language": "de"})
    ax = corda.plot.angle(german)
    assert ax.get_ylabel() == "Winkel (°)"
    ax.figure.canvas.draw()
    assert any("," in label.get_text() for label in ax.get_xticklabels())
    assert corda.plot.angle(shown).get_ylabel() == "angle (°)"


def test_axes_can_be_given():
    from matplotlib.figure import Figure

    axes = [*Figure().subplots(2, 2).flat, Figure().subfigures(1, 2)[1].subplots()]
    shown = pendulum()
    for ax, function in zip(axes, (corda.plot.angle, corda.plot.energy, corda.plot.phase, corda.plot.tip, corda.plot.tension)):
        assert function(shown, ax) is ax and len(ax.get_lines()) > 0
