#include "corda/golden/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"

namespace corda::golden {
namespace {

std::string case_xml(const Checked& picture) {
    std::string xml = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">\n",
                                  markup_text(picture.scene), markup_text(picture.name), picture.seconds);
    const Difference& difference = picture.difference;
    if (!picture.figures().empty()) {
        const auto property = [](const char* name, double value) {
            return fmt::format("        <property name=\"{}\" value=\"{:.6g}\"/>\n", name, value);
        };
        xml += "      <properties>\n" + property("max", difference.max) + property("mean", difference.mean) +
               property("share", difference.share);
        xml += "      </properties>\n";
    }
    if (picture.failed()) {
        const std::string figures = picture.figures();
        xml +=
            fmt::format("      <{} type=\"{}\" message=\"{}\"/>\n",
                        picture.verdict == Verdict::kInvalid ? "error" : "failure", word_of(picture.verdict),
                        markup_text((figures.empty() ? "" : figures + "; ") + picture.why()));
    }
    return xml + "    </testcase>\n";
}

/// Attributes of the pictures [first, last).
template <class Iterator>
std::string counts_xml(Iterator first, Iterator last) {
    int failures = 0;
    int errors = 0;
    double seconds = 0.0;
    for (Iterator picture = first; picture != last; ++picture) {
        if (picture->failed()) ++(picture->verdict == Verdict::kInvalid ? errors : failures);
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

const char* word_of(Verdict verdict) {
    constexpr std::array kWords{"passed", "different", "missing", "empty", "stale", "invalid"};
    return kWords.at(static_cast<std::size_t>(verdict));
}

std::string Checked::figures() const {
    const bool has_figures = verdict != Verdict::kStale && !reference.empty() && difference.same_size;
    return has_figures ? figures_text(difference) : "";
}

std::int64_t SuiteResult::count(Verdict verdict) const {
    return std::ranges::count_if(
        pictures, [&](const Checked& picture) { return picture.verdict == verdict && !picture.changed; });
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

nlohmann::json max_json(const Difference& difference) {
    const auto whole = static_cast<int>(difference.max);
    return difference.max == whole ? nlohmann::json(whole) : nlohmann::json(difference.max);
}

nlohmann::json picture_json(const Checked& picture) {
    const bool has_figures = !picture.figures().empty();
    const std::string compared_with = picture.verdict == Verdict::kStale
                                          ? ""
                                          : std::filesystem::path(picture.reference).filename().string();
    return {{"name", picture.name},
            {"scene", picture.scene},
            {"time_s", picture.time_s},
            {"result", word_of(picture.verdict)},
            {"cause", picture.cause},
            {"group", picture.group},
            {"compared_with", compared_with},
            {"new", picture.drawn_path},
            {"changed", picture.changed},
            {"max", has_figures ? max_json(picture.difference) : nlohmann::json()},
            {"mean", has_figures ? nlohmann::json(picture.difference.mean) : nlohmann::json()},
            {"share", has_figures ? nlohmann::json(picture.difference.share) : nlohmann::json()}};
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
    constexpr int kMaxRows = 200;  // a comment on GitHub has at most 65536 characters
    std::string text = fmt::format("### Golden pictures\n\n{}\n", result.totals());
    std::vector<const Checked*> failed;
    for (const Checked& picture : result.pictures)
        if (picture.failed()) failed.push_back(&picture);
    std::ranges::stable_sort(failed, {}, &Checked::group);
    int rows = 0;
    for (std::size_t i = 0; i < failed.size() && rows < kMaxRows; ++i, ++rows) {
        const Checked& picture = *failed[i];
        if (i == 0 || picture.group != failed[i - 1]->group)
            text += fmt::format("\n**{}**\n\n| picture | result | difference | cause |\n|---|---|---|---|\n",
                                cell(picture.group));
        std::string cause = picture.cause;
        if (cause.ends_with(picture.group)) cause.resize(cause.size() - picture.group.size());
        if (cause.ends_with("; ")) cause.resize(cause.size() - 2);
        text += fmt::format("| {} | {} | {} | {} |\n", cell(picture.name), word_of(picture.verdict),
                            picture.figures(), cell(cause));
    }
    if (std::cmp_less(rows, failed.size())) text += fmt::format("\nand {} more\n", std::ssize(failed) - rows);
    return text;
}

}  // namespace corda::golden
