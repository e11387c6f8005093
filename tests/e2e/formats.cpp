#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "support/command.hpp"
#include "support/probe.hpp"

namespace {

using corda::test::read_file;
using corda::test::run_corda;
using corda::test::run_shell;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kFormatScene = R"(schema = 1
[world]
duration = 1.5
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 40.0 }
[video]
size = [96, 64]
fps = 25
)";

class FormatsOfRender : public testing::Test {
  protected:
    /// Runs `corda render` with these arguments after the scene; PROGRAM and DIR are replaced.
    [[nodiscard]] corda::test::CommandResult render(const std::string& output,
                                                    std::vector<std::string> more = {}) const {
        std::vector<std::string> words{"render", scene_, "-o", output};
        words.insert(words.end(), more.begin(), more.end());
        return run_corda(words);
    }
    [[nodiscard]] std::string command(const std::string& more) const {
        return corda::test::quoted(CORDA_PROGRAM) + " render " + scene_ + " " + more;
    }

    corda::test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kFormatScene);
};

TEST_F(FormatsOfRender, HaveTheSameBytesForAnyNumberOfJobs) {
    for (const auto& [ending, codec] :
         std::vector<std::pair<std::string, std::string>>{{"mp4", "libx264"},
                                                          {"mp4", "libx265"},
                                                          {"mp4", "libsvtav1"},
                                                          {"webm", "libvpx-vp9"},
                                                          {"webm", "libaom-av1"},
                                                          {"mov", "prores_ks"},
                                                          {"mkv", "ffv1"},
                                                          {"gif", ""}}) {
        std::string first;
        for (const char* const jobs : {"1", "2", "8"}) {
            const std::string path = folder_.file(jobs + ("." + ending));
            std::vector<std::string> more{"--jobs", jobs, "--force"};
            if (!codec.empty()) more.insert(more.end(), {"--codec", codec});
            if (codec == "libx265") more.insert(more.end(), {"--size", "96x66"});
            if (codec == "libsvtav1") more.insert(more.end(), {"--preset", "12"});
            const auto result = render(path, more);
            ASSERT_EQ(result.exit_code, 0) << result.err;
            EXPECT_EQ(result.out, path + "\n");
            if (first.empty()) first = read_file(path);
            EXPECT_EQ(read_file(path), first) << path << " " << codec;
        }
        EXPECT_FALSE(first.empty()) << ending;
    }
}

TEST_F(FormatsOfRender, PicturesEqualStillsByteForByte) {
    const auto result = render(folder_.file("frames/f%03d.png"), {"--frames", "10:14", "--jobs", "2"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, folder_.file("frames/f%03d.png") + "\n");
    for (const int k : {10, 11, 12, 13}) {
        const std::string number = std::to_string(k);
        const std::string still = folder_.file("still" + number + ".png");
        ASSERT_EQ(run_corda({"still", scene_, "--frame", number, "-o", still}).exit_code, 0);
        EXPECT_EQ(read_file(folder_.file("frames/f0" + number + ".png")), read_file(still)) << k;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_.file("frames/f014.png")));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.file("frames")), {}), 4);

    const auto again = render(folder_.file("frames/f%03d.png"), {"--frames", "13:15"});
    EXPECT_EQ(again.exit_code, 6);
    EXPECT_THAT(again.err, HasSubstr("f013.png' exists"));
    EXPECT_FALSE(std::filesystem::exists(folder_.file("frames/f014.png")));
    EXPECT_EQ(render(folder_.file("frames/f%03d.png"), {"--frames", "13:15", "--force"}).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(folder_.file("frames/f014.png")));

    for (const char* const beside : {"9:10", "15:16"}) {
        const auto mixed = render(folder_.file("frames/f%03d.png"), {"--frames", beside, "--size", "34x34"});
        EXPECT_EQ(mixed.exit_code, 2) << beside;
        EXPECT_THAT(mixed.err, HasSubstr("and these frames would have 34x34; give --size ")) << beside;
    }
    const std::vector<std::string> forced{"--frames", "15:16", "--size", "34x34", "--force"};
    EXPECT_EQ(render(folder_.file("frames/f%03d.png"), forced).exit_code, 0);
}

TEST_F(FormatsOfRender, WarnsAboutPicturesOfALongerFilm) {
    const std::string pictures = folder_.file("f/%02d.png");
    EXPECT_EQ(render(pictures, {"--duration", "0.4"}).exit_code, 0);
    const auto shorter = render(pictures, {"--duration", "0.2", "--force"});
    EXPECT_EQ(shorter.exit_code, 0);
    EXPECT_THAT(shorter.err, testing::HasSubstr("f/05.png exists but is not part of this render"));
    for (const char* const frames : {"0:5", "3:"})
        EXPECT_THAT(render(pictures, {"--duration", "0.4", "--frames", frames, "--force"}).err,
                    testing::Not(testing::HasSubstr("not part of this render")));
}

