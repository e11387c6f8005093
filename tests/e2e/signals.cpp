// The first signal ends every command within a second, whatever the command is doing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "corda/media/defs.hpp"
#include "support/command.hpp"
#include "support/probe.hpp"

namespace corda {
namespace {

using test::run_corda;
using test::run_shell;
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
preset = "ultrafast"
)";

/// Succeeds once the program has a handler for SIGINT (2), the second bit in the last digit of the mask.
const char* const kIsListening = "grep -q '^SigCgt:.*[2367abef]$' /proc/$pid/status 2>/dev/null";

/// Commands take less than 500 ms on a quiet machine; the rest is for other processes on a busy one.
constexpr int kMaxMs = 5000;

/// The result of a command, and its delay after the signal.
struct Interrupted {
    test::CommandResult result;
    int ms = -1;
};

/// Starts `corda ARGUMENTS`, sends it a signal when the shell command `until` succeeds, and waits for its
/// end, for 20 s at most.
Interrupted interrupt(const std::string& arguments, const std::string& signal, const std::string& until,
                      const std::string& environment = "") {
    Interrupted end;
    end.result = run_shell(environment + " " + test::quoted(CORDA_PROGRAM) + " " + arguments +
                           " & pid=$!; for i in $(seq 1500); do " + until + " && break; sleep 0.01; done;" +
                           " { sleep 20; kill -KILL $pid; } & dog=$!;" + " from=$(date +%s%N); kill -" +
                           signal + " $pid; wait $pid; code=$?; kill $dog;" +
                           " echo; echo ms $((($(date +%s%N) - from) / 1000000)); exit $code");
    const std::size_t at = end.result.out.rfind("\nms ");
    if (at != std::string::npos) end.ms = std::atoi(end.result.out.c_str() + at + 4);
    return end;
}

class Signals : public testing::Test {
  protected:
    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfSignals);
};

TEST_F(Signals, EndTheWaitForAPipe) {
    const std::string pipe = folder_.file("pipe");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    for (const std::string& arguments :
         {"plan " + pipe, "simulate " + pipe, "render " + pipe + " -o " + folder_.file("a.mp4"),
          "still " + pipe + " --at 0 -o " + folder_.file("a.png"),
          "report " + pipe + " -o " + folder_.file("report"),
          "study " + pipe + " -o " + folder_.file("report"), "compare " + pipe + " " + pipe}) {
        for (const auto& [signal, exit_code] : {std::pair{"INT", 130}, {"TERM", 143}, {"HUP", 129}}) {
            const Interrupted end = interrupt(arguments, signal, kIsListening);
            EXPECT_EQ(end.result.exit_code, exit_code) << arguments << end.result.err;
            // Measured 4 .. 18, and up to 100 more if the wait starts after the signal.
            EXPECT_LT(end.ms, kMaxMs) << arguments;
        }
    }
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"pipe", "scene.toml"}));
}

TEST_F(Signals, StayIgnoredIfIgnoredAtTheStart) {
    const std::string video = folder_.file("a.mp4");
    const Interrupted end = interrupt("render " + scene_ + " -o " + video + " -q", "HUP", kIsListening);
    EXPECT_EQ(end.result.exit_code, 129) << end.result.err;
    const auto kept = run_shell("trap '' HUP; " + test::quoted(CORDA_PROGRAM) + " render " + scene_ + " -o " +
                                video + " -q --duration 4 --force & pid=$!; until " + kIsListening +
                                "; do sleep 0.01; done; kill -HUP $pid; wait $pid");
    EXPECT_EQ(kept.exit_code, 0) << kept.err;
    EXPECT_NO_THROW((void)test::probe(video));
}

TEST_F(Signals, EndTheWaitForTheWriterOfAPipe) {
    const std::string pipe = folder_.file("pipe");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    for (const std::string& command : {"plan " + pipe, "compare " + pipe + " " + pipe}) {
        const auto writer = run_shell("{ exec 3> " + pipe + "; printf schema >&3; sleep 20; } & writer=$!; " +
                                      test::quoted(CORDA_PROGRAM) + " " + command +
                                      " & pid=$!; sleep 0.5; kill -TERM $pid; " +
                                      "wait $pid; code=$?; kill $writer; exit $code");
        EXPECT_EQ(writer.exit_code, 143) << writer.err;
    }
}

