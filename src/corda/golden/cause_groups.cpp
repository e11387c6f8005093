#include <fmt/format.h>

#include <array>
#include <string>

#include "corda/golden/suite.hpp"

// The words of causes, and the groups in which pages and tables list the pictures.

namespace corda::golden {
namespace {

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

}  // namespace

std::string joined(const std::string& first, const std::string& second) {
    return first + (first.empty() || second.empty() ? "" : "; ") + second;
}

const char* word_of(Verdict verdict) {
    constexpr std::array kWords{"passed", "different", "missing", "empty", "stale", "invalid"};
    return kWords.at(static_cast<std::size_t>(verdict));
}

Verdict Checked::verdict() const {
    return is_empty ? Verdict::kEmpty : words_of(cause).verdict;
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

}  // namespace corda::golden
