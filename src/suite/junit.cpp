#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/suite/suite.hpp"

namespace corda::suite {
namespace {

std::string escaped(const std::string& text) {
    std::string xml;
    for (const char c : printable(text)) {
        switch (c) {
            case '&':
                xml += "&amp;";
                break;
            case '<':
                xml += "&lt;";
                break;
            case '>':
                xml += "&gt;";
                break;
            case '"':
                xml += "&quot;";
                break;
            default:
                xml += c;
        }
    }
    return xml;
}

bool is_failure(const Checked& picture) {
    return picture.verdict != Verdict::kPassed && !picture.changed;
}

std::string case_xml(const Checked& picture) {
    std::string xml = fmt::format("    <testcase classname=\"{}\" name=\"{}\"", escaped(picture.scene),
                                  escaped(picture.name));
    if (!is_failure(picture)) return xml + "/>\n";
    const std::string why = picture.verdict == Verdict::kMissing ? "there is no reference" : picture.cause;
    return xml + fmt::format(">\n      <failure message=\"{}\"/>\n    </testcase>\n", escaped(why));
}

}  // namespace

std::string junit_xml(const SuiteResult& result) {
    std::string suites;
    const auto& pictures = result.pictures;
    for (std::size_t i = 0; i < pictures.size();) {
        const std::string& scene = pictures[i].scene;
        std::string cases;
        int tests = 0;
        int failures = 0;
        for (; i < pictures.size() && pictures[i].scene == scene; ++i) {
            cases += case_xml(pictures[i]);
            ++tests;
            failures += is_failure(pictures[i]) ? 1 : 0;
        }
        suites += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">\n{}  </testsuite>\n",
                              scene.empty() ? "stale" : escaped(scene), tests, failures, cases);
    }
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" + suites + "</testsuites>\n";
}

}  // namespace corda::suite