TEST_F(Signals, EndTheWaitForTheReaderOfAPipe) {
    const std::string pipe = folder_.file("pipe");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    const std::string simulate = test::quoted(CORDA_PROGRAM) + " simulate " + scene_ + " -o " + pipe;
    // The file has more than a pipe holds.
    const auto end =
        run_shell("sleep 20 < " + pipe + " & reader=$!; " + simulate +
                  " & pid=$!; sleep 0.5; kill -TERM $pid; wait $pid; code=$?; kill $reader; exit $code");
    EXPECT_EQ(end.exit_code, 143) << end.err;
    const Interrupted alone = interrupt("simulate " + scene_ + " -o " + pipe, "INT", kIsListening);
    EXPECT_EQ(alone.result.exit_code, 130) << alone.result.err;
}

TEST_F(Signals, EndARenderThatWaitsForItsReader) {
    const std::string pipe = folder_.file("pipe");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    std::string scene = kSceneOfSignals;
    scene.erase(scene.find("preset"));  // raw frames have no preset
    scene = folder_.write("raw.toml", scene);
    for (const char* const jobs : {"1", "2"}) {
        const auto end = run_shell("sleep 20 < " + pipe + " & reader=$!; " + test::quoted(CORDA_PROGRAM) +
                                   " render " + scene + " -o - --jobs " + jobs + " > " + pipe +
                                   " & pid=$!; sleep 1.5; kill -TERM $pid; wait $pid; code=$?; "
                                   "kill $reader; exit $code");
        EXPECT_EQ(end.exit_code, 143) << end.err;
        EXPECT_THAT(end.err, AllOf(HasSubstr("interrupted"), Not(HasSubstr("did not stop in time"))));
    }
}

TEST_F(Signals, WriteNothingAfterATruncatedFrame) {
    const std::string pipe = folder_.file("pipe");
    ASSERT_EQ(run_shell("mkfifo " + pipe).exit_code, 0);
    std::string scene = kSceneOfSignals;
    scene.erase(scene.find("preset"));  // raw frames have no preset
    scene = folder_.write("raw.toml", scene);
    for (const char* const jobs : {"1", "2"}) {
        // Four frames of 345606 bytes and a part of the next one fit; the signal comes when the pipe is full.
        const std::string out = folder_.file("out");
        const auto end =
            run_shell("{ head -c 1500000; sleep 2; kill -INT $(cat " + pipe + ".pid); sleep 0.2; cat; } < " +
                      pipe + " > " + out + " & reader=$!; " + test::quoted(CORDA_PROGRAM) + " render " +
                      scene + " -o - --jobs " + jobs + " > " + pipe + " & pid=$!; echo $pid > " + pipe +
                      ".pid; wait $pid; code=$?; wait $reader; exit $code");
        EXPECT_EQ(end.exit_code, 130) << end.err;
        EXPECT_THAT(end.err, HasSubstr("are in standard output"));
        const std::string bytes = test::read_file(out);
        constexpr std::size_t kFrame = 6 + 640 * 360 * 3 / 2;
        std::size_t frames = 0;
        for (std::size_t at = bytes.find('\n') + 1; at < bytes.size(); at += kFrame, ++frames)
            EXPECT_EQ(bytes.substr(at, 6), std::string("FRAME\n").substr(0, bytes.size() - at))
                << jobs << " " << frames;
        EXPECT_GE(frames, 4U);
        EXPECT_LT(frames, 60U);  // nothing of the frames after it
    }
}

TEST_F(Signals, EndAReportWhileItReadsTheMotion) {
    const std::string out = folder_.file("report");
    const Interrupted end = interrupt("report " + scene_ + " -o " + out + " --duration 2000", "TERM",
                                      "ls -A " + out + " 2>/dev/null | grep -q tip.csv");
    EXPECT_EQ(end.result.exit_code, 143) << end.result.err;
    EXPECT_THAT(end.result.err, HasSubstr("error: interrupted; nothing was written"));
    EXPECT_LT(end.ms, kMaxMs);  // measured 3 .. 10
    EXPECT_EQ(run_shell("ls -A " + out).out, "");
}

TEST_F(Signals, EndAComparison) {
    // Reading these takes at least a second.
    write_png(folder_.file("a.png"), Image(8192, 4096));
    const std::string pictures = folder_.file("a.png") + " " + folder_.file("a.png");
    const Interrupted end =
        interrupt("compare " + pictures + " --diff " + folder_.file("d.png"), "INT", kIsListening);
    EXPECT_EQ(end.result.exit_code, 130) << end.result.err;
    EXPECT_THAT(end.result.err, HasSubstr("interrupted; nothing was written"));
    EXPECT_LT(end.ms, kMaxMs);  // measured 20 .. 130
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"a.png", "scene.toml"}));
}

