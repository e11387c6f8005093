#include "support/probe.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "support/command.hpp"

namespace corda::test {

VideoFacts probe(const std::string& path) {
    const CommandResult result =
        run_shell("ffprobe -v error -count_frames -of json -show_streams -show_format " + quoted(path));
    if (result.exit_code != 0 || !result.err.empty()) throw std::runtime_error(path + ": " + result.err);
    const auto json = nlohmann::json::parse(result.out);
    const auto& stream = json.at("streams").at(0);
    const auto text = [&stream](const char* key) { return stream.value(key, std::string("unknown")); };
    return {.frames = std::stoi(text("nb_read_frames")),
            .width_px = stream.at("width"),
            .height_px = stream.at("height"),
            .codec = text("codec_name"),
            .profile = text("profile"),
            .pixel_format = text("pix_fmt"),
            .colors = text("color_range") + " " + text("color_space") + " " + text("color_primaries") + " " +
                      text("color_transfer"),
            .chroma_location = text("chroma_location"),
            .duration_s = std::stod(json.at("format").value("duration", "0")),
            .tick_s = 1.0 / std::stod(text("time_base").substr(2))};
}

}  // namespace corda::test
