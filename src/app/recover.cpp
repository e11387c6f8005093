#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/part_file.hpp"
#include "corda/media/chunks/finish_part.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct RecoverOptions {
    std::string part;
    std::string output;  ///< empty: the name without ".part"
    bool force = false;
};

/// "a.mp4" for "a.mp4.part". Another file is refused: a part is removed once its video is there.
std::string name_of(const std::string& part) {
    const std::string ending = part_path("");
    if (part.size() > ending.size() && part.ends_with(ending))
        return part.substr(0, part.size() - ending.size());
    throw Error(ExitCode::kUsage,
                fmt::format("'{}' does not end in {}; name the file that an interrupted render has left",
                            part, ending));
}

ExitCode recover(const Console& console, const RecoverOptions& options) {
    const std::string name = name_of(options.part);
    std::error_code failure;
    if (!std::filesystem::exists(options.part, failure)) {
        if (failure) fail_file("read", options.part, failure.value());
        throw Error(ExitCode::kIo,
                    fmt::format("there is no '{}', so there is nothing to recover", options.part));
    }
    const std::string output = options.output.empty() ? name : options.output;
    check_output(output, options.part, options.force);
    const media::RemuxResult result =
        media::recover_part(options.part, output, {.force = options.force}, !options.output.empty());
    const std::string frames = counted(result.frames, "frame");
    if (result.damaged) {
        console.warning(fmt::format("{} is damaged after {}, which were recovered", options.part, frames));
    } else if (result.truncated) {
        console.warning(fmt::format("{} ends in the middle of a chunk; the {} before it were recovered",
                                    options.part, frames));
    }
    console.info(fmt::format("{}; verified; {} {}", frames, options.part,
                             result.removed ? "was removed" : "stays as it is"));
    console.result(output);
    console.report({{"schema", 1},
                    {"output", output},
                    {"frames", result.frames},
                    {"truncated", result.truncated},
                    {"damaged", result.damaged},
                    {"removed", result.removed}});
    return ExitCode::kOk;
}

}  // namespace

void add_recover(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "recover",
        "make the part file of an interrupted render a video, without encoding it again", recover);
    command.add_option("PART", options.part, "part file, such as out.mp4.part")->required();
    command.add_option(
        "-o,--output", options.output,
        "video file, and the part stays; default: the name without .part, and the part is removed");
    command.add_flag("--force", options.force, "replace an existing output");
}

}  // namespace corda::app
