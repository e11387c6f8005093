"""The plots and tables of the peers, and the rows of README.md, from runs.csv, which tests/benchmark/peers.sh makes.

The time of a method at an error is read from the line between its two neighbouring runs in logarithms; the cheapest run
stands for looser errors. A peer's time is that of its best method.
"""
import csv
import math

from matplotlib.figure import Figure

from page import Chapter, Part, Picture, paragraph, processor

GOALS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9)
# They know no mechanics: the equations of motion that they integrate are those of equations.hpp.
SOLVERS = ("SUNDIALS", "Boost.odeint", "DOP853")
# Its rows, and no peer: the best method for a problem, chosen in hindsight, and auto, whose times include its plan.
CORDA = ("Corda", "Corda auto")
CLEARLY = 0.7  # beyond the floor of rounding, errors vary by chance
COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#b8860b", "#17a2b8", "#e377c2", "#8c564b", "#556b2f", "#ff7f0e",
           "#4b0082", "#008080", "#c71585", "#7f7f7f", "#006400", "#800000")
PROBLEMS = {
    "swing": "The source report's swing: 39 links, 10 s",
    "chain": "10 links from 90 degrees, 2 s",
    "payload": "The same with a mass of 1000 kg at the end, 2 s",
    "net": "An elastic net of 20 x 20 particles, 2 s",
    "bending": "20 links that resist bending, 2 s",
    "string": "A string's fall and snap, 3 s",
}


def read_runs(path):
    """problem -> peer -> method -> runs in the order of their parameter."""
    runs = {problem: {} for problem in PROBLEMS}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["problem"] not in runs or row["failure"] is None:
                continue
            run = {
                "peer": row["peer"],
                "version": row["version"],
                "method": row["method"],
                "setting": f"{row['method']}, {row['parameter']} {float(row['value']):g}",
                "error": float(row["error"]),
                "ms": float(row["ms_per_s"]),
                "failure": row["failure"],
            }
            runs[row["problem"]].setdefault(row["peer"], {}).setdefault(row["method"], []).append(run)
    return runs


def line_of(method_runs):
    """The runs that are clearly better than all cheaper ones, as (error, ms, run), from loose to tight."""
    line = []
    for run in sorted((run for run in method_runs if not run["failure"]), key=lambda run: (run["ms"], run["error"])):
        if run["error"] > 0 and (not line or run["error"] < CLEARLY * line[-1][0]):
            line.append((run["error"], run["ms"], run))
    return line


def time_at(line, goal):
    """ms per simulated second at an error, and the run that is nearest to it; None if the line does not reach it."""
    if not line or line[-1][0] > goal:
        return None
    if line[0][0] <= goal:
        return line[0][1], line[0][2]
    for (loose, cheap, _), (tight, dear, run) in zip(line, line[1:]):
        if tight <= goal:
            share = math.log(loose / goal) / math.log(loose / tight)
            return math.exp(math.log(cheap) + share * math.log(dear / cheap)), run
    return None


def best_at(methods, goal):
    """The least time of a peer's methods at an error."""
    found = [time for time in (time_at(line_of(method_runs), goal) for method_runs in methods.values()) if time]
    return min(found, key=lambda time: time[0]) if found else None


def goal_text(goal):
    return f"{goal:g}".replace("e-0", "e-")


def number(value):
    text = f"{value:.3g}" if value < 100 else f"{value:.0f}"
    return text if value < 1e5 else f"{value:.1e}".replace("e+0", "e")


def reached(methods):
    """The least error of a peer, with its time and setting, or why it has none."""
    good = [run for method_runs in methods.values() for run in method_runs if not run["failure"]]
    if not good:
        return "failed: " + next(iter(methods.values()))[-1]["failure"]
    best = min(good, key=lambda run: run["error"])
    return f"{best['error']:.1e} ({best['setting']})"


def problem_table(peers):
    """Time of every peer at each error, and its ratio to Corda's."""
    corda = {goal: best_at(peers["Corda"], goal) for goal in GOALS}
    heads = [goal_text(goal) for goal in GOALS]
    lines = ["| largest error / L | " + " | ".join(heads) + " | least error reached, and how |"]
    lines.append("|---|" + "---:|" * len(GOALS) + "---|")
    rows = []
    for peer, methods in peers.items():
        cells, rank = [], []
        for goal in GOALS:
            time = best_at(methods, goal)
            rank.append(time[0] if time else math.inf)
            if not time:
                cells.append("")
            elif peer == "Corda" or not corda[goal]:
                cells.append(number(time[0]))
            else:
                cells.append(f"{number(time[0])} ({number(time[0] / corda[goal][0])}x)")
        version = next(iter(methods.values()))[0]["version"]
        shown = {"Corda": "Corda, best method", "Corda auto": "Corda auto, plan and run"}.get(peer, peer)
        name = peer if version == "own" else f"{shown} {version.removeprefix('Boost ').replace('_', '.')}"
        rows.append((CORDA.index(peer) if peer in CORDA else len(CORDA), [-sum(map(math.isfinite, rank)), *rank], f"| {name} | " + " | ".join(cells)
                     + f" | {reached(methods)} |"))
    return "\n".join(lines + [row for _, _, row in sorted(rows)])


