#include "support/decode_rgba.hpp"

#include <cstring>
#include <sstream>
#include <stdexcept>

#include "support/command.hpp"

namespace corda::test {
namespace {

std::string output_of(const std::string& command) {
    const CommandResult result = run_shell(command);
    if (result.exit_code != 0) throw std::runtime_error(command + ": " + result.err);
    return result.out;
}

}  // namespace

DecodedRgba decode_rgba(const std::string& path) {
    const std::string input = (path.ends_with(".webm") ? "-c:v libvpx-vp9 -i " : "-i ") + quoted(path);
    const bool is_av1 =
        path.ends_with(".webm") &&
        output_of("ffprobe -v error -show_entries stream=codec_name -of csv=p=0 " + quoted(path)) == "av1\n";
    const std::string source = is_av1 ? "-i " + quoted(path) : input;
    const std::string size =
        output_of("ffprobe -v error -show_entries stream=width,height -of csv=p=0:s=x " + quoted(path));
    int width = 0;
    int height = 0;
    char cross = 0;
    std::istringstream(size) >> width >> cross >> height;
    const std::string bytes =
        output_of("ffmpeg -v error " + source +
                  " -fps_mode passthrough -vf scale=flags=accurate_rnd+full_chroma_int,format=rgba "
                  "-f rawvideo -");
    DecodedRgba video;
    const std::size_t picture_bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
    for (std::size_t at = 0; picture_bytes > 0 && at + picture_bytes <= bytes.size(); at += picture_bytes)
        std::memcpy(video.pictures.emplace_back(width, height).data(), bytes.data() + at, picture_bytes);
    std::istringstream times(output_of("ffprobe -v error -show_entries frame=pts_time -of csv=p=0 " +
                                       quoted(path) + " | tr -d ,"));
    for (double time_s = 0.0; times >> time_s;) video.times_s.push_back(time_s);
    return video;
}

}  // namespace corda::test