TEST_F(Signals, EndARenderAndLeaveNothing) {
    for (const char* const name : {"a.mp4", "a.gif"}) {
        std::string scene = kSceneOfSignals;
        scene.erase(scene.find("preset"));  // a GIF has none
        scene = folder_.write("scene.toml", scene);
        const std::string video = folder_.file(name);
        test::write_file(video, "precious");
        const Interrupted end = interrupt("render --force " + scene + " -o " + video, "TERM",
                                          "ls " + video + ".*.tmp >/dev/null 2>&1");
        EXPECT_EQ(end.result.exit_code, 143) << end.result.err;
        EXPECT_THAT(end.result.err, HasSubstr("interrupted; " + video + " was not written"));
        EXPECT_LT(end.ms, kMaxMs);
        EXPECT_EQ(test::read_file(video), "precious");
        std::filesystem::remove(video);
        EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.toml"});
    }
}

TEST_F(Signals, EndASequenceOfPicturesThatResumeContinues) {
    std::string scene = kSceneOfSignals;
    scene.erase(scene.find("preset"));
    scene = folder_.write("scene.toml", scene);
    const std::string frames = folder_.file("frames");
    const std::string render = "render " + scene + " --duration 4 -o " + frames + "/%04d.png";
    const Interrupted end = interrupt(render, "INT", "test -e " + frames + "/0005.png");
    EXPECT_EQ(end.result.exit_code, 130) << end.result.err;
    EXPECT_THAT(end.result.err,
                HasSubstr("frames are in " + frames + "/%04d.png (--resume draws the others)"));
    const std::string program = test::quoted(CORDA_PROGRAM) + " ";
    const auto resumed = run_shell(program + render + " --resume --json");
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.out, HasSubstr("\"frames\": 120"));
    EXPECT_THAT(resumed.err, HasSubstr("were there already"));
    const auto whole =
        run_shell(program + "render " + scene + " --duration 4 -q -o " + folder_.file("whole") +
                  "/%04d.png && diff -r " + frames + " " + folder_.file("whole"));
    EXPECT_EQ(whole.exit_code, 0) << whole.out;
}

TEST_F(Signals, EndAStill) {
    // Simulating until then takes at least a second.
    const Interrupted end = interrupt(
        "still " + scene_ + " --at 0,3e5 --duration 3e5 -o " + folder_.file("stills"), "INT", kIsListening);
    EXPECT_EQ(end.result.exit_code, 130) << end.result.err;
    EXPECT_THAT(end.result.err, HasSubstr("interrupted; nothing was written"));
    EXPECT_LT(end.ms, kMaxMs);  // measured 4
}

#ifndef CORDA_SANITIZE  // which draws many times slower, and takes more memory
TEST_F(Signals, EndTheDrawingOfALargeStill) {
    // The process has this much memory once the masks exist; drawing then takes at least two seconds.
    const Interrupted end =
        interrupt("still " + scene_ + " --at 0 --size 8192x8192 -o " + folder_.file("a.png"), "TERM",
                  "awk '/^VmRSS/ { exit $2 < 598000 }' /proc/$pid/status");
    EXPECT_EQ(end.result.exit_code, 143) << end.result.err;
    EXPECT_THAT(end.result.err, HasSubstr("interrupted; nothing was written"));
    EXPECT_LT(end.ms, kMaxMs);  // measured 340 .. 470 on a busy machine; 7500 in one piece
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"scene.toml"}));
}
#endif

#ifndef CORDA_SANITIZE  // whose run time must be loaded first
const std::string kHangs = "LD_PRELOAD=" FOREIGN_FAULTS " X264_HANGS_FROM_PX=640";

TEST_F(Signals, EndAnEncoderThatDoesNotReturn) {
    const std::string video = folder_.file("a.mp4");
    const std::string marker = folder_.file("hangs");
    for (const char* const jobs : {"1", "2"}) {
        for (const auto& [signal, exit_code] : {std::pair{"INT", 130}, {"TERM", 143}, {"HUP", 129}}) {
            const Interrupted end =
                interrupt("render " + scene_ + " --json -o " + video + " --jobs " + jobs, signal,
                          "test -e " + marker, kHangs + " X264_HANG_MARKER=" + marker);
            std::filesystem::remove(marker);
            EXPECT_EQ(end.result.exit_code, exit_code) << end.result.err;
            EXPECT_THAT(end.result.err, HasSubstr(std::string("interrupted (SIG") + signal + ")"));
            EXPECT_THAT(end.result.out, HasSubstr("\"code\": " + std::to_string(exit_code)));
            EXPECT_GE(end.ms, 800);
            EXPECT_LT(end.ms, kMaxMs);  // measured 840 .. 880
        }
    }
}

