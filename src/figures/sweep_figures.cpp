#include "corda/figures/sweep_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>

#include "corda/core/cancel.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/figures/chart.hpp"
#include "corda/media/png/png.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/reference/pendulum.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/report/writers.hpp"
#include "corda/view/font.hpp"
#include "corda/view/number_text.hpp"

namespace corda::figures {
namespace {

constexpr double kDegrees = std::numbers::pi / 180.0;

/// "angle_deg" of "rope[0].hang.angle_deg".
std::string short_name(const std::string& key) {
    return key.substr(key.rfind('.') + 1);
}

/// A column of metadata.csv.
struct SweepColumn {
    std::string name;
    bool is_summary = false;

    /// "angle max (°)", "mass (kg)"
    [[nodiscard]] std::string title() const {
        constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kUnits{
            {{"_m_s", "m/s"}, {"_s", "s"}, {"_deg", "°"}, {"_n", "N"}, {"_px", "px"}, {"_m", "m"}}};
        std::string text = short_name(name);
        std::string_view unit;
        for (const auto& [ending, its_unit] : kUnits) {
            if (!text.ends_with(ending)) continue;
            text.resize(text.size() - ending.size());
            unit = its_unit;
            break;
        }
        std::replace(text.begin(), text.end(), '_', ' ');
        return unit.empty() ? text : fmt::format("{} ({})", text, unit);
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
    throw Error(ExitCode::kUsage,
                fmt::format("--plot: {} \"{}\"; give Y:X, two of {}",
                            found.empty() ? "there is no column" : "several columns are named",
                            printable(name), all));
}

/// Keys whose choices are drawn as series of their own: those with the fewest values, but not `x`.
std::vector<std::string> series_keys(const sweep::SweepDef& sweep, const SweepColumn& x) {
    std::vector<std::pair<std::size_t, std::string>> choices;
    for (const sweep::VariedKey& varied : sweep.vary)
        if (const auto* const choice = std::get_if<sweep::Choice>(&varied.values);
            choice && varied.key != x.name)
            choices.emplace_back(choice->values.size(), varied.key);
    std::stable_sort(choices.begin(), choices.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
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
        if (std::find(keys.begin(), keys.end(), key) != keys.end())
            text +=
                fmt::format("{}{} = {}", text.empty() ? "" : ", ", short_name(key), sweep::value_text(value));
    return text;
}

/// A period in theory.
struct Theory {
    double period_s = 0.0;
    const char* name = "";
};

/// The period of a scene that swings through `angle_deg`, by theory; std::nullopt if it is neither a point
/// pendulum nor a rope of equal masses that hangs from its first particle.
std::optional<Theory> theory_of(const Scene& scene, double angle_deg) {
    if (scene.ropes.size() != 1 || !scene.nets.empty()) return std::nullopt;
    const RopeDef& rope = scene.ropes.front();
    const Vec2 gravity = scene.world.gravity_m_s2;
    const bool is_plain = rope.reach == 1 && !rope.closed && rope.rest_m.empty() &&
                          rope.bending_n_m2 == 0.0 && rope.pinned == std::vector<std::uint32_t>{0} &&
                          gravity.x == 0.0 && gravity.y < 0.0 && scene.world.drag_1_s == 0.0 &&
                          rope.material.compliance_1_n == 0.0;
    if (!is_plain) return std::nullopt;
    const auto length_m = [&](std::size_t link) {
        const Vec2 d = rope.points_m[link + 1] - rope.points_m[link];
        return std::hypot(d.x, d.y);
    };
    const int links = static_cast<int>(rope.points_m.size()) - 1;
    if (links == 1) {
        if (!(angle_deg < 180.0)) return std::nullopt;
        return Theory{
            reference::Pendulum(std::sqrt(-gravity.y / length_m(0)), angle_deg * kDegrees).period_s(),
            "theory"};
    }
    const bool has_equal_masses =
        rope.payload_kg == 0.0 && std::all_of(rope.mass_kg.begin(), rope.mass_kg.end(), [&](double mass_kg) {
            return mass_kg == rope.mass_kg.front();
        });
    for (int link = 1; link < links; ++link)
        if (std::abs(length_m(link) - length_m(0)) > 1e-9 * length_m(0)) return std::nullopt;
    if (!has_equal_masses) return std::nullopt;
    const long double period_s =
        2.0L * std::numbers::pi_v<long double> / reference::rope_omega0_1_s(links, length_m(0), -gravity.y);
    return Theory{static_cast<double>(period_s), "small oscillations"};
}

/// The plot of the finished samples.
report::Plot plot_of_sweep(const sweep::SweepDef& sweep, const std::string& folder, const SweepColumn& y,
                           const SweepColumn& x) {
    report::Plot plot;
    plot.title = fmt::format("{} over {}", y.title(), x.title());
    plot.x_title = x.title();
    plot.y_title = y.title();
    plot.log_x = plot.log_y = false;
    const std::vector<std::string> keys = series_keys(sweep, x);
    // With one further key, the samples of a series lie on a curve.
    const bool is_curve = sweep.vary.size() <= keys.size() + 1;
    std::map<std::string, std::array<report::Series, 2>> all;  // measured, and by theory
    sweep::read_rows(sweep, folder, [&](const sweep::SampleRow& row) {
        const auto x_value = x.value(row);
        const auto y_value = y.value(row);
        if (!x_value || !y_value) return;
        auto& [measured, theory] = all[series_of(keys, row)];
        measured.points.emplace_back(*x_value, *y_value);
        const auto angle = row.summary.find("angle_max_deg");
        if (y.name != "period_s" || angle == row.summary.end()) return;
        if (const auto known = theory_of(scene_of(sweep, row.parameters), angle->second)) {
            theory.points.emplace_back(*x_value, known->period_s);
            theory.name = known->name;
        }
    });
    if (all.empty())
        throw Error(ExitCode::kUsage, fmt::format("--plot {}:{}: no finished sample in '{}' has both figures",
                                                  y.name, x.name, folder));
    for (std::size_t look = 0; auto& [name, its] : all) {
        auto& [measured, theory] = its;
        measured.name = name.empty() ? "measured" : name;
        measured.form = report::Series::Form::kPoints;
        measured.look = look++;
        std::sort(theory.points.begin(), theory.points.end());
        if (!name.empty()) theory.name += ", " + name;
        theory.form = is_curve ? report::Series::Form::kLine : report::Series::Form::kPoints;
        theory.look = is_curve ? *measured.look : all.size() + *measured.look;
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
    constexpr int kPosesPerCell = 5;
    Cell cell{{}, {sweep::key_of(number)}};
    try {
        const sweep::Parameters parameters = sweep::parameters_of(sweep, number);
        for (const auto& [key, value] : parameters)
            cell.lines.push_back(fmt::format("{} = {}", short_name(key),
                                             value.is_number_float()
                                                 ? view::display_number(value.get<double>(), 4)
                                                 : printable(sweep::value_text(value))));
        Scene scene = sweep::scene_of(sweep, parameters);
        VideoDef& video = scene.video;
        const double scale = 1.0 * side_px / std::max(video.width_px, video.height_px);
        for (int* const side : {&video.width_px, &video.height_px})
            *side = std::max(1, static_cast<int>(std::lround(scale * *side)));
        scene.overlay = {};
        Film film(scene);
        std::vector<double> times_s;
        for (int pose = 0; pose < kPosesPerCell; ++pose)
            times_s.push_back(film.time_s(film.last_frame() * pose / (kPosesPerCell - 1)));
        times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
        cell.image = render::render_reference(FilmRenderer::list_poses(film, times_s));
    } catch (const Error& error) {
        if (error.code() != ExitCode::kInvalidScene && error.code() != ExitCode::kDiverged) throw;
        cell.lines.emplace_back("refused");
    }
    return cell;
}

void write_file(const std::string& path, std::string_view bytes) {
    OutputFile file(path, {.force = true});
    file.write(bytes);
    file.commit();
}

}  // namespace

std::vector<std::string> write_sweep_plot(const sweep::SweepDef& sweep, const std::string& folder,
                                          const std::string& columns) {
    const std::size_t colon = columns.find(':');
    if (colon == std::string::npos)
        throw Error(ExitCode::kUsage,
                    fmt::format("--plot {}: is not Y:X, such as period_s:angle_max_deg", printable(columns)));
    const SweepColumn y = find_column(sweep, columns.substr(0, colon));
    const SweepColumn x = find_column(sweep, columns.substr(colon + 1));
    const report::Plot plot = plot_of_sweep(sweep, folder, y, x);
    const auto stem =
        std::filesystem::path(folder) / fmt::format("{}-{}", short_name(y.name), short_name(x.name));
    std::vector<std::string> paths;
    for (const auto format : {report::PlotFormat::kSvg, report::PlotFormat::kPdf, report::PlotFormat::kPng})
        write_file(paths.emplace_back(stem.string() + "." + report::ending(format)),
                   report::draw_plot(plot, format, report::kPageMm));
    report::Table table{
        "plot", plot.title, {{"series", "series"}, {x.name, x.name}, {y.name, y.name}}, {}, {}};
    for (const report::Series& series : plot.series)
        for (const auto& [at, value] : series.points) table.add({series.name, at, value});
    write_file(paths.emplace_back(stem.string() + ".csv"), report::csv_text(table));
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
            while (font.width_px(line, kTextPx) > kSidePx) line = utf8(line.substr(0, line.size() - 4)) + "…";
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
    write_file(path, media::png_bytes(sheet, {}));
    return path;
}

}  // namespace corda::figures
