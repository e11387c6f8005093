#include "corda/figures/sweep_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>

#include "corda/core/cancel.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/figures/drawings.hpp"
#include "corda/figures/motion_summary.hpp"
#include "corda/media/bytes.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/report/writers.hpp"
#include "corda/scene/schema.hpp"
#include "corda/view/font.hpp"
#include "corda/view/number_text.hpp"

namespace corda::figures {
namespace {

/// "angle_deg" of "rope[0].hang.angle_deg".
std::string short_name(const std::string& key) {
    return key.substr(key.rfind('.') + 1);
}

/// A column of metadata.csv.
struct SweepColumn {
    std::string name;
    bool is_summary = false;

    /// "angle max (°)", "mass"
    [[nodiscard]] std::string title() const {
        constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kUnits{
            {{"_m_s", "m/s"}, {"_s", "s"}, {"_deg", "°"}, {"_n", "N"}, {"_px", "px"}, {"_m", "m"}}};
        std::string text = short_name(name);
        std::string_view unit;
        for (const auto& [ending, known_unit] : kUnits) {
            if (!text.ends_with(ending)) continue;
            text.resize(text.size() - ending.size());
            unit = known_unit;
            break;
        }
        if (const scene::Key* const key = is_summary || !unit.empty() ? nullptr : schema_key())
            unit = key->unit;
        std::ranges::replace(text, '_', ' ');
        return unit.empty() ? text : fmt::format("{} ({})", text, unit);
    }

    /// The schema row of a varied key; null if there is none.
    [[nodiscard]] const scene::Key* schema_key() const {
        std::string section =
            name.substr(0, name.size() - std::min(name.size(), short_name(name).size() + 1));
        for (std::size_t open; (open = section.find('[')) != std::string::npos;)
            section.erase(open, section.find(']', open) + 1 - open);
        return scene::find_key(section, short_name(name));
    }

    [[nodiscard]] std::optional<double> value(const sweep::SampleRow& row) const {
        if (is_summary) {
            const auto found = row.summary.find(name);
            return found == row.summary.end() ? std::nullopt : std::optional(found->second);
        }
        for (const auto& [key, value] : row.parameters)
            if (key == name && value.is_number()) return value.get<double>();
        return std::nullopt;
    }
};

SweepColumn find_column(const sweep::SweepDef& sweep, const std::string& name) {
    std::vector<SweepColumn> found;
    for (const std::string& column : sweep.summary)
        if (column == name) found.push_back({column, true});
    for (const sweep::VariedKey& varied : sweep.vary)
        if (varied.key == name || short_name(varied.key) == name) found.push_back({varied.key, false});
    if (found.size() == 1) return found.front();
    std::string all;
    for (const std::string& column : sweep.summary) all += column + ", ";
    for (const sweep::VariedKey& varied : sweep.vary) all += varied.key + ", ";
    all.erase(all.size() - 2);
    throw_usage("--plot: {} \"{}\"; give Y:X, two of {}",
                found.empty() ? "there is no column" : "several columns are named", printable(name), all);
}

/// The columns of "Y:X".
std::pair<SweepColumn, SweepColumn> find_columns(const sweep::SweepDef& sweep, const std::string& columns) {
    const std::size_t colon = columns.find(':');
    if (colon == std::string::npos)
        throw_usage("--plot {}: is not Y:X, such as period_s:angle_max_deg", printable(columns));
    return {find_column(sweep, columns.substr(0, colon)), find_column(sweep, columns.substr(colon + 1))};
}

/// "mass", or "rope_0__mass" if another key ends alike.
std::string file_name(const sweep::SweepDef& sweep, const SweepColumn& column) {
    const auto ends_alike = std::ranges::count_if(sweep.vary, [&](const sweep::VariedKey& varied) {
        return short_name(varied.key) == short_name(column.name);
    });
    std::string name = ends_alike > 1 ? column.name : short_name(column.name);
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '[' || c == ']' || c == '.'; }, '_');
    return name;
}

/// Keys whose choices are drawn as series of their own: those with the fewest values, but not `x`.
std::vector<std::string> series_keys(const sweep::SweepDef& sweep, const SweepColumn& x) {
    std::vector<std::pair<std::size_t, std::string>> choices;
    for (const sweep::VariedKey& varied : sweep.vary)
        if (const auto* const choice = std::get_if<sweep::Choice>(&varied.values);
            choice && varied.key != x.name && choice->values.size() > 1)
            choices.emplace_back(choice->values.size(), varied.key);
    std::ranges::stable_sort(choices, {}, [](const auto& choice) { return choice.first; });
    std::vector<std::string> keys;
    std::size_t series = 1;
    for (const auto& [count, key] : choices)
        if ((series *= count) <= report::Series::kLooks) keys.push_back(key);
    return keys;
}

