// Files of unknown origin: whatever they contain, the program ends with a defined exit code.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "corda/core/machine.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

using nlohmann::json;
using test::run_corda;
using test::run_shell;
using testing::HasSubstr;

class Untrusted : public testing::Test {
  protected:
    test::ScratchFolder folder_;
};

/// Number of processes with `word` in their command line.
int processes_with(const std::string& word) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc"))
        count += test::read_file(entry.path() / "cmdline").find(word) != std::string::npos ? 1 : 0;
    return count;
}

TEST_F(Untrusted, VideoOnWhichLibavAbortsIsDamaged) {
    const std::string path = folder_.file("a.mp4");
    const auto made = run_shell(
        "ffmpeg -v error -f lavfi -i testsrc=size=64x48:rate=25:duration=0.4 -c:v mpeg4 -bf 2 " + path);
    ASSERT_EQ(made.exit_code, 0) << made.err;
    std::string bytes = test::read_file(path);
    const std::size_t data = bytes.find("mdat");
    for (std::size_t i = data + 300; i < data + 1500; i += 100) bytes[i] = static_cast<char>(bytes[i] ^ 0x5a);
    test::write_file(path, bytes);
    const auto told = run_corda({"verify", path});
    EXPECT_EQ(told.exit_code, 7) << told.err;
    EXPECT_EQ(told.err, "");
    EXPECT_THAT(told.out, HasSubstr("the file is damaged"));  // with libav 5.1: decoding crashed (Aborted)
    const auto reported = run_corda({"verify", path, "--json"});
    EXPECT_EQ(reported.exit_code, 7);
    const json report = json::parse(reported.out);
    EXPECT_EQ(report["ok"], false);
    EXPECT_THAT(report["problems"].dump(), HasSubstr("the file is damaged"));
}

TEST_F(Untrusted, DecodingAnEndlessVideoStopsAtASignal) {
    const std::string pipe = folder_.file("pipe.mp4");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    for (const auto& [signal, code] : {std::pair{"INT", 130}, {"TERM", 143}}) {
        // timeout signals the program and then its group, or with --foreground the program alone.
        for (const char* const whom : {"", "--foreground "}) {
            const std::string command = std::string("timeout --preserve-status -k 9 -s ") + signal + " " +
                                        whom + "0.5 " + test::quoted(CORDA_PROGRAM) + " verify " + pipe;
            const double start_s = now_s();
            EXPECT_EQ(run_shell(command).exit_code, code) << command;
            EXPECT_LT(now_s() - start_s, 0.5 + 3.0) << command;  // measured: 0.6, at rest
            EXPECT_EQ(processes_with(pipe), 0) << command;
        }
    }
}

TEST_F(Untrusted, StoredSceneMayNotRequestMuchMemory) {
    const std::string scene = folder_.write("scene.toml",
                                            "schema = 1\nworld = { duration = 0.1 }\n[[rope]]\n"
                                            "hang = { links = 6, length = 1.0, angle_deg = 30.0 }\n"
                                            "[video]\nsize = [1024, 1024]\nfps = 10\n");
    const std::string video = folder_.file("a.mp4");
    ASSERT_EQ(run_corda({"render", scene, "-o", video}).exit_code, 0);
    std::string bytes = test::read_file(video);
    const std::size_t at = bytes.find("[1024, 1024]");
    ASSERT_NE(at, std::string::npos);
    test::write_file(video, bytes.replace(at, 12, "[8024, 8024]"));
    const std::string picture = folder_.file("a.png");
    const auto refused = run_corda({"still", "--from", video, "--at", "0", "-o", picture});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.err, HasSubstr("8024x8024 pixels, which take some 0.8 GB to draw"));
    EXPECT_THAT(refused.err, HasSubstr("--size 8024x8024"));
    EXPECT_EQ(run_corda({"still", "--from", video, "--at", "0", "-o", picture, "--size", "64x64"}).exit_code,
              0);
    EXPECT_EQ(run_corda({"still", "--from", video, "--at", "0", "-o", folder_.file("b.png"), "--size",
                         "8024x8024", "--dry-run"})
                  .exit_code,
              0);
}

TEST_F(Untrusted, VerifyStatesItsLimits) {
    const std::string scene = folder_.write("scene.toml",
                                            "schema = 1\nworld = { duration = 0.2 }\n[[rope]]\n"
                                            "hang = { links = 6, length = 1.0, angle_deg = 30.0 }\n"
                                            "[video]\nsize = [64, 64]\nfps = 30\n");
    const std::string video = folder_.file("out.mp4");
    ASSERT_EQ(run_corda({"render", scene, "-o", video}).exit_code, 0);
    EXPECT_THAT(run_corda({"verify", video}).out, HasSubstr("of the first frame alone"));
    EXPECT_THAT(run_corda({"verify", "--help"}).out, HasSubstr("colours of the first"));
}

}  // namespace
}  // namespace corda
