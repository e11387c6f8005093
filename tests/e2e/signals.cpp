// The first signal ends every command with its finished work, whatever the command is doing; the second ends
// it at once. Every command here would take minutes, or waits for ever.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_shell;
using test::wait_until;
using test::wait_until_listening;
using testing::HasSubstr;

const char* const kSceneOfSignals = R"(schema = 1
[world]
duration = 40
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 30.0 }
[solver]
method = "exact"
[video]
size = [640, 360]
fps = 30
)";

/// Waits until the program's one thread sleeps, in a call that waits for another program.
std::string wait_until_asleep() {
    return wait_until("grep '^State:.S' /proc/$pid/status");
}

/// Runs `corda ARGUMENTS &`, then the shell commands `then`, and waits for its end.
test::CommandResult run_and(const std::string& arguments, const std::string& then) {
    return run_shell(test::quoted(CORDA_PROGRAM) + " " + arguments + " & pid=$!; " + then + "wait $pid");
}

class Signals : public testing::Test {
  protected:
    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfSignals);
};

TEST_F(Signals, EndTheWaitForTheWriterOfAPipe) {
    const std::string pipe = folder_.file("pipe");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    for (const std::string& arguments : {"plan " + pipe, "compare " + pipe + " " + pipe}) {
        for (const auto& [signal, exit_code] : {std::pair{"INT", 130}, {"TERM", 143}, {"HUP", 129}}) {
            // The shell opens the pipe once the program has, and keeps it open.
            const auto end = run_and(arguments, "exec 3> " + pipe + "; printf schema >&3; " +
                                                    wait_until_asleep() + "kill -" + signal + " $pid; ");
            EXPECT_EQ(end.exit_code, exit_code) << arguments << end.err;
        }
    }
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"pipe", "scene.toml"}));
}

TEST_F(Signals, StayIgnoredIfIgnoredAtTheStart) {
    const std::string table = folder_.file("a.csv");
    const auto kept =
        run_shell("trap '' HUP; " + test::quoted(CORDA_PROGRAM) + " simulate " + scene_ + " -o " + table +
                  " & pid=$!; " + wait_until_listening() + "kill -HUP $pid; wait $pid");
    EXPECT_EQ(kept.exit_code, 0) << kept.err;
    EXPECT_TRUE(std::filesystem::exists(table));
}

TEST_F(Signals, WriteNothingAfterATruncatedFrame) {
    const std::string pipe = folder_.file("pipe");
    const std::string out = folder_.file("out");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    for (const char* const jobs : {"1", "2"}) {
        // The reader signals after four frames and a part of the next one, and then reads what still comes.
        const auto end = run_shell("{ head -c 1500000; kill -INT $(cat " + pipe + ".pid); cat; } < " + pipe +
                                   " > " + out + " & reader=$!; sh -c 'echo $$ > " + pipe + ".pid; exec " +
                                   test::quoted(CORDA_PROGRAM) + " render " + scene_ + " -o - --jobs " +
                                   jobs + "' > " + pipe + "; code=$?; wait $reader; exit $code");
        EXPECT_EQ(end.exit_code, 130) << end.err;
        EXPECT_THAT(end.err, HasSubstr("interrupted"));
        const std::string bytes = test::read_file(out);
        constexpr std::size_t kFrame = 6 + 640 * 360 * 3 / 2;
        std::size_t frames = 0;
        for (std::size_t at = bytes.find('\n') + 1; at < bytes.size(); at += kFrame, ++frames)
            EXPECT_EQ(bytes.substr(at, 6), std::string("FRAME\n").substr(0, bytes.size() - at))
                << jobs << " " << frames;
        EXPECT_GE(frames, 4U);
        EXPECT_LT(frames, 1200U);
    }
}

TEST_F(Signals, EndARenderAndLeaveNothing) {
    for (const char* const name : {"a.mp4", "a.gif"}) {
        const std::string video = folder_.file(name);
        test::write_file(video, "precious");
        const auto end = run_and("render --force " + scene_ + " -o " + video,
                                 wait_until("ls " + video + ".*.tmp") + "kill -TERM $pid; ");
        EXPECT_EQ(end.exit_code, 143) << end.err;
        EXPECT_THAT(end.err, HasSubstr("interrupted; " + video + " was not written"));
        EXPECT_EQ(test::read_file(video), "precious");
        std::filesystem::remove(video);
        EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
    }
}

TEST_F(Signals, EndASequenceOfPicturesThatResumeContinues) {
    const std::string frames = folder_.file("frames");
    const std::string render = "render " + scene_ + " -o " + frames + "/%04d.png";
    const auto end = run_and(render, wait_until("test -e " + frames + "/0005.png") + "kill -INT $pid; ");
    EXPECT_EQ(end.exit_code, 130) << end.err;
    EXPECT_THAT(end.err, HasSubstr("frames are in " + frames + "/%04d.png (--resume draws the others)"));
    const std::string program = test::quoted(CORDA_PROGRAM) + " ";
    const auto resumed = run_shell(program + render + " --resume --json");
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.out, HasSubstr("\"frames\": 1200"));
    EXPECT_THAT(resumed.err, HasSubstr("were there already"));
    const auto whole = run_shell(program + "render " + scene_ + " -q -o " + folder_.file("whole") +
                                 "/%04d.png && diff -r " + frames + " " + folder_.file("whole"));
    EXPECT_EQ(whole.exit_code, 0) << whole.out;
}