/// "gravity = 1.62": the series of a sample.
std::string series_of(const std::vector<std::string>& keys, const sweep::SampleRow& row) {
    std::string text;
    for (const auto& [key, value] : row.parameters)
        if (std::ranges::find(keys, key) != keys.end())
            text +=
                fmt::format("{}{} = {}", text.empty() ? "" : ", ", short_name(key), sweep::value_text(value));
    return text;
}

/// A sample in a plot.
struct Point {
    std::string key;
    std::size_t series = 0;
    double x = 0.0;
    double y = 0.0;
    std::optional<double> theory;
};

/// The samples of a plot, in series of equal choices.
struct SweepPoints {
    struct Group {
        std::string name;
        sweep::Parameters parameters;  ///< of its first sample
    };
    std::vector<Group> series;
    std::vector<Point> points;
};

SweepPoints read_points(const sweep::SweepDef& sweep, const std::string& folder, const SweepColumn& y,
                        const SweepColumn& x, const std::vector<std::string>& keys) {
    SweepPoints all;
    sweep::read_rows(sweep, folder, [&](const sweep::SampleRow& row) {
        const auto x_value = x.value(row);
        const auto y_value = y.value(row);
        if (!x_value || !y_value) return;
        const std::string name = series_of(keys, row);
        const auto found = std::ranges::find(all.series, name, &SweepPoints::Group::name);
        const std::size_t series = found - all.series.begin();
        if (found == all.series.end()) all.series.push_back({name, row.parameters});
        Point point{sweep::key_of(row.number), series, *x_value, *y_value, {}};
        const auto angle = row.summary.find("angle_max_deg");
        if (y.name == "period_s" && angle != row.summary.end())
            if (const auto theory = period_theory(scene_of(sweep, row.parameters), angle->second))
                point.theory = theory->period_s;
        all.points.push_back(std::move(point));
    });
    if (all.points.empty())
        throw_usage(
            "--plot {}:{}: no finished sample in '{}' has both figures (a period needs two passes below the "
            "only pin)",
            y.name, x.name, folder);
    return all;
}

/// Whether the angle alone differs between the samples of a series, and is drawn along x.
bool is_angle_curve(const sweep::SweepDef& sweep, const SweepColumn& x,
                    const std::vector<std::string>& keys) {
    if (x.name != "angle_max_deg" && short_name(x.name) != "angle_deg") return false;
    return std::ranges::all_of(sweep.vary, [&](const sweep::VariedKey& varied) {
        const auto* const choice = std::get_if<sweep::Choice>(&varied.values);
        return std::ranges::find(keys, varied.key) != keys.end() || short_name(varied.key) == "angle_deg" ||
               (choice && choice->values.size() == 1);
    });
}

report::Plot plot_of(const sweep::SweepDef& sweep, const SweepPoints& all, const SweepColumn& y,
                     const SweepColumn& x, bool is_curve) {
    report::Plot plot;
    plot.title = std::filesystem::path(sweep.source).stem().string();
    plot.x_title = x.title();
    plot.y_title = y.title();
    plot.log_x = plot.log_y = false;
    for (const sweep::VariedKey& varied : sweep.vary)
        if (const auto* const distribution = std::get_if<sweep::Distribution>(&varied.values);
            distribution && varied.key == x.name)
            plot.log_x = distribution->shape == sweep::Shape::kLogUniform;
    for (std::size_t i = 0; i < all.series.size(); ++i) {
        const auto& [name, parameters] = all.series[i];
        report::Series measured{.name = name.empty() ? "measured" : name, .points = {}};
        report::Series theory{.name = name.empty() ? "theory" : "theory, " + name, .points = {}};
        for (const Point& point : all.points) {
            if (point.series != i) continue;
            measured.points.emplace_back(point.x, point.y);
            if (point.theory) theory.points.emplace_back(point.x, *point.theory);
        }
        if (is_curve && !theory.points.empty()) {
            constexpr int kCurvePoints = 200;
            const auto [least, most] = std::ranges::minmax_element(theory.points);
            const double first_deg = least->first;
            const double extent_deg = most->first - first_deg;
            const Scene scene = scene_of(sweep, parameters);
            theory.points.clear();
            for (int k = 0; k <= kCurvePoints; ++k) {
                const double angle_deg = first_deg + k * extent_deg / kCurvePoints;
                if (const auto period = period_theory(scene, angle_deg))
                    theory.points.emplace_back(angle_deg, period->period_s);
            }
        }
        measured.form = report::Series::Form::kPoints;
        measured.look = i;
        theory.form = is_curve ? report::Series::Form::kLine : report::Series::Form::kPoints;
        theory.look = is_curve ? i : all.series.size() + i;
        plot.series.push_back(std::move(theory));
        plot.series.push_back(std::move(measured));
    }
    return plot;
}

/// A cell of a contact sheet.
struct Cell {
    Image image;
    std::vector<std::string> lines;  ///< below it
};

