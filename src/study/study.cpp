#include "corda/study/study.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/basics.hpp"
#include "corda/study/accuracy.hpp"
#include "corda/study/findings.hpp"
#include "corda/study/hard_cases.hpp"
#include "corda/study/pictures.hpp"
#include "corda/study/setting.hpp"
#include "corda/study/speed.hpp"

namespace corda::study {
namespace {

struct ChapterKind {
    std::string_view name;
    ChapterWork (*work)(const StudyDef&);
    bool takes_a_scene;
};
constexpr std::array<ChapterKind, 5> kChapters{{{"speed", speed_work, true},
                                                {"findings", findings_work, false},
                                                {"accuracy", accuracy_work, false},
                                                {"hard_cases", hard_cases_work, false},
                                                {"picture", pictures_work, true}}};

void check_chapters(const StudyDef& def) {
    for (const std::string& name : def.chapters) {
        const auto kind = std::find_if(kChapters.begin(), kChapters.end(),
                                       [&](const ChapterKind& one) { return one.name == name; });
        if (kind == kChapters.end()) {
            throw Error(ExitCode::kUsage, fmt::format("there is no chapter \"{}\"; known are {}", name,
                                                      fmt::join(chapter_names(), ", ")));
        }
        if (def.scene && !kind->takes_a_scene) {
            throw Error(
                ExitCode::kUsage,
                fmt::format("chapter \"{}\" is about built-in problems; leave out the scene or the chapter",
                            name));
        }
    }
}

bool is_wanted(const ChapterKind& kind, const StudyDef& def) {
    if (def.chapters.empty()) return kind.takes_a_scene || !def.scene;
    return std::find(def.chapters.begin(), def.chapters.end(), kind.name) != def.chapters.end();
}

}  // namespace

std::vector<std::string> chapter_names() {
    std::vector<std::string> names;
    for (const ChapterKind& kind : kChapters) names.emplace_back(kind.name);
    return names;
}

Timing study_timing(bool quick) {
    return quick ? Timing{2, 0.002} : Timing{};
}

Study::Study(const StudyDef& def)
    : title_(def.scene ? "Corda: study of " + def.scene->name : "Corda: study of its methods"),
      timing_(study_timing(def.quick)) {
    check_chapters(def);
    if (def.quick) title_ += " (quick: not to quote from)";
    for (const ChapterKind& kind : kChapters) {
        if (is_wanted(kind, def)) works_.push_back(kind.work(def));
    }
}

report::Report Study::run(const OnJob& on_job) {
    report::Report report{title_, setting(timing_), {}};
    int total = 0;
    for (const ChapterWork& work : works_) total += static_cast<int>(work.jobs.size());
    int done = 0;
    for (const ChapterWork& work : works_) {
        for (const Job& job : work.jobs) {
            if (on_job) on_job(done++, total, job.what);
            job.run();
        }
        report.chapters.push_back(work.finish());
    }
    if (on_job) on_job(done, total, "done");
    return report;
}

}  // namespace corda::study
