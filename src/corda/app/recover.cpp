// `corda recover` and `join`: videos of chunks, and of videos.

#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/chunks/join.hpp"
#include "corda/pipeline/provenance.hpp"

namespace corda::app {
namespace {

struct RecoverOptions {
    std::string parts;
    std::string output;  ///< empty: the name without ".parts"
    bool force = false;
};

ExitCode recover(const Console& console, const RecoverOptions& options) {
    const std::string ending = media::parts_path("");
    const std::string parts = options.parts.substr(0, options.parts.find_last_not_of('/') + 1);
    if (parts.size() <= ending.size() || !parts.ends_with(ending))
        throw_usage("'{}' does not end in {}; name the folder that an interrupted render has left",
                    options.parts, ending);
    std::error_code failure;
    if (!std::filesystem::exists(parts, failure)) {
        if (failure) fail_file("read", parts, failure.value());
        throw_error(ExitCode::kIo, "there is no '{}', so there is nothing to recover", parts);
    }
    const std::string output =
        options.output.empty() ? parts.substr(0, parts.size() - ending.size()) : options.output;
    check_output(output, "", options.force);
    const media::Recovered result =
        media::recover(parts, output, {.force = options.force}, !options.output.empty());
    const std::string frames = counted(result.frames, "frame");
    if (result.left_out > 0)
        console.warning(fmt::format("{}; the {} before it were recovered, and {} left out", result.gap,
                                    frames, counted(result.left_out, "chunk file")));
    console.info(fmt::format("{}; verified{}; {} {}", frames, result.gap.empty() ? "" : "; " + result.gap,
                             parts, result.removed ? "was removed" : "stays as it is"));
    console.result(output);
    console.report({{"schema", 1},
                    {"output", output},
                    {"frames", result.frames},
                    {"gap", result.gap},
                    {"truncated", result.left_out > 0},
                    {"damaged", result.is_damaged},
                    {"removed", result.removed}});
    return ExitCode::kOk;
}

struct JoinOptions {
    std::vector<std::string> parts;
    std::string output;
    bool force = false;
};

ExitCode join(const Console& console, const JoinOptions& options) {
    std::vector<Provenance> origins;
    for (const std::string& part : options.parts) {
        check_output(options.output, part, options.force);
        origins.push_back(read_provenance(part, OriginUse::kJoin));
    }
    const Provenance made = joined(origins);
    const std::string provenance = provenance_text(made);
    const nlohmann::json comment{
        {"corda", version()}, {"scene", made.name}, {kProvenanceKey, nlohmann::json::parse(provenance)}};
    const media::ChunkRun run = media::join_videos(options.parts, options.output, made.name, comment.dump(),
                                                   {.force = options.force});
    nlohmann::json parts = nlohmann::json::array();
    for (const media::ChunkFile& part : run.chunks)
        parts.push_back({{"file", part.path}, {"frames", part.frames}});
    if (const std::string reason = left_out_of(provenance); !reason.empty())
        console.warning(fmt::format("{} does not carry the scenes of all parts, because {}; keep the parts",
                                    options.output, reason));
    console.info(fmt::format("{} of {} videos; verified", counted(run.frames, "frame"), run.chunks.size()));
    console.result(options.output);
    console.report({{"schema", 1}, {"output", options.output}, {"frames", run.frames}, {"parts", parts}});
    return ExitCode::kOk;
}

}  // namespace

void add_join(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "join", "join videos one after the other, without encoding them again", join);
    command.add_option("FILES", options.parts, "two or more videos of equal size, rate and encoder settings")
        ->required()
        ->expected(-2);  // at least
    command.add_option("-o,--output", options.output, "video file: .mp4, .mov, .mkv or .webm")->required();
    command.add_flag("--force", options.force, "replace an existing output");
}

void add_recover(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "recover",
        "join the chunks of an interrupted render to a video, without encoding them again", recover);
    command.add_option("PARTS", options.parts, "folder of chunks, such as out.mp4.parts")->required();
    command.add_option(
        "-o,--output", options.output,
        "video file, and the folder stays; default: the name without .parts, and the folder is removed");
    command.add_flag("--force", options.force, "replace an existing output");
}

}  // namespace corda::app
