"""Tables and plots of the measurements that benchmark_study prints: one function per chapter, from its JSON to a Chapter."""
import bisect
import os

from matplotlib.figure import Figure

from page import ROOT, Chapter, Part, Picture, number_text, paragraph, processor, table, table_text

ACCURACIES = (1e-3, 1e-4, 1e-6, 1e-8, 1e-9, 1e-12)
COLOURS = {"exact": "#d55e00", "rattle, order 2": "#56b4e9", "rattle, order 4": "#0072b2", "rattle, order 6": "#009e73",
           "rattle, order 8": "#6a3d9a", "relaxation, reach 1, sweeps 1": "#e69f00"}
CONTEXT = "#bbbbbb"
MARKERS = "os^Dv<>P"


def new_axes(x, y, log=True, size=(9, 5.6)):
    """A figure and its axes, with titles of the axes."""
    figure = Figure(figsize=size)
    axes = figure.subplots()
    axes.set(xlabel=x, ylabel=y)
    if log:
        axes.set(xscale="log", yscale="log")
    axes.grid(True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    return figure, axes


def add_legend(axes):
    """Names the lines above the axes, where they hide nothing."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=9, ncol=3, loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False)


def setting(data):
    """What measured a chapter."""
    rows = [["Processor", processor()], ["Usable cores", str(len(os.sched_getaffinity(0)))], ["Compiler", data["compiler"]],
            ["Build", data["build"]], ["Corda", data["corda"]], ["Times", data["times"]]]
    return Part(f"{data['chapter']}_setting", "Setting", table_text(["What", "Value"], rows))


def truth_text(problem):
    """What the runs on a problem are compared with."""
    text = f"{problem['title']}. The truth is {problem['truth']}."
    if problem["truth_of_exact"]:
        text += (f" Method exact itself is compared with {problem['truth_of_exact']}. The two differ by "
                 f"{number_text(problem['disagreement_over_length'])} L at most (RMS).")
    if problem["horizon_s"] is not None:
        text += (f" The motion is chaotic: after {number_text(problem['horizon_s'])} s two tight runs differ by more than "
                 f"{number_text(problem['horizon_difference_over_length'])} L, and later frames are not compared.")
    return text


def cheapest_within(runs, error):
    """The run that takes least time among those whose RMS error is at most `error`; None if there is none."""
    good = [run for run in runs if run.get("error_rms_over_length") is not None and run["error_rms_over_length"] <= error]
    return min(good, key=lambda run: run["ms_per_simulated_s"], default=None)


SPEED_COLUMNS = [("method", "series"), ("step [s] or tolerance", "parameter"), ("RMS error / L", "error_rms_over_length"),
                 ("ms per simulated second", "ms_per_simulated_s"), ("least", "ms_least"), ("largest", "ms_largest")]


def speed_plot(problem):
    """Time against error of every series; relaxation with other bars and sweeps is grey."""
    figure, axes = new_axes("RMS error / L", "ms per simulated second")
    series = {}
    for run in problem["runs"]:
        if run.get("error_rms_over_length"):  # a failed run has none, and an error of 0 no place on the axis
            series.setdefault(run["series"], []).append(run)
    for name in sorted(series, key=lambda name: name in COLOURS):
        runs = series[name]
        times = [run["ms_per_simulated_s"] for run in runs]
        spread = [[time - run["ms_least"] for time, run in zip(times, runs)],
                  [run["ms_largest"] - time for time, run in zip(times, runs)]]
        is_context = name not in COLOURS
        axes.errorbar([run["error_rms_over_length"] for run in runs], times, yerr=spread, marker="o",
                      color=COLOURS.get(name, CONTEXT), linewidth=0.8 if is_context else 1.6,
                      markersize=2 if is_context else 4, label=None if is_context else name)
    if any(name not in COLOURS for name in series):
        axes.plot([], [], color=CONTEXT, linewidth=0.8, label="relaxation, other reaches and sweeps")
    add_legend(axes)
    return figure


def speed(data):
    """Speed against error."""
    parts, pictures = [setting(data)], []
    for problem in data["problems"]:
        name = problem["id"]
        fastest = [{**(cheapest_within(problem["runs"], goal) or {"series": "none"}), "goal": goal} for goal in ACCURACIES]
        parts.append(table(f"fastest_{name}", f"Fastest at each accuracy: {problem['title']}",
                           [("RMS error / L at most", "goal"), *SPEED_COLUMNS], fastest, truth_text(problem)))
        parts.append(table(f"speed_{name}", f"All runs: {problem['title']}",
                           [*SPEED_COLUMNS[:2], ("largest error / L", "error_largest_over_length"), SPEED_COLUMNS[2],
                            ("largest strain", "strain_largest"), ("energy error / (m g L)", "energy_error_over_mgl"),
                            *SPEED_COLUMNS[3:], ("steps", "steps")], problem["runs"],
                           "Errors are the largest over all frames: of the distance of one particle from the truth, and of the "
                           "root mean square of the distances of all particles."))
        pictures.append(Picture(f"speed_{name}.png", speed_plot(problem),
                                f"{problem['title']}. Each point is one run: the RMS position error over the length L, and the "
                                "time per simulated second on one thread. Lower left is better. Bars span the fastest and the "
                                "slowest repeat."))
    return Chapter("Speed against error", parts, pictures)


def accuracy(data):
    """The largest error and time of each reference, quantity and method, and every number."""
    largest = {}
    for row in data["rows"]:
        case = f"{row['reference']} {row['subject']} ({row['quantity']})"
        if row.get("failure"):
            largest[case, row["method"], row["case"]] = {"case": case, "method": row["method"], "failure": row["failure"]}
            continue
        kept = largest.setdefault((case, row["method"]), {"case": case, "method": row["method"]})
        for key in ("error", "ms_per_simulated_s"):
            kept[key] = max(kept.get(key, row[key]), row[key])
    every = table("reference_numbers", "Every reference number",
                  [("reference", "reference"), ("case", "case"), ("compared", "quantity"), ("method", "method"), ("error", "error"),
                   ("bound", "bound"), ("wall time [ms]", "wall_ms"), ("ms per simulated second", "ms_per_simulated_s")],
                  data["rows"],
                  "Of method auto, the bound is its error estimate for this run; of the others, that of tests/accuracy.")
    short = table("accuracy", "Accuracy against published numbers",
                  [("case", "case"), ("method", "method"), ("largest error", "error"),
                   ("ms per simulated second, at most", "ms_per_simulated_s")], list(largest.values()))
    return Chapter("Reference numbers", [setting(data), short, every], [])


def bars_plot(rows, key, title):
    """A figure of 40 particles, one sweep per step, over the reach of the bars."""
    figure, axes = new_axes("reach of the bars", title, log=False)
    axes.set_yscale("log")
    for marker, mass_kg in zip(MARKERS, sorted({row["mass_kg"] for row in rows})):
        shown = [row for row in rows if row["mass_kg"] == mass_kg and row["sweeps"] == 1 and key in row]
        axes.plot([row["reach"] for row in shown], [row[key] for row in shown], marker=marker, label=f"{mass_kg:g} kg, one sweep")
    add_legend(axes)
    return figure


def findings(data):
    """The source report's start and method, compared with a true rope and a rigid rod."""
    light, heavy = data["masses_under_gravity_kg"]
    about = ("The report's start and method: bars of reach 7, one sweep per step, a force of 9.8 N per particle. They are "
             "compared with the motion of a true rope, by method exact, and with that of a rigid rod, in closed form. Mass "
             "matters because the force is the same for every mass. Under gravity, which is proportional to mass, the motions "
             f"of {light:g} kg and {heavy:g} kg differ by {number_text(data['difference_under_gravity_over_length'])} L.")
    swings = [("particles", "particles"), ("mass [kg]", "mass_kg"), ("sweeps", "sweeps"), ("reach", "reach"), ("bars", "bars"),
              ("largest strain", "strain_largest"), ("RMS error / L, true rope", "rope_error_rms_over_length"),
              ("RMS error / L, rigid rod", "rod_error_rms_over_length"), ("energy error / (m g L)", "energy_error_over_mgl"),
              ("largest speed of the tip [m/s]", "tip_speed_m_s")]
    note = ("Two periods of the rigid rod from the report's start, 60 steps per second, a force of (0, -9.8) N per particle. "
            "With reach 7, each particle has bars to the next 1, 2, ..., 7 particles.")
    parts = [
        Part("findings", "", paragraph(about)), setting(data),
        table("report_rates", "Update rates of the report and of this machine",
              [("particles", "particles"), ("bars", "bars"), ("report: updates per second", "report_updates_per_s"),
               ("here: updates per second", "updates_per_s")], data["rates"],
              "Here on one core and without drawing; the report's machine also drew the rope."),
        table("bars", "Quality over bars, sweeps and mass", swings, data["bars"], note),
        table("particles", "Quality over the number of particles", swings, data["sizes"], note),
        table("settling", "Time to settle to the vertical",
              [("delta per step", "delta"), ("step [s]", "step_s"), ("drag [1/s]", "drag_1_s"),
               ("relaxation, reach 7 [s]", "relaxation_settles_s"), ("true rope with that drag [s]", "rope_settles_s")],
              data["settling"],
              "From then on, no particle is farther than a hundredth of the length from the vertical; empty if that "
              f"takes more than {data['watched_s']:g} s. delta acts per step: half the step doubles the drag.")]
    caption = (" of 40 particles over the reach of the bars. With reach 7, each particle has bars to the next 1, 2, ..., 7 "
               "particles. One sweep per step.")
    pictures = [
        Picture("bars_rope_error.png", bars_plot(data["bars"], "rope_error_rms_over_length", "RMS error / L from the true rope"),
                "Distance from the true rope, in lengths (RMS, largest over the frames)," + caption),
        Picture("bars_strain.png", bars_plot(data["bars"], "strain_largest", "largest strain"),
                "Largest strain of a link" + caption)]
    return Chapter("The source report's findings", parts, pictures)


def hard_cases(data):
    """Every hard case with its outcome."""
    words = {True: "yes", False: "no", None: "not run"}
    outcomes = [case["passed"] for case in data["cases"]]
    about = (f"Of {len(outcomes)} hard cases, {outcomes.count(True)} passed, {outcomes.count(False)} failed and "
             f"{outcomes.count(None)} were not run.")
    rows = [{**case, "passed": words[case["passed"]]} for case in data["cases"]]
    cases = table("hard_cases", "Every hard case",
                  [("case", "case"), ("method", "method"), ("passes if", "criterion"), ("measured", "measured"),
                   ("passed", "passed")], rows,
                  "An energy error is a fraction of the total weight times the length.")
    return Chapter("Hard cases", [Part("hard_cases_passed", "", about), setting(data), cases], [])


def code_lines(path):
    """Lines of a source file with code on them."""
    lines = [line.strip() for line in (ROOT / path).read_text(encoding="utf-8").splitlines()]
    return sum(1 for line in lines if line and not line.startswith("//"))


def lines_table():
    """How much code XPBD and a rigid chain by `exact` take."""
    exact = [f"src/corda/sim/exact/{name}.{ending}" for name in ("chain_dynamics", "chain_series", "dop853", "exact")
             for ending in ("hpp", "cpp")]
    exact += ["src/corda/sim/exact/series_terms.hpp", "src/corda/sim/chain_tensions.hpp"]
    xpbd = "tests/benchmark/peers/xpbd.hpp"
    return Part("challenge_lines", "Simplicity: lines of code", table_text(
        ["method", "lines", "of which files"],
        [["XPBD", code_lines(xpbd), xpbd],
         ["Corda, exact", sum(map(code_lines, exact)), "src/corda/sim/exact, what a rigid chain needs of it"]]))


def challenge_plot(pendulum):
    """The last compared poses, and the path that the free end truly takes."""
    figure, axes = new_axes("x [m]", "y [m]", log=False, size=(7, 5))
    axes.plot(*zip(*pendulum["true_path_of_the_end_m"]), color=CONTEXT, linewidth=1, label="truth, path of the end")
    xpbd = next(run for run in pendulum["runs"] if run["method"] == "XPBD")
    exact = next(run for run in pendulum["runs"] if run["method"] != "XPBD")
    axes.plot(*zip(*xpbd["last_pose_m"]), "o-", color="#d55e00", markersize=4, label=f"XPBD, {xpbd['setting']}")
    axes.plot(*zip(*exact["last_pose_m"]), "o-", color="#009e73", markersize=4, label=f"exact, {exact['setting']}")
    axes.plot(*zip(*pendulum["true_last_pose_m"]), "k.", markersize=4, label="truth")
    axes.set_aspect("equal", adjustable="datalim")
    add_legend(axes)
    return figure


def challenge(data):
    """XPBD and `exact` on four pendulums: errors and times, and the times at equal error."""
    rows, ratios, pictures = [], [], []
    for pendulum in data["pendulums"]:
        runs = [{**run, "pendulum": pendulum["pendulum"], "compared_s": pendulum["compared_s"]} for run in pendulum["runs"]]
        rows += runs
        exact = [run for run in runs if run["method"] != "XPBD"]
        for run in runs[:len(runs) - len(exact)]:
            best = next((other for other in exact if other["error_m"] <= run["error_m"]), None)
            if best:
                ratios.append({**run, "tolerance": best["setting"], "exact_error_m": best["error_m"],
                               "ratio": run["us_per_frame"] / best["us_per_frame"]})
        pictures.append(Picture(f"challenge_{pendulum['id']}.png", challenge_plot(pendulum),
                                f"{pendulum['pendulum']} after {pendulum['compared_s']:g} s"))
    parts = [
        table("challenge", "XPBD and Corda on four pendulums",
              [("pendulum", "pendulum"), ("method", "method"), ("setting", "setting"), ("compared for [s]", "compared_s"),
               ("largest error [m]", "error_m"), ("energy after 60 s / (M g L)", "energy_error_over_mgl"),
               ("largest strain", "strain_largest"), ("CPU time per frame [us]", "us_per_frame")], rows),
        table("challenge_ratios", "Time at equal error",
              [("pendulum", "pendulum"), ("XPBD", "setting"), ("its error [m]", "error_m"),
               ("exact, at most this error", "tolerance"), ("its error [m]", "exact_error_m"),
               ("XPBD's time over exact's", "ratio")], ratios),
        lines_table(), setting(data)]
    return Chapter("The pendulum challenge", parts, pictures)


def horizons(data):
    """When the true error passes its estimate, over the claimed horizon."""
    figure, axes = new_axes("claimed horizon [s]", "observed / claimed", log=False)
    axes.set_xscale("log")
    rows = []
    for marker, family in zip(MARKERS, data["families"]):
        points = family["claimed_s_and_observed_over_claimed"]
        ratios = sorted(ratio for _, ratio in points)
        before = bisect.bisect_right(ratios, 1.0)
        row = {**family, "before": before, "after": len(ratios) - before}
        for key, share in (("least", 0.0), ("tenth", 0.1), ("median", 0.5), ("nine_tenths", 0.9), ("largest", 1.0)):
            row[key] = ratios[int(share * (len(ratios) - 1))] if ratios else None
        rows.append(row)
        if points:
            axes.plot(*zip(*points), marker, markersize=4, label=family["ropes"])
    add_legend(axes)
    unjudged = sum(family["not_judged"] for family in data["families"])
    observed = table("horizons", "Predicted and observed horizons",
                     [("ropes", "ropes"), ("scenes", "scenes"), ("passed their estimate after the horizon", "after"),
                      ("before it", "before"), ("no horizon", "without_horizon"), ("not passed at the end", "not_passed"),
                      ("observed / claimed: least", "least"), ("a tenth", "tenth"), ("median", "median"),
                      ("nine tenths", "nine_tenths"), ("largest", "largest")], rows,
                     f"{unjudged} more scenes could not be judged." if unjudged else "")
    caption = "The time at which the true error passes the estimate, over the claimed horizon."
    return Chapter("Predicted and observed horizons", [observed, setting(data)], [Picture("horizons.png", figure, caption)])


CHAPTERS = {"speed": speed, "findings": findings, "accuracy": accuracy, "hard_cases": hard_cases, "challenge": challenge,
            "horizons": horizons}