TEST_F(Signals, WaitForASlowDiskToStoreKeptFrames) {
    const std::string table = folder_.file("a.csv");
    const Interrupted end = interrupt("simulate " + scene_ + " --duration 3000 -o " + table, "TERM",
                                      "ls " + folder_.path() + "/a.csv.*.tmp",
                                      "LD_PRELOAD=" FOREIGN_FAULTS " FSYNC_TAKES_MS=1500");
    EXPECT_EQ(end.result.exit_code, 143);
    EXPECT_THAT(end.result.err, HasSubstr("a.csv.part"));
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"a.csv.part", "scene.toml"}));
}

TEST_F(Signals, TheSecondEndsAtOnceEvenInsideAnEncoder) {
    const std::string video = folder_.file("a.mp4");
    const std::string marker = folder_.file("hangs");
    const Interrupted end = interrupt("render " + scene_ + " --jobs 1 -o " + video, "TERM",
                                      "test -e " + marker + " && kill -INT $pid && sleep 0.2",
                                      kHangs + " X264_HANG_MARKER=" + marker);
    EXPECT_EQ(end.result.exit_code, 143);
    EXPECT_LT(end.ms, 600);  // measured 5 .. 20
}
#endif

TEST_F(Signals, EndAStudy) {
    // While it measures the first methods.
    const Interrupted end = interrupt("study -q -o " + folder_.file("report"), "INT", kIsListening);
    EXPECT_EQ(end.result.exit_code, 130) << end.result.err;
    EXPECT_THAT(end.result.err, HasSubstr("interrupted; nothing was written"));
    EXPECT_LT(end.ms, kMaxMs);  // measured 60 .. 230
}

TEST_F(Signals, EndASuiteWithTheNumberOfItsPictures) {
    std::string times = "0";
    for (int i = 1; i < 40; ++i) times += ", " + std::to_string(i);
    const std::string suite = folder_.write(
        "suite.toml", std::string(kSceneOfSignals) + "[golden]\nsize = [1920, 1080]\nat = [" + times + "]\n");
    const std::string ref = folder_.file("ref");
    // Once it draws: then a driver is loaded.
    const Interrupted end = interrupt("golden " + suite + " --dir " + ref + " --update", "INT",
                                      "grep -qE 'swrast_dri|libgallium' /proc/$pid/maps");
    EXPECT_EQ(end.result.exit_code, 130) << end.result.err;
    EXPECT_THAT(end.result.err,
                testing::ContainsRegex("interrupted after [0-9]+ of 40 pictures; nothing was written"));
    EXPECT_FALSE(std::filesystem::exists(ref));
    EXPECT_LT(end.ms, kMaxMs);
}

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
    std::mt19937 random(20);
    for (const HeavyScene& heavy : kHeavyScenes) {
        const std::string scene = folder_.write("heavy.toml", std::string("schema = 1\n") + heavy.toml);
        for (const std::string& arguments :
             {"simulate " + scene, "simulate " + scene + " -o " + folder_.file("a.csv"), "plan " + scene,
              "render " + scene + " -o " + folder_.file("a.mp4"),
              "still " + scene + " --at 1 -o " + folder_.file("a.png"),
              "study -q --force " + scene + " -o " + folder_.file("report")}) {
            const double wait_s = 1e-3 * static_cast<double>(random() % 1000);
            const std::string until = std::string(kIsListening) + " && sleep " + std::to_string(wait_s);
            const Interrupted end = interrupt(arguments, random() % 2 == 0 ? "INT" : "TERM", until);
            EXPECT_TRUE(end.result.exit_code == 130 || end.result.exit_code == 143)
                << heavy.name << ", " << arguments << " after " << wait_s << " s: " << end.result.err;
            // Measured 28 .. 331 on a busy machine.
            EXPECT_LT(end.ms, kMaxMs) << heavy.name << ", " << arguments << " after " << wait_s << " s";
            std::filesystem::remove(folder_.file("a.csv.part"));
        }
    }
}

}  // namespace
}  // namespace corda
