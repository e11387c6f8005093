// tests/benchmark/run.sh video: renders beside x264 alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace corda {
namespace {

using testing::HasSubstr;

/// Runs the benchmark; `environment` is put before it.
test::CommandResult run_benchmark(const std::vector<std::string>& arguments,
                                  const std::string& environment = "") {
    std::string command = environment + " " CORDA_BENCHMARK_VIDEO;
    for (const std::string& argument : arguments) command += " '" + argument + "'";
    return test::run_shell(command);
}

TEST(VideoBenchmark, MeasuresEachSizeAndPresetBesideTheEncoderAlone) {
    const test::ScratchFolder folder;
    const auto bench = run_benchmark({"--size", "320x180,256x144", "--preset", "ultrafast,veryfast",
                                      "--frames", "70", "--repeats", "2", "--set", "video.jobs=2", "--json"},
                                     "TMPDIR=" + folder.path());
    ASSERT_EQ(bench.exit_code, 0) << bench.err;
    const auto json = nlohmann::json::parse(bench.out);
    ASSERT_EQ(json.at("cases").size(), 4U);
    EXPECT_EQ(json["cases"][1]["preset"], "veryfast");
    EXPECT_EQ(json["cases"][2]["width"], 256);
    for (const auto& one : json["cases"]) {
        EXPECT_EQ(one.at("frames"), 70);
        EXPECT_GT(one.at("fps"), 0.0);
        EXPECT_GT(one.at("encoder_fps"), 0.0);
        EXPECT_GE(one.at("ratio").at("largest"), one.at("ratio_to_encoder"));
        EXPECT_LE(one.at("ratio").at("least"), one.at("ratio_to_encoder"));
        EXPECT_GT(one.at("peak_rss_mib"), one.at("encoder_rss_mib"));
        EXPECT_EQ(one.at("encoder_pictures"), 70);
        std::string names;
        for (const auto& stage : one.at("stages")) names += stage.at("name").get<std::string>() + " ";
        EXPECT_EQ(names, "simulate open OpenGL draw convert encode end and check ");
    }
    EXPECT_TRUE(folder.files().empty());  // the videos are removed
}

TEST(VideoBenchmark, TellsInWordsAndTakesAScene) {
    const test::ScratchFolder folder;
    const std::string scene = folder.write("a.toml", "schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0]]\n");
    const auto bench = run_benchmark(
        {scene, "--set", "world.duration=0.2", "--size", "128x128", "--preset", "medium", "--repeats", "1"});
    EXPECT_EQ(bench.exit_code, 0) << bench.err;
    EXPECT_THAT(bench.out, HasSubstr("128x128 medium: "));
    EXPECT_THAT(bench.out, HasSubstr("x264 alone"));
}

TEST(VideoBenchmark, ComparesPresetsAndCodecs) {
    const auto bench = run_benchmark({"--encodings", "--size", "320x180", "--frames", "12", "--json"});
    ASSERT_EQ(bench.exit_code, 0) << bench.err;
    const auto json = nlohmann::json::parse(bench.out);
    double default_db = 0.0;
    double full_color_db = 0.0;
    for (const auto& one : json.at("encodings")) {
        EXPECT_EQ(one.at("frames"), 12);
        EXPECT_GT(one.at("bytes"), 1000);
        EXPECT_GT(one.at("ms_per_frame"), 0.0);
        EXPECT_GT(one.at("edge_ssim"), 0.97) << one;  // 0.980 of the largest crf
        EXPECT_LE(one.at("edge_ssim"), 1.0);
        if (one.at("codec") != "h264" || one.at("preset") != "veryfast" || one.at("crf") != 16) continue;
        const double db = one.at("edge_psnr_db");
        (one.at("pixels") == "yuv444p" ? full_color_db : default_db) = db;
    }
    EXPECT_GT(default_db, 23.0);                 // 25.3
    EXPECT_GT(full_color_db, default_db + 5.0);  // 32.7
}

TEST(VideoBenchmark, RefusesBeforeItMeasures) {
    EXPECT_EQ(run_benchmark({"--size", "320x181"}).exit_code, 2);
    EXPECT_EQ(run_benchmark({"--size", "large"}).exit_code, 2);
    EXPECT_EQ(run_benchmark({"--preset", "quick"}).exit_code, 3);
    EXPECT_NE(run_benchmark({"--frames", "0"}).exit_code, 0);
    const auto other_codec = run_benchmark({"--set", "video.codec=h265"});
    EXPECT_EQ(other_codec.exit_code, 2);
    EXPECT_THAT(other_codec.err, HasSubstr("--set video.codec=h264"));
}

TEST(VideoBenchmark, EndsAtASignalAndKeepsNothing) {
    const test::ScratchFolder folder;
    const auto kept =
        test::run_shell("TMPDIR=" + folder.path() +
                        " timeout --preserve-status -s INT 2 " CORDA_BENCHMARK_VIDEO " --size 1920x1080");
    EXPECT_EQ(kept.exit_code, 130) << kept.err;
    EXPECT_THAT(kept.err, HasSubstr("interrupted"));
    EXPECT_TRUE(folder.files().empty());
}

}  // namespace
}  // namespace corda
