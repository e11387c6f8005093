// Renders that are killed: no video is there in part, and a sequence of pictures goes on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/media/defs.hpp"
#include "support/command.hpp"
#include "support/decode_rgba.hpp"

namespace corda {
namespace {

using test::quoted;
using test::read_file;
using test::run_corda;
using test::run_shell;
using testing::HasSubstr;

const char* const kSceneOfKills = R"(schema = 1
[world]
duration = 2
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 50.0 }
[solver]
method = "exact"
[video]
size = [480, 270]
fps = 60
)";

class Killed : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
    [[nodiscard]] std::string render(const std::string& output, const std::string& more = "") const {
        return quoted(CORDA_PROGRAM) + " render " + quoted(scene_) + " -q -o " + quoted(file(output)) + " " +
               more;
    }

    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfKills);
};

/// A few kills, or a hundred with CORDA_TEST_LONG.
TEST_F(Killed, AtAnyMomentAVideoIsTheOldOneOrWhole) {
    ASSERT_EQ(run_shell(render("whole.mp4")).exit_code, 0);
    const std::string whole = read_file(file("whole.mp4"));
    const int kills = std::getenv("CORDA_TEST_LONG") != nullptr ? 100 : 6;
    std::mt19937 random(20261123);  // NOLINT(cert-msc51-cpp): the same kills on every run
    std::uniform_real_distribution<double> moment_s(0.0, 0.6);
    for (int i = 0; i < kills; ++i) {
        test::write_file(file("a.mp4"), "precious");
        const double after_s = moment_s(random);
        // From the first byte of the video on in half of the cases.
        const std::string from = i % 2 == 0 ? test::wait_until("ls " + file("a.mp4") + ".*.tmp") : "";
        static_cast<void>(run_shell(render("a.mp4", "--force") + " & pid=$!; " + from + "sleep " +
                                    std::to_string(after_s) + "; kill -KILL $pid; wait $pid"));
        const std::string found = read_file(file("a.mp4"));
        EXPECT_TRUE(found == "precious" || found == whole) << after_s;
    }
}

TEST_F(Killed, ASequenceOfPicturesGoesOnWithThoseThatAreThere) {
    ASSERT_EQ(run_shell(render("whole/%03d.png")).exit_code, 0);
    static_cast<void>(run_shell(render("frames/%03d.png") + " & pid=$!; " +
                                test::wait_until("test -e " + file("frames/004.png")) +
                                "kill -KILL $pid; wait $pid; rm -f " + file("frames") + "/*.tmp"));
    // Two machines share the rest; then all are there.
    for (const char* const part : {"0:70", "70:120"})
        EXPECT_EQ(run_shell(render("frames/%03d.png", std::string("--resume --frames ") + part)).exit_code,
                  0);
    EXPECT_EQ(run_shell("diff -r " + file("frames") + " " + file("whole")).exit_code, 0);
    const auto none = run_corda({"render", scene_, "-o", file("frames/%03d.png"), "--resume", "--json"});
    EXPECT_EQ(none.exit_code, 0) << none.err;
    EXPECT_EQ(nlohmann::json::parse(none.out).at("kept_frames"), 120);
}

TEST_F(Killed, PicturesOfAnotherSceneAreRefusedAndVideosAreNotResumed) {
    ASSERT_EQ(run_shell(render("frames/%03d.png", "--frames 0:3")).exit_code, 0);
    const auto other = run_shell(render("frames/%03d.png", "--resume --frames 0:3 --set 'rope[0].mass=2'"));
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_THAT(other.err, HasSubstr("frames/000.png' is another picture: "));
    EXPECT_EQ(run_shell(render("frames/%03d.png", "--resume --force --frames 0:3 --set 'rope[0].mass=2'"))
                  .exit_code,
              0);
    const auto video = run_shell(render("a.mp4", "--resume"));
    EXPECT_EQ(video.exit_code, 2);
    EXPECT_THAT(video.err, HasSubstr("-o frames/%06d.png"));
}

TEST_F(Killed, WhatWasRemovedNamesWhatReplacesIt) {
    for (const auto& [arguments, words] : std::vector<std::pair<std::vector<std::string>, std::string>>{
             {{"recover", "a.mp4.parts"},
              "the command \"recover\" was removed; render a long film as pictures"},
             {{"report", scene_, "-o", "a"},
              "the command \"report\" was removed; use python3 -m corda report"},
             {{"join", "a.mp4", "b.mp4", "-o", "c.mp4"},
              "the command \"join\" was removed; join videos by ffmpeg"},
             {{"study", scene_, "-o", "a"},
              "the command \"study\" was removed; run python3 tests/benchmark/study.py"},
             {{"sweep", "sweep.toml", "-o", "data"},
              "the command \"sweep\" was removed; use python3 -m corda sweep"},
             {{"help", "verify"}, "\"verify\" was removed; render checks each video"},
             {{"render", scene_, "-o", "a.mp4", "--shard", "0/2"},
              "the option --shard was removed; give each"},
             {{"render", scene_, "-o", "a.mp4", "--verify=full"},
              "the option --verify was removed; render checks"}}) {
        const auto refused = run_corda(arguments);
        EXPECT_EQ(refused.exit_code, 2);
        EXPECT_THAT(refused.err, HasSubstr(words));
    }
}

// The command of src/corda/media/README.md.
TEST_F(Killed, PicturesBecomeAVideoByTheDocumentedCommand) {
    const std::string page = read_file(CORDA_EXAMPLES "/../src/corda/media/README.md");
    const std::size_t begin = page.find("ffmpeg -framerate 60");
    ASSERT_NE(begin, std::string::npos);
    const std::string command = page.substr(begin, page.find("\n```", begin) - begin);
    ASSERT_EQ(run_shell(render("frames/%06d.png", "--frames 0:5")).exit_code, 0);
    const auto made = run_shell("cd " + folder_.path() + " && " + command + " -v error");
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const auto probe = run_shell("ffprobe -v error -of json -show_streams -count_packets " + file("out.mp4"));
    const auto stream = nlohmann::json::parse(probe.out)["streams"][0];
    EXPECT_EQ(stream["nb_read_packets"], "5");
    EXPECT_EQ(stream["r_frame_rate"], "60/1");
    EXPECT_EQ(stream["pix_fmt"], "yuv420p");
    EXPECT_EQ(stream["color_range"], "tv");
    EXPECT_EQ(stream["color_space"], "bt709");
    EXPECT_EQ(stream["color_primaries"], "bt709");
    EXPECT_EQ(stream["color_transfer"], "iec61966-2-1");
    // The ground in a corner.
    const Image drawn = read_png(file("frames/000000.png"));
    const Image shown = test::decode_rgba(file("out.mp4")).pictures.at(0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown.pixel(8, 8)[c], drawn.pixel(8, 8)[c], 2.0) << c;
}

}  // namespace
}  // namespace corda
