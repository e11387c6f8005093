#include "corda/study/study.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/study/accuracy.hpp"
#include "corda/study/hard_cases.hpp"
#include "corda/study/speed.hpp"

namespace corda::study {
namespace {

struct ChapterKind {
    std::string_view name;
    ChapterWork (*work)(const StudyDef&);
    bool takes_a_scene;
};
constexpr std::array<ChapterKind, 4> kChapters{{{"speed", speed_work, true},
                                                {"findings", findings_work, false},
                                                {"accuracy", accuracy_work, false},
                                                {"hard_cases", hard_cases_work, false}}};

void check_chapters(const StudyDef& def) {
    for (const std::string& name : def.chapters) {
        const auto kind = std::ranges::find(kChapters, name, &ChapterKind::name);
        if (kind == kChapters.end())
            throw_usage("there is no chapter \"{}\"; known are {}", name, fmt::join(chapter_names(), ", "));
        if (def.scene && !kind->takes_a_scene) {
            throw_usage("chapter \"{}\" is about built-in problems; leave out the scene or the chapter",
                        name);
        }
    }
}

bool is_wanted(const ChapterKind& kind, const StudyDef& def) {
    if (def.chapters.empty()) return kind.takes_a_scene || !def.scene;
    return std::ranges::find(def.chapters, kind.name) != def.chapters.end();
}

std::string compiler() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#elif defined(__GNUC__)
    return "GCC " __VERSION__;
#else
    return "unknown";
#endif
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
    : title_("Corda: study of " + (def.scene ? printable(def.scene->name) : "its methods")),
      timing_(study_timing(def.quick)) {
    check_chapters(def);
    if (def.quick) title_ += " (quick: not to quote from)";
    for (const ChapterKind& kind : kChapters) {
        if (!is_wanted(kind, def)) continue;
        works_.push_back(kind.work(def));
        names_.emplace_back(kind.name);
    }
}

void Study::run(const OnJob& on_job, const OnChapter& on_chapter, report::Report& report) {
    report = {title_, setting(timing_), {}};
    try {
        measure(on_job, on_chapter, report);
    } catch (const Error& error) {
        report.setting.emplace_back("Ends early", error.what());
        const auto missing = names_.begin() + std::ssize(report.chapters);
        if (missing != names_.end())
            report.setting.emplace_back("Not measured",
                                        fmt::format("{}", fmt::join(missing, names_.end(), ", ")));
        throw;
    }
}

void Study::measure(const OnJob& on_job, const OnChapter& on_chapter, report::Report& report) {
    int total = 0;
    for (const ChapterWork& work : works_) total += static_cast<int>(work.jobs.size());
    int done = 0;
    for (const ChapterWork& work : works_) {
        for (const Job& job : work.jobs) {
            if (on_job) on_job(done++, total, job.what);
            job.run();
            check_cancelled();  // a job may have noted what the last one threw as its result
        }
        report.chapters.push_back(work.finish());
        on_chapter(report.chapters.back());
    }
    if (on_job) on_job(done, total, "done");
}

std::string processor_name(std::istream& cpuinfo) {
    for (std::string line; std::getline(cpuinfo, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::vector<std::pair<std::string, std::string>> setting(const Timing& timing) {
    std::ifstream cpuinfo("/proc/cpuinfo");
    return {{"Processor", processor_name(cpuinfo)},
            {"Usable cores", fmt::format("{}", usable_cores())},
            {"Compiler", compiler()},
            {"Build", CORDA_BUILD_TYPE ": " CORDA_BUILD_FLAGS},
            {"Corda", std::string(version())},
            {"Times",
             fmt::format("on one thread, by CLOCK_MONOTONIC: the median of {} repeats of at least {:g} ms",
                         timing.repeats, 1e3 * timing.shortest_s)}};
}

}  // namespace corda::study
