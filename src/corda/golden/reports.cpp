#include "corda/golden/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/core/markup.hpp"
#include "corda/core/problem_json.hpp"
#include "corda/core/text.hpp"

namespace corda::golden {
namespace {

namespace fs = std::filesystem;

std::string case_xml(const Checked& picture) {
    std::string xml = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">\n",
                                  markup_text(picture.scene), markup_text(picture.name), picture.seconds);
    if (picture.difference) {
        const auto property = [](const char* name, double value) {
            return fmt::format("        <property name=\"{}\" value=\"{:.6g}\"/>\n", name, value);
        };
        const Difference& difference = *picture.difference;
        xml += "      <properties>\n" + property("max", difference.max) + property("mean", difference.mean) +
               property("share", difference.share) + "      </properties>\n";
    }
    if (picture.failed())
        xml += fmt::format("      <{} type=\"{}\" message=\"{}\"/>\n",
                           picture.verdict() == Verdict::kInvalid ? "error" : "failure",
                           word_of(picture.verdict()),
                           markup_text(joined(figures_text(picture), cause_text(picture).whole_or_group())));
    return xml + "    </testcase>\n";
}

/// Attributes of the pictures [first, last).
template <class Iterator>
std::string counts_xml(Iterator first, Iterator last) {
    int failures = 0;
    int errors = 0;
    double seconds = 0.0;
    for (Iterator picture = first; picture != last; ++picture) {
        if (picture->failed()) ++(picture->verdict() == Verdict::kInvalid ? errors : failures);
        seconds += picture->seconds;
    }
    return fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.3f}\"", last - first, failures,
                       errors, seconds);
}

/// Text for a cell of a table of Markdown.
std::string cell(const std::string& text) {
    std::string result;
    for (const char c : markup_text(printable(text))) {
        if (std::string_view("|*_`[]\\").find(c) != std::string_view::npos) result += '\\';
        result += c;
    }
    return result;
}

}  // namespace

std::string figures_text(const Checked& picture) {
    return picture.difference ? corda::figures_text(*picture.difference) : "";
}

std::int64_t SuiteResult::count(Verdict verdict) const {
    return std::ranges::count_if(
        pictures, [&](const Checked& picture) { return picture.verdict() == verdict && !picture.changed; });
}

std::int64_t SuiteResult::changed() const {
    return std::ranges::count_if(pictures, &Checked::changed);
}

std::string SuiteResult::totals() const {
    const std::int64_t invalid = count(Verdict::kInvalid);
    std::string text = fmt::format(
        "{}: {} passed, {} failed, {} missing, {} stale", counted(std::ssize(pictures) - invalid, "picture"),
        count(Verdict::kPassed), count(Verdict::kDifferent) + count(Verdict::kEmpty),
        count(Verdict::kMissing), count(Verdict::kStale));
    if (may_change) text += fmt::format(", {}{} written or removed", changed(), dry_run ? " would be" : "");
    if (invalid > 0) text += fmt::format("; {} invalid", counted(invalid, "scene"));
    return text;
}

nlohmann::json figures_json(const std::optional<Difference>& difference) {
    if (!difference || !difference->same_size)
        return {{"max", nullptr}, {"mean", nullptr}, {"share", nullptr}};
    const auto whole = static_cast<int>(difference->max);  // but of pictures with 16 bits
    return {{"max", difference->max == whole ? nlohmann::json(whole) : nlohmann::json(difference->max)},
            {"mean", difference->mean},
            {"share", difference->share}};
}

nlohmann::json picture_json(const Checked& picture) {
    const bool is_stale = picture.verdict() == Verdict::kStale;
    const CauseText cause = cause_text(picture);
    nlohmann::json json = figures_json(picture.difference);
    json.update({{"name", picture.name},
                 {"scene", picture.scene},
                 {"time_s", picture.time_s},
                 {"result", word_of(picture.verdict())},
                 {"cause", cause.whole},
                 {"group", cause.group},
                 {"compared_with", is_stale ? "" : fs::path(picture.reference).filename().string()},
                 {"new", picture.drawn_path},
                 {"changed", picture.changed}});
    if (picture.verdict() == Verdict::kInvalid) json["problems"] = problems_json(picture.cause.problems);
    return json;
}

std::string junit_xml(const SuiteResult& result) {
    std::string suites;
    const auto& pictures = result.pictures;
    for (auto first = pictures.begin(); first != pictures.end();) {
        const auto last = std::find_if(first, pictures.end(),
                                       [&](const Checked& picture) { return picture.scene != first->scene; });
        suites +=
            fmt::format("  <testsuite name=\"{}\" {}>\n",
                        first->scene.empty() ? "stale" : markup_text(first->scene), counts_xml(first, last));
        for (; first != last; ++first) suites += case_xml(*first);
        suites += "  </testsuite>\n";
    }
    return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {}>\n{}</testsuites>\n",
                       counts_xml(pictures.begin(), pictures.end()), suites);
}

std::string markdown(const SuiteResult& result) {
    constexpr std::size_t kMaxRows = 200;  // a comment on GitHub has at most 65536 characters
    std::string text = fmt::format("### Golden pictures\n\n{}\n", result.totals());
    std::vector<std::pair<const Checked*, CauseText>> failed;
    for (const Checked& picture : result.pictures)
        if (picture.failed()) failed.emplace_back(&picture, cause_text(picture));
    std::ranges::stable_sort(failed, {}, [](const auto& one) { return one.second.group; });
    const std::size_t rows = std::min(failed.size(), kMaxRows);
    for (std::size_t i = 0; i < rows; ++i) {
        const auto& [picture, cause] = failed[i];
        if (i == 0 || cause.group != failed[i - 1].second.group)
            text += fmt::format("\n**{}**\n\n| picture | result | difference | cause |\n|---|---|---|---|\n",
                                cell(cause.group));
        text += fmt::format("| {} | {} | {} | {} |\n", cell(picture->name), word_of(picture->verdict()),
                            figures_text(*picture), cell(cause.own));
    }
    if (rows < failed.size()) text += fmt::format("\nand {} more\n", failed.size() - rows);
    return text;
}

}  // namespace corda::golden
