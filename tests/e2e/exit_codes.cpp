// Every exit code, from a real run of the program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "support/command.hpp"
#include "support/probe.hpp"

namespace corda {
namespace {

using test::run_corda;
using test::run_shell;
using test::ScratchFolder;
using testing::HasSubstr;

const char* const kSceneOfExitCodes = R"(schema = 1
[world]
duration = 0.2
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 30.0 }
[video]
size = [64, 64]
fps = 30
)";

class ExitCodes : public testing::Test {
  protected:
    ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfExitCodes);
    std::string video_ = folder_.file("out.mp4");
};

TEST_F(ExitCodes, ZeroForSuccess) {
    const auto result = run_corda({"render", scene_, "-o", video_});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, video_ + "\n");
    EXPECT_EQ(run_corda({"--help"}).exit_code, 0);
    EXPECT_EQ(run_corda({"render", "--help"}).exit_code, 0);
}

TEST_F(ExitCodes, ZeroForARepeatedOptionWhoseLastValueCounts) {
    const auto result = run_corda({"render", scene_, "-o", video_, "--size", "64by64", "--frames", "0:9",
                                   "--size", "32x16", "--frames", "0:1"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("; 1 frame of 32x16 at"));
}

TEST_F(ExitCodes, HelpPrintsThemAll) {
    const auto result = run_corda({"help", "codes"});
    for (const char* row : {"0  success", "2  usage", "3  invalid scene", "4  no usable OpenGL", "5  codec",
                            "6  input/output", "7  compare or golden found", "8  the simulation diverged",
                            "75  out of memory", "130  interrupted", "143  terminated"}) {
        EXPECT_THAT(result.out, HasSubstr(row));
    }
}

TEST_F(ExitCodes, SevenForEmptyPicturesWithFailEmpty) {
    const std::vector<std::string> away{"--set", "camera.center=[100, 0]", "--set", "camera.height=2"};
    const auto run = [&](std::vector<std::string> arguments, const std::vector<std::string>& more) {
        arguments.insert(arguments.end(), more.begin(), more.end());
        arguments.insert(arguments.end(), {"--json", "--force"});
        return run_corda(arguments);
    };
    const std::vector<std::string> still{"still", scene_, "--at", "0", "-o", folder_.file("a.png")};
    const std::vector<std::string> render{"render", scene_, "-o", video_, "--size", "64x64"};
    for (const auto& command : {still, render}) {
        const auto fitted = run(command, {"--fail-empty"});
        EXPECT_EQ(fitted.exit_code, 0) << fitted.err;
        EXPECT_THAT(fitted.err, testing::Not(HasSubstr("empty")));
        const auto warned = run(command, away);
        EXPECT_EQ(warned.exit_code, 0);
        EXPECT_THAT(warned.err, HasSubstr("nothing is in view of the camera"));
        auto failing = away;
        failing.emplace_back("--fail-empty");
        EXPECT_EQ(run(command, failing).exit_code, 7);
    }
    EXPECT_THAT(run(still, away).out, HasSubstr("\"empty\": 1"));
    EXPECT_THAT(run(still, away).err, HasSubstr("the picture at 0 s is empty"));
    EXPECT_THAT(run(render, away).err, HasSubstr("pictures are empty, the first at 0 s"));
    EXPECT_THAT(run(still, away).err, HasSubstr("change camera.center and camera.height"));
    const std::string keys = "camera.path=[{ t = 0, center = [100, 0] }, { t = 0.1, center = [100, 0] }]";
    EXPECT_THAT(run(still, {"--set", keys, "--set", "camera.height=2"}).err,
                HasSubstr("change center and height of the keys of camera.path"));
}

TEST_F(ExitCodes, TwoForAnInvalidOptionAndThreeForAnInvalidScene) {
    EXPECT_EQ(run_corda({}).exit_code, 2);
    // A scene that is invalid even without the option is an invalid scene; it may come from a pipe.
    EXPECT_EQ(run_corda({"simulate", scene_, "--duration", "0", "--set", "world.drag=-1"}).exit_code, 3);
    const std::string from_pipe = "cat " + scene_ + " | " + test::quoted(CORDA_PROGRAM) + " simulate - ";
    EXPECT_EQ(run_shell(from_pipe + "--duration abc").exit_code, 2);
    EXPECT_EQ(run_shell(from_pipe + "--set world.duration=abc").exit_code, 3);
    EXPECT_EQ(run_shell(from_pipe).exit_code, 0);
}

TEST_F(ExitCodes, AreTheSameIfStderrIsFull) {
    const std::string program = test::quoted(CORDA_PROGRAM);
    for (const char* const stderr_is : {"2>&-", "2>/dev/full"}) {
        EXPECT_EQ(run_shell(program + " plan " + folder_.file("none.toml") + " " + stderr_is).exit_code, 6);
        EXPECT_EQ(
            run_shell(program + " render -v --force " + scene_ + " -o " + video_ + " " + stderr_is).exit_code,
            0);
    }
}

TEST_F(ExitCodes, ThreeForAnInvalidScene) {
    const std::string bad =
        folder_.write("bad.toml", "schema = 1\n[[rope]]\nhang = { links = 6, length = 1.0 }\nmasss = 2\n");
    const auto result = run_corda({"render", bad, "-o", video_});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err, HasSubstr("bad.toml:4:1: "));
    EXPECT_THAT(result.err, HasSubstr("masss"));
    EXPECT_THAT(result.err, HasSubstr("did you mean \"mass\""));
    EXPECT_EQ(run_corda({"simulate", scene_, "--set", "solver.method=magic"}).exit_code, 3);
}

