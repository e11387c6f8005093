#include "corda/figures/scene_report.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "corda/core/csv.hpp"
#include "corda/core/text.hpp"
#include "corda/figures/chapters.hpp"
#include "corda/figures/drawings.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "corda/view/words.hpp"

namespace corda::figures {
namespace {

/// Reads the motion, and leaves its rows in the folder.
MotionSummary read_into(Film& film, const SceneReportDef& def, report::ReportFolder& folder) {
    std::vector<std::pair<std::string, std::unique_ptr<CsvFile>>> files;
    const auto open = [&](const std::string& name, const std::vector<std::string>& keys) -> OnRow {
        const std::string path = folder.path_of(name);
        auto& file = *files.emplace_back(path, std::make_unique<CsvFile>(path, def.output, keys)).second;
        return [&file](std::span<const double> values) { file.add_row(values); };
    };
    const auto on_progress = [&](std::int64_t done, std::int64_t total) {
        if (def.on_part) def.on_part("read", done, total);
        return true;
    };
    MotionSummary motion = read_motion(film, open, on_progress);
    for (const auto& [path, file] : files) {
        file->commit();
        folder.note(path);
    }
    return motion;
}

/// The numbers of the figure of the tensions along a rope.
void write_tensions_along(const Film& film, const MotionSummary& motion, const OutputOptions& options,
                          report::ReportFolder& folder) {
    const std::string path = folder.path_of("tension_along.csv");
    CsvFile file(path, options, {"link", "rest_length_m", "tension_n"});
    const Body& body = film.system().bodies[motion.tension.body];
    for (std::size_t k = 0; k < body.link_count; ++k) {
        const double values[] = {static_cast<double>(k), film.system().bars[body.first_bar + k].rest_m,
                                 motion.tensions_n[k]};
        file.add_row(values);
    }
    file.commit();
    folder.note(path);
}

std::vector<report::Chapter> list_chapters(Film& film, const MotionSummary& motion, const FigureTimes& times,
                                           const WritePoses& write) {
    std::vector<report::Chapter> chapters;
    chapters.push_back(motion_chapter(film, motion, times, write));
    chapters.push_back(path_chapter(film, motion));
    chapters.push_back(angle_chapter(film, motion));
    chapters.push_back(phase_chapter(film, motion));
    chapters.push_back(energy_chapter(film, motion));
    chapters.push_back(tension_chapter(film, motion));
    chapters.push_back(strain_chapter(film, motion));
    std::erase_if(chapters, [](const report::Chapter& chapter) {
        return chapter.paragraphs.empty() && chapter.plots.empty() && chapter.summary.empty();
    });
    return chapters;
}

/// Translates headings, titles of figures and of their axes, and names of curves that are not those of
/// bodies. Sentences get the decimal sign.
void translate(Language language, report::Report& page) {
    const auto into = [&](std::string& text) { text = view::translated(text, language); };
    const auto localize = [&](std::string& text) { text = view::localized_sentence(text, language); };
    into(page.setting_title);
    for (auto& [name, value] : page.setting) localize(value);
    for (report::Chapter& chapter : page.chapters) {
        into(chapter.title);
        localize(chapter.summary);
        for (std::string& paragraph : chapter.paragraphs) localize(paragraph);
        for (report::Table& table : chapter.tables) {
            table.language = language;
            into(table.title);
        }
        for (report::Picture& picture : chapter.pictures) {
            localize(picture.title);
            localize(picture.caption);
        }
        for (report::Plot& plot : chapter.plots) {
            plot.language = language;
            localize(plot.caption);
            for (std::string* const text : {&plot.title, &plot.x_title, &plot.y_title}) into(*text);
            for (report::Series& series : plot.series)
                if (plot.id == "energy") into(series.name);
        }
    }
}

report::Report page_of(const Film& film, std::vector<report::Chapter> chapters) {
    const Scene& scene = film.scene();
    report::Report page;
    page.title = scene.overlay.title.empty()
                     ? fmt::format(fmt::runtime(view::translated("Report of {}", scene.overlay.language)),
                                   printable(scene.name))
                     : printable(scene.overlay.title);
    page.setting = {{"Bodies", system_text(film.system())},
                    {"Method", plan_text(film.system(), film.plan())},
                    {"Duration", fmt::format("{:g} s", scene.world.duration_s)},
                    {"Rows", fmt::format("{} per second", scene.video.scene_rate().rational().text())}};
    page.chapters = std::move(chapters);
    translate(scene.overlay.language, page);
    page.setting.emplace_back("Corda", version());
    return page;
}

}  // namespace

std::optional<Error> write_scene_report(Film& film, const SceneReportDef& def, report::ReportFolder& folder) {
    Drawings drawings(film);
    static_cast<void>(
        drawings.gl(report::kColumnMm));  // before anything is simulated, if the method is named
    const MotionSummary motion = read_into(film, def, folder);
    if (motion.tension.is_known) write_tensions_along(film, motion, def.output, folder);
    const FigureTimes times = find_figure_times(film, motion, def.at_s);
    std::vector<double> drawn_s = times.strobe_s;
    drawn_s.insert(drawn_s.end(), times.stills_s.begin(), times.stills_s.end());
    std::ranges::sort(drawn_s);
    FilmRenderer::keep(film, drawn_s);
    const auto write = [&](const std::string& path, double width_mm, const std::vector<double>& times_s) {
        drawings.write(path, width_mm, times_s, def.output);
    };
    report::Report page = page_of(film, list_chapters(film, motion, times, write));
    std::optional<Error> stopped;
    std::int64_t done = 0;
    try {
        for (const report::Chapter& chapter : page.chapters) {
            if (def.on_part) def.on_part("draw", done++, std::ssize(page.chapters));
            folder.add(chapter);
        }
    } catch (const Error& error) {
        stopped = error;
        page.setting.emplace_back("Ends early", error.what());
    }
    folder.finish(std::move(page));
    if (stopped) throw Error(*stopped);
    return motion.failure;
}

}  // namespace corda::figures
