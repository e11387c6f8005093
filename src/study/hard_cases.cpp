#include "corda/study/hard_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "corda/core/error.hpp"

namespace corda::study {
namespace {

struct Row {
    Outcome outcome;
    std::string held;
    std::optional<double> wall_s;
};

struct Cases {
    std::vector<HardCase> cases;
    std::vector<Row> rows;  ///< in the order of cases
};

Row run(const HardCase& hard, bool is_quick) {
    using Clock = std::chrono::steady_clock;
    if (hard.takes_long && is_quick) return {{"left out of a quick study", false}, "not run", std::nullopt};
    const Clock::time_point from = Clock::now();
    Row row;
    try {
        row.outcome = hard.run();
    } catch (const Error& error) {
        row.outcome = {error.what(), false};
    }
    row.wall_s = std::chrono::duration<double>(Clock::now() - from).count();
    row.held = row.outcome.is_held ? "yes" : "no";
    return row;
}

Chapter chapter_of(const Cases& shared) {
    Table table{"hard_cases", "Hard cases", {}, {}, {}};
    table.columns = {{"case", "case"},         {"method", "method"}, {"criterion", "passes when"},
                     {"measured", "measured"}, {"held", "held"},     {"wall_s", "wall time [s]"}};
    std::ptrdiff_t counts[3] = {0, 0, 0};
    for (std::size_t k = 0; k < shared.cases.size(); ++k) {
        const HardCase& hard = shared.cases[k];
        const Row& row = shared.rows[k];
        table.rows.push_back({hard.name, hard.method, hard.criterion, row.outcome.measured, row.held,
                              row.wall_s ? Cell(*row.wall_s) : Cell()});
        ++counts[row.held == "yes" ? 0 : (row.held == "no" ? 1 : 2)];
    }
    table.note = "Energy errors are over the total weight times the length where nothing else is said.";
    Chapter chapter;
    chapter.title = "Hard cases";
    chapter.paragraphs = {fmt::format("Of {} cases {} held, {} did not, and {} were not run here.",
                                      shared.cases.size(), counts[0], counts[1], counts[2])};
    chapter.tables = {std::move(table)};
    return chapter;
}

}  // namespace

ChapterWork hard_cases_work(const StudyDef& def) {
    const auto shared = std::make_shared<Cases>();
    add_hard_motions(shared->cases);
    add_hard_sizes(shared->cases);
    shared->cases.insert(shared->cases.end(), def.input_cases.begin(), def.input_cases.end());
    ChapterWork work;
    for (std::size_t k = 0; k < shared->cases.size(); ++k) {
        work.jobs.push_back(
            {shared->cases[k].name + ", " + shared->cases[k].method,
             [shared, k, is_quick = def.quick] { shared->rows.push_back(run(shared->cases[k], is_quick)); }});
    }
    work.finish = [shared] { return chapter_of(*shared); };
    return work;
}

}  // namespace corda::study
