#include "corda/study/study.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "corda/core/error.hpp"
#include "corda/study/accuracy.hpp"
#include "corda/study/findings.hpp"
#include "corda/study/hard_cases.hpp"
#include "corda/study/sweep.hpp"
#include "corda/study/work.hpp"

namespace corda::study {
namespace {

struct ChapterKind {
    std::string_view name;
    ChapterWork (*work)(const StudyDef&);
    bool takes_a_problem;  ///< else it is about built-in problems alone
};
constexpr std::array<ChapterKind, 4> kChapters{{{"speed", speed_work, true},
                                                {"findings", findings_work, false},
                                                {"accuracy", accuracy_work, false},
                                                {"hard_cases", hard_cases_work, false}}};

std::vector<ChapterKind> chosen_chapters(const StudyDef& def) {
    std::vector<ChapterKind> chosen;
    for (const ChapterKind& kind : kChapters) {
        const bool is_asked_for =
            std::find(def.chapters.begin(), def.chapters.end(), kind.name) != def.chapters.end();
        if (is_asked_for && def.problem && !kind.takes_a_problem) {
            throw Error(ExitCode::kUsage, "chapter \"" + std::string(kind.name) +
                                              "\" is about the built-in problems; leave the scene out, or "
                                              "ask for chapter \"speed\"");
        }
        if (is_asked_for || (def.chapters.empty() && (kind.takes_a_problem || !def.problem)))
            chosen.push_back(kind);
    }
    return chosen;
}

void refuse_unknown_chapters(const StudyDef& def) {
    const std::vector<std::string> names = chapter_names();
    for (const std::string& asked : def.chapters) {
        if (std::find(names.begin(), names.end(), asked) != names.end()) continue;
        std::string known;
        for (const std::string& name : names) known.append(known.empty() ? "" : ", ").append(name);
        throw Error(
            ExitCode::kUsage,
            std::string("there is no chapter \"").append(asked).append("\"; known are ").append(known));
    }
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

Report run_study(const StudyDef& def, const Progress& progress) {
    refuse_unknown_chapters(def);
    std::vector<ChapterWork> works;
    int of = 0;
    for (const ChapterKind& kind : chosen_chapters(def)) {
        works.push_back(kind.work(def));
        of += static_cast<int>(works.back().jobs.size());
    }
    Report report;
    report.title = def.problem ? "Corda: study of " + def.problem->title : "Corda: study of its methods";
    if (def.quick) report.title += " (quick: not to quote from)";
    int done = 0;
    for (const ChapterWork& work : works) {
        for (const Job& job : work.jobs) {
            if (progress) progress(done, of, job.what);
            job.run();
            ++done;
        }
        report.chapters.push_back(work.finish());
    }
    if (progress) progress(done, of, "done");
    return report;
}

}  // namespace corda::study
