#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/gl/context.hpp"
#include "corda/media/format.hpp"
#include "corda/media/probe.hpp"

namespace corda::app {
namespace {

void print_contexts(const Console& console, const std::vector<gl::Attempt>& attempts) {
    console.result("Ways to OpenGL, in the order in which they are tried:");
    for (const gl::Attempt& attempt : attempts) {
        if (!attempt.info) {
            console.result(fmt::format("  no   {}: {}", attempt.platform, attempt.failure));
            continue;
        }
        const gl::ContextInfo& info = *attempt.info;
        console.result(fmt::format("  yes  {}: {} on the {}", attempt.platform, info.gl_renderer,
                                   info.software ? "CPU" : "GPU"));
        console.result(fmt::format("       OpenGL {} by {}; EGL {} by {}; frames up to {} pixels per side",
                                   info.gl_version, info.gl_vendor, info.egl_version, info.egl_vendor,
                                   info.max_texture_px));
    }
}

nlohmann::json to_json(const gl::Attempt& attempt) {
    nlohmann::json json = {{"platform", attempt.platform}, {"usable", attempt.info.has_value()}};
    if (!attempt.info) {
        json["reason"] = attempt.failure;
        return json;
    }
    const gl::ContextInfo& info = *attempt.info;
    json["gl_vendor"] = info.gl_vendor;
    json["gl_renderer"] = info.gl_renderer;
    json["gl_version"] = info.gl_version;
    json["egl_vendor"] = info.egl_vendor;
    json["egl_version"] = info.egl_version;
    json["max_texture_px"] = info.max_texture_px;
    json["software"] = info.software;
    return json;
}

/// The endings of the files that some usable encoder writes.
std::set<std::string_view> writable_endings(const std::vector<media::EncoderProbe>& encoders) {
    std::set<std::string_view> endings;
    for (const media::Format& format : media::formats()) {
        const bool is_usable = std::any_of(encoders.begin(), encoders.end(), [&](const auto& encoder) {
            return encoder.usable && encoder.name == format.codec;
        });
        if (is_usable) endings.insert(format.ending);
    }
    return endings;
}

ExitCode doctor(const Console& console) {
    const std::vector<gl::Attempt> attempts = gl::probe_contexts();
    const std::vector<media::EncoderProbe> encoders = media::probe_encoders();
    const bool has_gl = std::any_of(attempts.begin(), attempts.end(),
                                    [](const gl::Attempt& a) { return a.info.has_value(); });
    print_contexts(console, attempts);
    console.result("Encoders, each tried with a small picture:");
    for (const media::EncoderProbe& encoder : encoders) {
        console.result(encoder.usable ? fmt::format("  yes  {}", encoder.name)
                                      : fmt::format("  no   {}: {}", encoder.name, encoder.reason));
    }
    console.result(has_gl ? "This machine can draw."
                          : "This machine cannot draw: apt-get install libegl-mesa0 libgl1-mesa-dri");
    const std::set<std::string_view> written = writable_endings(encoders);
    std::set<std::string_view> missing;
    for (const media::Format& format : media::formats())
        if (!written.contains(format.ending)) missing.insert(format.ending);
    if (!written.empty()) console.result(fmt::format("It can write {}.", fmt::join(written, ", ")));
    if (!missing.empty()) {
        console.result(
            fmt::format("It cannot write {}: apt-get install libavcodec59", fmt::join(missing, ", ")));
    }
    nlohmann::json json = {{"schema", 1}, {"can_draw", has_gl}, {"can_write", written}};
    json["contexts"] = nlohmann::json::array();
    for (const gl::Attempt& attempt : attempts) json["contexts"].push_back(to_json(attempt));
    json["encoders"] = nlohmann::json::array();
    for (const media::EncoderProbe& encoder : encoders) {
        json["encoders"].push_back(
            {{"name", encoder.name}, {"usable", encoder.usable}, {"reason", encoder.reason}});
    }
    console.report(json);
    if (!has_gl) return ExitCode::kNoGl;
    return missing.empty() ? ExitCode::kOk : ExitCode::kEncoder;
}

}  // namespace

void add_doctor(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("doctor", "say what this machine can do, and why not");
    command->callback([&action] { action = doctor; });
}

}  // namespace corda::app