TEST_F(FormatsOfRender, StandardOutputContainsOnlyThePictures) {
    const std::string mkv = folder_.file("a.mkv");
    ASSERT_EQ(render(mkv).exit_code, 0);
    // ffmpeg reads the 38 frames from the pipe, in the file's order and at its times.
    const auto piped =
        run_shell(command("-o - --pix rgba --jobs 2 | ffmpeg -v error -f rawvideo -pix_fmt rgba -s 96x64 "
                          "-r 25 -i - -f framemd5 -"));
    const auto file = run_shell("ffmpeg -v error -i " + mkv + " -pix_fmt rgba -f framemd5 -");
    const auto frames_of = [](std::string text) {
        return text.substr(std::min(text.size(), text.find("\n0,")));
    };
    EXPECT_EQ(std::count(piped.out.begin(), piped.out.end(), '\n'), 38 + 10) << piped.out;
    EXPECT_NE(frames_of(file.out), "");
    EXPECT_EQ(frames_of(piped.out), frames_of(file.out));

    const auto y4m = run_shell(command("-o - -v > ") + folder_.file("a.y4m"));
    EXPECT_EQ(y4m.exit_code, 0) << y4m.err;
    const std::string bytes = read_file(folder_.file("a.y4m"));
    EXPECT_THAT(bytes.substr(0, bytes.find('\n')), HasSubstr("YUV4MPEG2 W96 H64 F25:1 Ip A1:1 C420mpeg2"));
    EXPECT_EQ(bytes.size(), bytes.find('\n') + 1 + 38 * (6 + 96 * 64 * 3 / 2));
    EXPECT_EQ(corda::test::probe(folder_.file("a.y4m")).frames, 38);
}

TEST_F(FormatsOfRender, AClosedPipeEndsRenderQuietly) {
    for (const char* const jobs : {"1", "2"}) {
        const auto result = run_shell("set -o pipefail; " + command("-o - -q --duration 60 --jobs ") + jobs +
                                      " | head -c 1000 | wc -c");
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_EQ(result.out, "1000\n");
        EXPECT_EQ(result.err, "");
    }
}

TEST_F(FormatsOfRender, AClosedPipeEndsSimulateQuietly) {
    const auto result = run_shell("set -o pipefail; " + corda::test::quoted(CORDA_PROGRAM) + " simulate " +
                                  scene_ + " -o - -q --duration 600 | head -c 1000 | wc -c");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "1000\n");
    EXPECT_EQ(result.err, "");
}

TEST_F(FormatsOfRender, PadMakesOddSidesEven) {
    const auto refused = render(folder_.file("odd.mp4"), {"--size", "97x63"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("use a width of 96 or 98 and a height of 62 or 64 (render --pad"));
    const auto padded = render(folder_.file("even.mp4"), {"--size", "97x63", "--pad", "--json"});
    EXPECT_EQ(padded.exit_code, 0) << padded.err;
    const auto figures = nlohmann::json::parse(padded.out);
    EXPECT_EQ(figures.at("width"), 98);
    EXPECT_EQ(figures.at("height"), 64);
}

TEST_F(FormatsOfRender, JsonAndAVideoCannotShareStandardOutput) {
    const auto result = render("-", {"--json"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("give the video a file name"));
}

TEST_F(FormatsOfRender, WithoutX264AnotherEncoderIsUsedAndNamed) {
    const auto run = [](const std::string& arguments) {
        return run_shell(CORDA_WITHOUT_X264 " " + arguments);
    };
    const std::string video = folder_.file("a.mp4");
    const auto result = run("render " + scene_ + " -o " + video + " --json");
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err,
                HasSubstr("libx264, the default of .mp4, is not available: encoding with libsvtav1 (AV1)"));
    EXPECT_EQ(json::parse(result.out)["encoder"], "libsvtav1");
    EXPECT_EQ(corda::test::probe(video).codec, "av1");

    const auto asked = run("render " + scene_ + " -o " + folder_.file("b.mp4") + " --codec libx264");
    EXPECT_EQ(asked.exit_code, 5);
    EXPECT_THAT(asked.err, HasSubstr("this Corda was built without libx264"));

    const auto doctor = run("doctor");
    EXPECT_EQ(doctor.exit_code, 0);
    EXPECT_THAT(doctor.out, HasSubstr("  yes  .mp4: libsvtav1, libx265"));
    EXPECT_THAT(doctor.out, HasSubstr("without libx264: this Corda was built without libx264"));
}

TEST_F(FormatsOfRender, AnUnavailableHardwareEncoderIsRefusedBeforeDrawing) {
    const auto result = render(folder_.file("a.mp4"), {"--codec", "nvenc", "--size", "320x192", "--dry-run"});
    const bool has_chip = result.exit_code == 0;
    EXPECT_EQ(result.exit_code, has_chip ? 0 : 5);
    EXPECT_EQ(result.err.find("h264_nvenc does not open") == std::string::npos, has_chip) << result.err;
}

}  // namespace
