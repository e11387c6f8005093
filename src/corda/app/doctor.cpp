#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/gl/context.hpp"
#include "corda/gl/driver.hpp"
#include "corda/media/encode/probe.hpp"
#include "corda/media/format/format.hpp"
#include "corda/render/frame_renderer.hpp"

namespace corda::app {
namespace {

void print_contexts(const Console& console, const std::vector<gl::Attempt>& attempts) {
    console.result("Ways to OpenGL, in the order in which they are tried:");
    for (const gl::Attempt& attempt : attempts) {
        if (!attempt.is_usable()) {
            console.result(fmt::format("  no   {}: {}", attempt.platform, attempt.failure));
            continue;
        }
        const gl::ContextInfo& info = *attempt.info;
        console.result(fmt::format("  yes  {}: {} on the {}", attempt.platform, info.gl_renderer,
                                   info.software ? "CPU" : "GPU"));
        console.result(fmt::format("       OpenGL {} by {}; EGL {} by {}; frames up to {} pixels per side",
                                   info.gl_version, info.gl_vendor, info.egl_version, info.egl_vendor,
                                   info.max_texture_px));
        console.result("       its test picture equals the plain C++ reference in every byte");
    }
}

nlohmann::json to_json(const gl::Attempt& attempt) {
    nlohmann::json json = {{"platform", attempt.platform}, {"usable", attempt.is_usable()}};
    if (!attempt.is_usable()) json["reason"] = attempt.failure;
    if (!attempt.info) return json;
    const gl::ContextInfo& info = *attempt.info;
    json["gl_vendor"] = info.gl_vendor;
    json["gl_renderer"] = info.gl_renderer;
    json["gl_version"] = info.gl_version;
    json["egl_vendor"] = info.egl_vendor;
    json["egl_version"] = info.egl_version;
    json["max_texture_px"] = info.max_texture_px;
    json["software"] = info.software;
    json["equals_reference"] = attempt.is_usable();
    return json;
}

/// Available encoders of an ending, and missing ones.
struct Writable {
    std::string ending;
    std::vector<std::string> usable;
    std::vector<std::string> missing;  ///< with reasons
};

std::vector<Writable> writable(const std::vector<media::EncoderProbe>& encoders) {
    std::vector<Writable> list;
    for (const media::EncoderProbe& encoder : encoders) {
        if (list.empty() || list.back().ending != encoder.ending) list.push_back({encoder.ending, {}, {}});
        if (encoder.reason.empty())
            list.back().usable.push_back(encoder.name);
        else
            list.back().missing.push_back(fmt::format("{}: {}", encoder.name, encoder.reason));
    }
    return list;
}

void print_formats(const Console& console, const std::vector<Writable>& formats) {
    console.result("Formats of videos, each encoder tried with a small picture, the default first:");
    for (const Writable& format : formats) {
        console.result(format.usable.empty()
                           ? fmt::format("  no   {}", format.ending)
                           : fmt::format("  yes  {}: {}", format.ending, fmt::join(format.usable, ", ")));
        for (const std::string& missing : format.missing)
            console.result(fmt::format("       without {}", missing));
    }
}

ExitCode doctor(const Console& console) {
    const std::vector<media::EncoderProbe> encoders = media::probe_encoders();
    const std::vector<gl::Attempt> attempts =
        gl::probe_contexts([](const gl::Context& context) { render::check_driver(context); });
    const bool has_gl = std::ranges::any_of(attempts, &gl::Attempt::is_usable);
    const bool is_temporary =
        std::ranges::any_of(attempts, [](const gl::Attempt& a) { return a.code == ExitCode::kTemporary; });
    print_contexts(console, attempts);
    const std::vector<Writable> formats = writable(encoders);
    print_formats(console, formats);
    console.result(has_gl ? "This machine can draw."
                          : fmt::format("This machine cannot draw. {}", gl::kDriverRemedy));
    std::vector<std::string> written;
    std::vector<std::string> missing;
    for (const Writable& format : formats)
        (format.usable.empty() ? missing : written).push_back(format.ending);
    if (!written.empty()) console.result(fmt::format("It can write {}.", fmt::join(written, ", ")));
    const bool lacks_resources = std::ranges::any_of(encoders, &media::EncoderProbe::is_temporary);
    if (!missing.empty()) {
        console.result(fmt::format("It cannot write {}{}", fmt::join(missing, ", "),
                                   lacks_resources
                                       ? " for now, for the reasons above"
                                       : fmt::format(": apt-get install {}", media::libavcodec_package())));
    }
    nlohmann::json json = {{"schema", 1}, {"can_draw", has_gl}, {"can_write", written}};
    json["contexts"] = nlohmann::json::array();
    for (const gl::Attempt& attempt : attempts) json["contexts"].push_back(to_json(attempt));
    json["encoders"] = nlohmann::json::array();
    for (const media::EncoderProbe& encoder : encoders) {
        json["encoders"].push_back({{"ending", encoder.ending},
                                    {"name", encoder.name},
                                    {"usable", encoder.reason.empty()},
                                    {"reason", encoder.reason}});
    }
    console.report(json);
    if (!has_gl) return is_temporary ? ExitCode::kTemporary : ExitCode::kNoGl;
    if (lacks_resources) return ExitCode::kTemporary;
    return missing.empty() ? ExitCode::kOk : ExitCode::kEncoder;
}

}  // namespace

void add_doctor(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("doctor", "show what works on this machine, and why the rest does not");
    command->callback([&action] { action = doctor; });
}

}  // namespace corda::app