TEST_F(ExitCodes, FourWithoutUsableGl) {
    const std::vector<std::string> still{"still", scene_, "--at", "0", "-o", folder_.path()};
    EXPECT_EQ(run_corda(still, "CORDA_BACKEND=device:63").exit_code, 4);
}

TEST_F(ExitCodes, FiveForAnEncoderThatFails) {
    const auto result =
        run_corda({"render", scene_, "-o", video_, "--codec", "h264_nvenc", "--size", "320x180"},
                  "CUDA_VISIBLE_DEVICES=");
    EXPECT_EQ(result.exit_code, 5) << result.err;
    EXPECT_THAT(result.err, HasSubstr("h264_nvenc"));
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
}

TEST_F(ExitCodes, SixWhenNoMoreCanBeWritten) {
    // Limits the size of a file in KiB, which a program sees as a full disk.
    const auto render = [&](int kib) {
        return run_shell("trap '' XFSZ; ulimit -f " + std::to_string(kib) + "; " +
                         test::quoted(CORDA_PROGRAM) + " render " + scene_ + " -o " + video_ +
                         " --size 640x360 --crf 1 --duration 8");
    };
    for (const int kib : {4, 400}) {  // the video has about 700
        const auto full = render(kib);
        EXPECT_EQ(full.exit_code, 6) << full.err;
        EXPECT_THAT(full.err, HasSubstr("File too large"));
        EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
    }
    const auto csv = run_shell("trap '' XFSZ; ulimit -f 4; " + test::quoted(CORDA_PROGRAM) + " simulate " +
                               scene_ + " -o " + folder_.file("out.csv") + " --duration 5");
    EXPECT_EQ(csv.exit_code, 6) << csv.err;
}

TEST_F(ExitCodes, SixForAFullDevice) {
    EXPECT_EQ(run_shell(test::quoted(CORDA_PROGRAM) + " render " + scene_ + " -o - > /dev/full").exit_code,
              6);
}

TEST_F(ExitCodes, SixIfTheFolderIsRemovedMidway) {
    const std::string folder = folder_.file("gone");
    const auto result =
        run_shell("mkdir " + folder + "; " + test::quoted(CORDA_PROGRAM) + " render " + scene_ + " -o " +
                  folder + "/out.mp4 --duration 20 --size 320x180 & pid=$!; " +
                  test::wait_until("ls " + folder + "/out.mp4.*.tmp") + "mv " + folder + " " + folder +
                  ".removed; wait $pid");
    EXPECT_EQ(result.exit_code, 6) << result.err;
}

TEST_F(ExitCodes, SixRatherThanOverwriteWithoutForce) {
    const std::string old = folder_.write("out.mp4", "precious");
    const auto refused = run_corda({"render", scene_, "-o", old});
    EXPECT_EQ(refused.exit_code, 6);
    EXPECT_THAT(refused.err, HasSubstr("--force"));
    EXPECT_EQ(test::read_file(old), "precious");
    EXPECT_EQ(run_corda({"render", scene_, "-o", old, "--force"}).exit_code, 0);
    EXPECT_NE(test::read_file(old), "precious");
    const std::string csv = folder_.write("out.csv", "precious");
    EXPECT_EQ(run_corda({"simulate", scene_, "-o", csv}).exit_code, 6);
    const std::string png = folder_.write("out.png", "precious");
    EXPECT_EQ(run_corda({"still", scene_, "--at", "0", "-o", png}).exit_code, 6);
    EXPECT_EQ(test::read_file(csv) + test::read_file(png), "preciousprecious");
}

TEST_F(ExitCodes, NoneForTwoRendersToOneName) {
    const std::string render =
        test::quoted(CORDA_PROGRAM) + " render --force " + scene_ + " -o " + video_ + " -q";
    const auto both = run_shell(render + " & pid=$!; " + render + "; wait $pid");
    EXPECT_EQ(both.exit_code, 0) << both.err;
    EXPECT_NO_THROW((void)test::probe(video_));
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"out.mp4", "scene.toml"}));
}