/// Poses of a sample, and its parameters.
Cell cell_of(const sweep::SweepDef& sweep, std::int64_t number, int side_px) {
    Cell cell{{}, {sweep::key_of(number)}};
    try {
        const sweep::Parameters parameters = sweep::parameters_of(sweep, number);
        for (const auto& [key, value] : parameters)
            cell.lines.push_back(fmt::format("{} = {}", short_name(key),
                                             value.is_number_float()
                                                 ? view::display_number(value.get<double>(), 4)
                                                 : printable(sweep::value_text(value))));
        Scene scene = sweep::scene_of(sweep, parameters);
        scene.video.scale_to(side_px);
        scene.overlay = {};
        Film film(scene, film_def(scene));
        const auto no_rows = [](const std::string&, const std::vector<std::string>&) -> OnRow {
            return [](std::span<const double>) {};
        };
        const FigureTimes times = find_figure_times(film, read_motion(film, no_rows, {}), {});
        const std::vector<double>& times_s = times.strobe_s;
        cell.lines.push_back(fmt::format("{} poses, t = 0 .. {:.4g} s", times_s.size(), times_s.back()));
        cell.image = render::render_reference(FilmRenderer::list_poses(film, times_s));
    } catch (const Error& error) {
        if (!sweep::is_refusal(error.code())) throw;
        cell.lines.emplace_back("refused");
    }
    return cell;
}

}  // namespace

std::pair<std::string, std::string> sweep_plot_titles(const sweep::SweepDef& sweep,
                                                      const std::string& columns) {
    const auto [y, x] = find_columns(sweep, columns);
    return {y.title(), x.title()};
}

std::vector<std::string> write_sweep_plot(const sweep::SweepDef& sweep, const std::string& folder,
                                          const std::string& columns) {
    const auto [y, x] = find_columns(sweep, columns);
    const std::vector<std::string> keys = series_keys(sweep, x);
    const SweepPoints all = read_points(sweep, folder, y, x, keys);
    const report::Plot plot = plot_of(sweep, all, y, x, is_angle_curve(sweep, x, keys));
    const auto stem = std::filesystem::path(folder) / (file_name(sweep, y) + "-" + file_name(sweep, x));
    std::vector<std::string> paths;
    for (const auto format : {report::PlotFormat::kSvg, report::PlotFormat::kPdf, report::PlotFormat::kPng})
        save_file(paths.emplace_back(stem.string() + "." + report::ending(format)),
                  report::draw_plot(plot, format, report::kPageMm));
    report::Table table{
        "plot",
        plot.title,
        {{"key", "key"}, {"series", "series"}, {x.name, x.name}, {y.name, y.name}, {"theory", "theory"}},
        {},
        {}};
    for (const Point& point : all.points)
        table.add(
            {point.key, all.series[point.series].name, point.x, point.y, report::cell_of(point.theory)});
    save_file(paths.emplace_back(stem.string() + ".csv"), report::csv_text(table));
    return paths;
}

std::string write_sweep_sheet(const sweep::SweepDef& sweep, const std::string& folder) {
    constexpr std::int64_t kMaxCells = 36;
    constexpr int kSidePx = 240;
    constexpr int kTextPx = 13;
    constexpr int kLinePx = 17;
    constexpr int kGapPx = 12;
    const auto count = static_cast<int>(std::min(kMaxCells, sweep.samples));
    const int columns = static_cast<int>(std::ceil(std::sqrt(count)));
    std::vector<Cell> cells;
    int height_px = 0;
    std::size_t lines = 0;
    for (int i = 0; i < count; ++i) {
        check_cancelled();
        cells.push_back(cell_of(sweep, i * sweep.samples / count, kSidePx));
        height_px = std::max(height_px, cells.back().image.height());
        lines = std::max(lines, cells.back().lines.size());
    }
    const int row_px = height_px + static_cast<int>(lines) * kLinePx + 2 * kGapPx;
    view::DrawList list;
    list.width = columns * (kSidePx + kGapPx) + kGapPx;
    list.height = (count + columns - 1) / columns * row_px;
    list.ground = {Color{255, 255, 255}, Color{255, 255, 255}};
    view::Font font;
    const auto place = [&](int i) {
        return std::pair(kGapPx + i % columns * (kSidePx + kGapPx), kGapPx + i / columns * row_px);
    };
    for (int i = 0; i < count; ++i) {
        auto [x_px, y_px] = place(i);
        y_px += height_px;
        for (std::string& line : cells[i].lines) {
            line = font.shortened(std::move(line), kTextPx, kSidePx, "");
            font.write({x_px, y_px += kLinePx, kTextPx, Color{0, 0, 0}, line}, list);
        }
    }
    Image sheet = render::render_reference(list);
    for (int i = 0; i < count; ++i) {
        const auto [x_px, y_px] = place(i);
        const Image& image = cells[i].image;
        for (int row = 0; row < image.height(); ++row)
            std::copy_n(image.pixel(0, row), image.row_bytes(), sheet.pixel(x_px, y_px + row));
    }
    std::string path = (std::filesystem::path(folder) / "sheet.png").string();
    save_file(path, media::png_bytes(sheet, {}));
    return path;
}

}  // namespace corda::figures
