// Measures the chapters of src/corda/study/README.md that need peers or campaigns, and writes them as `corda
// study` does. See tests/benchmark/run.sh.

#include <cstdio>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "benchmark/study/chapters.hpp"
#include "corda/core/basics.hpp"
#include "corda/report/report_folder.hpp"
#include "corda/study/study.hpp"

int main(int argc, char** argv) {
    using namespace corda;
    benchmark::Options options;
    std::string folder;
    std::vector<std::string> chapters{"challenge", "horizons"};
    CLI::App app{"measures XPBD beside Corda, and claimed beside observed horizons"};
    app.add_option("-o,--output", folder, "folder of the report")->required();
    app.add_option("--chapter", chapters, "only these: challenge, horizons")->delimiter(',');
    app.add_option("--repeats", options.repeats, "of each timed run");
    app.add_option("--scenes", options.scenes, "number of random chaotic scenes");
    CLI11_PARSE(app, argc, argv);
    try {
        report::ReportFolder writer(folder, {.force = true});
        report::Report report{"Corda: challenge and horizons", study::setting({options.repeats, 0.01}), {}};
        report.setting.back().second = fmt::format(
            "CPU time of one thread: the minimum of {} repeats of at least 10 ms, the methods in turns",
            options.repeats);
        for (const std::string& name : chapters) {
            report.chapters.push_back(name == "challenge" ? benchmark::challenge_chapter(options)
                                                          : benchmark::horizons_chapter(options));
            writer.add(report.chapters.back());
        }
        writer.finish(std::move(report));
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
