#include <fmt/format.h>

#include "commands.hpp"
#include "corda/core/error.hpp"

namespace corda::app {
namespace {

std::string size_setting(const std::string& text) {
    const auto cross = text.find('x');
    const auto is_number = [](const std::string& part) {
        return !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
    };
    const std::string width = text.substr(0, cross);
    const std::string height = cross == std::string::npos ? "" : text.substr(cross + 1);
    if (!is_number(width) || !is_number(height)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("--size {}: is not WIDTHxHEIGHT; write e.g. 1920x1080", text));
    }
    return fmt::format("video.size=[{},{}]", width, height);
}

}  // namespace

void SceneOptions::add_to(CLI::App& command, Need need) {
    command.add_option("SCENE", path, "scene file (TOML)")->required(need == Need::kRequired);
    // One value a flag: a value may have commas and brackets of its own.
    command
        .add_option("--set", settings, "put VALUE in the place of a key of the scene, e.g. rope[0].mass=2")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
}

void SceneOptions::add_shortcut(CLI::App& command, const std::string& name, const std::string& key,
                                const std::string& help) {
    command.add_option_function<std::string>(
        name, [this, key](const std::string& value) { settings.push_back(key + "=" + value); },
        help + " (--set " + key + ")");
}

void SceneOptions::add_size(CLI::App& command) {
    command
        .add_option_function<std::string>(
            "--size", [this](const std::string& value) { settings.push_back(size_setting(value)); },
            "picture size in pixels (--set video.size)")
        ->type_name("WxH");
}

void GlOptions::add_to(CLI::App& command) {
    command.add_option("--backend", backend, "way to OpenGL: auto, device, device:N, surfaceless or default")
        ->envname("CORDA_BACKEND");
    command.add_flag("--require-gpu", require_gpu, "refuse to draw on the CPU (exit 4)");
}

gl::ContextDef GlOptions::def() const {
    gl::ContextDef result = gl::ContextDef::parse(backend.empty() ? "auto" : backend);
    result.require_gpu = require_gpu;
    return result;
}

void report_gl(const Console& console, const gl::Context& context) {
    console.detail(fmt::format("drawing with {} ({}), OpenGL {}, by {}", context.info().gl_renderer,
                               context.info().gl_vendor, context.info().gl_version, context.platform()));
}

}  // namespace corda::app
