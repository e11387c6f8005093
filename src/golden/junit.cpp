#include <fmt/format.h>

#include "corda/core/markup.hpp"
#include "corda/golden/suite.hpp"

namespace corda::golden {
namespace {

std::string case_xml(const Checked& picture) {
    std::string xml = fmt::format("    <testcase classname=\"{}\" name=\"{}\"", markup_text(picture.scene),
                                  markup_text(picture.name));
    if (!picture.failed()) return xml + "/>\n";
    const std::string why = picture.verdict == Verdict::kMissing ? "there is no reference" : picture.cause;
    return xml + fmt::format(">\n      <failure message=\"{}\"/>\n    </testcase>\n", markup_text(why));
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
            failures += pictures[i].failed() ? 1 : 0;
        }
        suites += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">\n{}  </testsuite>\n",
                              scene.empty() ? "stale" : markup_text(scene), tests, failures, cases);
    }
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" + suites + "</testsuites>\n";
}

}  // namespace corda::golden