TEST_F(Signals, KeepTheRowsOfATable) {
    const std::string table = folder_.file("a.csv");
    const auto end = run_and("simulate " + scene_ + " --duration 30000 -o " + table,
                             wait_until_listening() + "kill -TERM $pid; ");
    EXPECT_EQ(end.exit_code, 143) << end.err;
    EXPECT_FALSE(std::filesystem::exists(table));
    EXPECT_THAT(end.err, testing::AnyOf(HasSubstr("a.csv.part"), HasSubstr("nothing was written")));
}

TEST_F(Signals, EndAStill) {
    // Simulating until then takes at least a second.
    const auto end = run_and("still " + scene_ + " --at 0,3e5 --duration 3e5 -o " + folder_.file("stills"),
                             wait_until_listening() + "kill -INT $pid; ");
    EXPECT_EQ(end.exit_code, 130) << end.err;
    EXPECT_THAT(end.err, HasSubstr("interrupted; nothing was written"));
}

TEST_F(Signals, EndASuiteWithTheNumberOfItsPictures) {
    std::string times = "0";
    for (int i = 1; i < 400; ++i) times += ", " + std::to_string(0.1 * i);
    const std::string suite = folder_.write(
        "suite.toml", std::string(kSceneOfSignals) + "[golden]\nsize = [1920, 1080]\nat = [" + times + "]\n");
    const std::string ref = folder_.file("ref");
    // Once it draws: then a driver is loaded.
    const auto end =
        run_and("golden " + suite + " --dir " + ref + " --update",
                wait_until("grep -E 'swrast_dri|libgallium' /proc/$pid/maps") + "kill -INT $pid; ");
    EXPECT_EQ(end.exit_code, 130) << end.err;
    EXPECT_THAT(end.err,
                testing::ContainsRegex("interrupted after [0-9]+ of 400 pictures; nothing was written"));
    EXPECT_FALSE(std::filesystem::exists(ref));
}

#ifndef CORDA_SANITIZE  // whose run time must be loaded first
TEST_F(Signals, TheSecondEndsAtOnce) {
    // Flushing the table, which is written at its end, takes ten minutes, despite the first signal.
    const auto end =
        run_shell("LD_PRELOAD=" FOREIGN_FAULTS " FSYNC_TAKES_MS=600000 " + test::quoted(CORDA_PROGRAM) +
                  " simulate " + scene_ + " --duration 0.1 -o " + folder_.file("a.csv") + " & pid=$!; " +
                  test::wait_until("test -s " + folder_.file("a.csv") + ".*.tmp") +
                  "kill -TERM $pid; sleep 0.2; kill -INT $pid; wait $pid");
    EXPECT_EQ(end.exit_code, 130) << end.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.file("a.csv")));
}
#endif

/// A scene whose frames, or whose plan, take minutes.
struct HeavyScene {
    const char* name;
    const char* toml;
};
constexpr HeavyScene kHeavyScenes[] = {{"links of 1 mm at 2 m/s", R"([world]
duration = 3
[[rope]]
hang = { links = 19, length = 0.001, angle_deg = -156.0 }
velocity = [-1.64, 1.5583]
[solver]
method = "rattle"
[video]
fps = 1
)"},
                                       {"a heavy planet", R"([world]
gravity = [0, -1.4e12]
duration = 1
[[rope]]
hang = { links = 20, length = 1.0, angle_deg = 80.0 }
[solver]
method = "exact"
tolerance = 1e-12
)"},
                                       {"a long rope", R"([world]
duration = 1
[[rope]]
hang = { links = 100000, length = 1.0, angle_deg = 80.0 }
[solver]
method = "exact"
)"},
                                       {"a large net", R"([world]
duration = 10
[[net]]
grid = { columns = 200, rows = 200, spacing = 0.02, diagonals = false }
pinned = [[0, 0]]
)"},
                                       {"a million sweeps", R"([world]
duration = 10
[[rope]]
hang = { links = 1000, length = 1.0, angle_deg = 80.0 }
[solver]
method = "relaxation"
sweeps = 1000000
)"}};

TEST_F(Signals, EndEveryCommandInTheMiddleOfAFrame) {
    for (const HeavyScene& heavy : kHeavyScenes) {
        const std::string scene = folder_.write("heavy.toml", std::string("schema = 1\n") + heavy.toml);
        for (const std::string& arguments :
             {"simulate " + scene, "plan " + scene, "render " + scene + " -o " + folder_.file("a.mp4"),
              "still " + scene + " --at 1 -o " + folder_.file("a.png")}) {
            const auto end = run_and(arguments, wait_until_listening() + "sleep 0.3; kill -TERM $pid; ");
            EXPECT_EQ(end.exit_code, 143) << heavy.name << ", " << arguments << ": " << end.err;
        }
    }
}

}  // namespace
}  // namespace corda
