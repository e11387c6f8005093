#include "corda/golden/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/core/markup.hpp"
#include "corda/core/problem_json.hpp"
#include "corda/core/text.hpp"

namespace corda::golden {
namespace {

namespace fs = std::filesystem;

/// The verdict and the words for a cause.
struct Words {
    Verdict verdict{};
    const char* group = "";
    const char* own = "";
    bool is_alone = false;  ///< the own words say it all, and do not follow those of the group
};

/// By Cause::Kind.
constexpr std::array kCauseWords{
    Words{Verdict::kPassed, "", ""},
    Words{Verdict::kDifferent, "", ""},
    Words{Verdict::kInvalid, "invalid scene", "{message}", true},
    Words{Verdict::kMissing, "there is no reference", "", true},
    Words{Verdict::kDifferent, "is no PNG, and --update --force replaces it",
          "the kept picture is no PNG, and --update --force replaces it ({message})", true},
    Words{Verdict::kDifferent, "is damaged, and --update replaces it",
          "the kept picture is damaged, and --update replaces it ({message})", true},
    Words{Verdict::kDifferent, "{stored} pixels, now {now}", ""},
    Words{Verdict::kDifferent, "pixels differ; the reference does not say how it was made", ""},
    Words{Verdict::kDifferent, "{changed}", "{chosen}"},
    Words{Verdict::kDifferent, "another solver or camera is chosen", "same scene, {chosen}", true},
    Words{Verdict::kDifferent, "same scene, drawn by another version of Corda: {stored}, now {now}", ""},
    Words{Verdict::kDifferent, "same scene, drawn by another OpenGL: {stored}, now {now}", ""},
    Words{Verdict::kDifferent, "same scene, version and OpenGL, but pixels differ", ""},
    Words{Verdict::kPassed, "", "the same pixels, without a record of how they were made", true},
    Words{Verdict::kStale, "no scene asks for it", ""},
    Words{Verdict::kStale, "no scene asks for it", "it is no PNG, and --update --force removes it"},
    Words{Verdict::kStale, "no scene asks for it",
          "it has no record of how it was made, and --update --force removes it"},
};

const Words& words_of(const Cause& cause) {
    return kCauseWords.at(static_cast<std::size_t>(cause.kind));
}

/// Joins the texts that are not empty.
std::string joined(const std::string& first, const std::string& second) {
    return first + (first.empty() || second.empty() ? "" : "; ") + second;
}

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

const char* word_of(Verdict verdict) {
    constexpr std::array kWords{"passed", "different", "missing", "empty", "stale", "invalid"};
    return kWords.at(static_cast<std::size_t>(verdict));
}

Verdict Checked::verdict() const {
    return is_empty ? Verdict::kEmpty : words_of(cause).verdict;
}

std::string figures_text(const Checked& picture) {
    return picture.difference ? corda::figures_text(*picture.difference) : "";
}

CauseText cause_text(const Checked& picture) {
    const Cause& cause = picture.cause;
    const auto filled_in = [&](const char* text) {
        return fmt::format(
            fmt::runtime(text), fmt::arg("message", cause.message), fmt::arg("stored", cause.stored),
            fmt::arg("now", cause.now), fmt::arg("changed", changes_text(cause.changed)),
            fmt::arg("chosen", cause.chosen.empty() ? "" : "another choice: " + changes_text(cause.chosen)));
    };
    const Words& words = words_of(cause);
    CauseText text{.group = filled_in(words.group), .own = filled_in(words.own)};
    text.whole = words.is_alone ? text.own : joined(text.group, text.own);
    if (!picture.is_empty) return text;
    constexpr const char* kNothing = "nothing is in view";
    if (text.group.empty()) return {.group = kNothing, .own = "", .whole = kNothing};
    return {text.group, joined(kNothing, text.own), joined(kNothing, text.whole)};
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
