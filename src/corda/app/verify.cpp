#include "corda/media/verify/verify.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/text.hpp"
#include "corda/pipeline/provenance.hpp"

namespace corda::app {
namespace {

struct VerifyOptions {
    std::string path;
};

nlohmann::json to_json(const std::string& path, const media::VerifyReport& report, const Rational& speed) {
    return {{"schema", 1},
            {"file", path},
            {"ok", report.ok()},
            {"problems", report.problems},
            {"notes", report.notes},
            {"container", report.container},
            {"codec", report.codec},
            {"profile", report.profile},
            {"level", report.h264_level > 0 ? nlohmann::json(report.h264_level / 10.0) : nlohmann::json()},
            {"pixel_format", report.pixel_format},
            {"width", report.width_px},
            {"height", report.height_px},
            {"fps", report.fps.text()},
            {"speed", speed.text()},
            {"frames", report.frames},
            {"duration_s", report.duration_s.value()},
            {"duration_exact", report.duration_s.text()},
            {"range", report.range},
            {"matrix", report.matrix},
            {"primaries", report.primaries},
            {"transfer", report.transfer},
            {"chroma_location", report.chroma_location},
            {"faststart", report.faststart},
            {"alpha", report.alpha}};
}

/// The seconds of the (first) scene per second of the film; 1 for one that does not carry its scene.
Rational speed_of(const std::string& path) {
    try {
        Provenance made = read_provenance(path);
        while (!made.parts.empty()) made = Provenance(made.parts.front());
        return scene_of(made, path).video.speed;
    } catch (const Error& error) {
        if (error.code() != ExitCode::kUsage && error.code() != ExitCode::kInvalidScene) throw;
        return {1, 1};
    }
}

ExitCode verify(const Console& console, const VerifyOptions& options) {
    const std::string& path = options.path;
    const media::VerifyReport report = media::verify_in_child(path);
    const Rational speed = report.codec.empty() ? Rational{1, 1} : speed_of(path);
    if (!report.codec.empty()) {
        console.result(fmt::format(
            "{}: {}{} {}x{}, {} at {} per second, {:.6g} s{}", path,
            report.container == report.codec ? "" : report.container + " ", report.coding(), report.width_px,
            report.height_px, counted(report.frames, "frame"), report.fps.text(), report.duration_s.value(),
            speed == Rational{1, 1} ? "" : ", at speed " + speed.text()));
    }
    for (const std::string& note : report.notes) console.result("note: " + note);
    for (const std::string& problem : report.problems) console.result("problem: " + problem);
    if (report.ok()) console.result("ok");
    console.report(to_json(path, report, speed));
    return report.ok() ? ExitCode::kOk : ExitCode::kMismatch;
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "verify",
        "check the structure of a video of any format that render writes, its times and tags, that "
        "every frame decodes, and the colours of the first frame alone; exit 7 on a problem",
        verify);
    command.add_option("FILE", options.path, "video file")->required();
}

}  // namespace corda::app