def winners(runs, without=()):
    """problem -> goal -> (Corda's time, best peer's time and name)."""
    found = {}
    for problem, peers in runs.items():
        found[problem] = {}
        for goal in GOALS:
            corda = best_at(peers["Corda"], goal)
            others = [(time, peer) for peer in peers if peer not in (*CORDA, *without) and (time := best_at(peers[peer], goal))]
            best = min(others, key=lambda other: other[0][0], default=None)
            found[problem][goal] = (corda, best)
    return found


def ratio_table(found, head):
    lines = [f"| {head} | " + " | ".join(map(goal_text, GOALS)) + " |"]
    lines.append("|---|" + "---|" * len(GOALS))
    for problem, title in PROBLEMS.items():
        cells = []
        for goal in GOALS:
            corda, best = found[problem][goal]
            if not best or not corda:
                cells.append("no peer" if corda else "neither" if not best else "Corda does not")
            else:
                cells.append(f"{number(best[0][0] / corda[0])} ({best[1]}: {best[0][1]['method']})")
        lines.append(f"| {title} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def plot(problem, peers, names):
    """A figure with one line per peer."""
    figure = Figure(figsize=(9, 5.6))
    axes = figure.subplots()
    labels = []
    for peer, methods in sorted(peers.items(), key=lambda item: item[0] in CORDA):
        # One line per peer, of the runs that none of its others beats.
        line = line_of([run for method_runs in methods.values() for run in method_runs])
        line = [point for point in line if point[0] < 1]
        if not line:
            continue
        colour = "black" if peer in CORDA else COLOURS[names.index(peer)]
        axes.plot([point[0] for point in line], [point[1] for point in line], "o--" if peer == "Corda auto" else "o-",
                  color=colour, markersize=3, linewidth=2.5 if peer == "Corda" else 1.2)
        labels.append((line[-1][0], line[-1][1], peer, colour))
    axes.set(xscale="log", yscale="log", xlabel="largest error / L", ylabel="ms per simulated second",
             title=PROBLEMS[problem])
    axes.invert_xaxis()
    axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
    # Names at the right, in the order of the ends of their lines, each joined to its end.
    low, high = (math.log10(limit) for limit in axes.get_ylim())
    gap = (high - low) / 22
    heights = []
    for _, ms, _, _ in sorted(labels, key=lambda label: label[1]):
        heights.append(max(math.log10(ms), heights[-1] + gap if heights else low))
    for index in reversed(range(len(heights))):
        heights[index] = min(heights[index], high - gap * (len(heights) - 1 - index))
    for (error, ms, peer, colour), height in zip(sorted(labels, key=lambda label: label[1]), heights):
        axes.annotate(peer, (error, ms), (1.03, (height - low) / (high - low)), textcoords="axes fraction",
                      color=colour, va="center", fontsize=9,
                      arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.5, "alpha": 0.6})
    return figure


def readme_rows(runs, found, engines):
    """Rows of two problems: time of stepping, and of Corda's own choice with its plan."""
    lines = ["| problem | largest error / L | Corda, best method: stepping | Corda auto: plan and run | best engine or published method: stepping | "
             "best solver of the same equations: stepping |",
             "|---|---:|---:|---:|---|---|"]

    def cell(best, corda):
        return f"{number(best[0][0])} ({best[1]}, {number(best[0][0] / corda[0])}x)" if best else "none reaches it"

    for problem in ("swing", "chain"):
        for goal in (1e-3, 1e-6, 1e-9):
            corda, best = found[problem][goal]
            own = best_at(runs[problem].get("Corda auto", {}), goal)
            lines.append(f"| {PROBLEMS[problem]} | {goal_text(goal)} | {number(corda[0])} | {number(own[0]) if own else 'no estimate'} | "
                         f"{cell(engines[problem][goal][1], corda)} | {cell(best, corda)} |")
    return "\n".join(lines)


def peers(path):
    """The chapter of the runs in a file."""
    runs = read_runs(path)
    found, engines = winners(runs), winners(runs, SOLVERS)
    names = sorted({peer for peers in runs.values() for peer in peers} - set(CORDA))
    pictures = []
    parts = [f"Processor: {processor()}, one thread.",
             ratio_table(engines, "time of the best engine or published method, over Corda's"),
             ratio_table(found, "the same, of all peers")]
    for problem, title in PROBLEMS.items():
        pictures.append(Picture(f"peers_{problem}.png", plot(problem, runs[problem], names), "Time against error of every peer"))
        absent = [name for name in names if name not in runs[problem]]
        parts.append(f"### {title}\n\n![Time against error of every peer](peers_{problem}.png)\n\n"
                     + problem_table(runs[problem])
                     + ("\n\n" + paragraph(f"Without a formulation of this problem: {', '.join(absent)}.") if absent else ""))
    return Chapter("Peers", [Part("peers", "", "\n\n".join(parts)),
                             Part("peers_rows", "", readme_rows(runs, found, engines))], pictures)