TEST_F(ExitCodes, SevenForADifference) {
    ASSERT_EQ(run_corda({"still", scene_, "--at", "0,0.2", "-o", folder_.file("stills")}).exit_code, 0);
    const std::string a = folder_.file("stills/scene_0.0s.png");
    const std::string b = folder_.file("stills/scene_0.2s.png");
    EXPECT_EQ(run_corda({"compare", a, a}).exit_code, 0);
    EXPECT_EQ(run_corda({"compare", a, b}).exit_code, 7);
    EXPECT_EQ(run_corda({"compare", a, b, "--max", "255"}).exit_code, 0);
}

TEST_F(ExitCodes, EightForADivergedSimulation) {
    const std::vector<std::string> wild{"--set", "solver.method=relaxation", "--set",
                                        "solver.force=[1e300, 0.0]"};
    auto arguments = std::vector<std::string>{"render", scene_, "-o", video_};
    arguments.insert(arguments.end(), wild.begin(), wild.end());
    const auto result = run_corda(arguments);
    EXPECT_EQ(result.exit_code, 8) << result.err;
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
    arguments[0] = "simulate";
    arguments[3] = folder_.file("out.csv");
    const auto simulated = run_corda(arguments);
    EXPECT_EQ(simulated.exit_code, 8);
    EXPECT_THAT(simulated.err, HasSubstr("out.csv.part"));
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"out.csv.part", "scene.toml"}));
}

#ifndef CORDA_SANITIZE  // which reserves more memory than any limit
TEST_F(ExitCodes, SeventyFiveWithoutMemory) {
    const std::string many = folder_.write("many.toml",
                                           "schema = 1\n[[rope]]\nline = { particles = 900000, step = "
                                           "[0.001, 0.0] }\n[world]\nduration = 0.1\n");
    const auto result = run_shell("ulimit -v 400000; " + test::quoted(CORDA_PROGRAM) + " simulate " + many);
    EXPECT_EQ(result.exit_code, 75) << result.err;
    EXPECT_THAT(result.err, HasSubstr("out of memory"));
}
#endif

/// Starts a long render, sends `signal` once it draws, and returns its result.
test::CommandResult interrupted_render(const std::string& signal, const std::string& scene,
                                       const std::string& video) {
    return run_shell(test::quoted(CORDA_PROGRAM) + " render " + scene + " -o " + video +
                     " --size 640x360 --duration 200 & pid=$!; for i in $(seq 200); do sleep 0.1; ls " +
                     video + ".*.tmp >/dev/null 2>&1 && break; done; sleep 0.5; kill -" + signal +
                     " $pid; wait $pid");
}

TEST_F(ExitCodes, OneHundredThirtyWhenInterruptedAndOneHundredFortyThreeWhenTerminated) {
    for (const auto& [signal, code] : {std::pair{"INT", 130}, {"TERM", 143}}) {
        const auto result = interrupted_render(signal, scene_, video_);
        EXPECT_EQ(result.exit_code, code) << result.err;
        EXPECT_THAT(result.err, HasSubstr("interrupted; " + video_ + " was not written"));
        EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
    }
}

TEST_F(ExitCodes, OneHundredThirtyForStillsWithTheNumberWritten) {
    std::string frames = "0";
    for (int k = 1; k < 300; ++k) frames += "," + std::to_string(k);
    const std::string stills = folder_.file("stills");
    const auto result = run_shell(test::quoted(CORDA_PROGRAM) + " still " + scene_ + " -o " + stills +
                                  " --size 1920x1080 --duration 10 --frame " + frames +
                                  " & pid=$!; for i in $(seq 200); do sleep 0.05; [ -n \"$(ls " + stills +
                                  "/*.png 2>/dev/null)\" ] && break; done; kill -INT $pid; wait $pid");
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_THAT(result.err, HasSubstr("of 300 stills are written"));
}

TEST_F(ExitCodes, OneHundredFortyThreeWhenTerminatedWhilePlanning) {
    const std::string net = folder_.write(
        "net.toml",
        "schema = 1\n[[net]]\ngrid = { columns = 80, rows = 60, spacing = 0.1, diagonals = false }\n"
        "pinned = [[0, 0]]\n");
    const auto result =
        run_shell(test::quoted(CORDA_PROGRAM) + " render " + net + " -o " + video_ + " & pid=$!; " +
                  test::wait_until_listening() + "kill -TERM $pid; wait $pid");
    EXPECT_EQ(result.exit_code, 143) << result.err;
    EXPECT_THAT(result.err, HasSubstr("interrupted; nothing was written"));
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"net.toml", "scene.toml"}));
}

}  // namespace
}  // namespace corda
