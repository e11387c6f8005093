// `corda render --resume`: a render that was killed at any moment gives the bytes of an uninterrupted one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace corda {
namespace {

using test::quoted;
using test::read_file;
using test::run_corda;
using testing::HasSubstr;

class Resume : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    [[nodiscard]] std::vector<std::string> render(const std::string& name,
                                                  const std::vector<std::string>& more = {}) const {
        std::vector<std::string> all{"render",  CORDA_EXAMPLES "/first.toml", "--size", "480x270", "-o",
                                     file(name)};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    /// Start of the delay before a signal.
    enum class From { kStart, kFirstChunk, kSecondChunk };

    /// Starts a render, and sends it a signal after a delay.
    void interrupt(const std::string& name, const std::string& signal, double after_s, From from,
                   const std::vector<std::string>& more = {}) const {
        std::string command = CORDA_PROGRAM;
        for (const std::string& word : render(name, more)) command += " " + quoted(word);
        const std::string part = quoted(file(name + ".part"));
        command += " & p=$!; ";
        if (from != From::kStart)
            command += "until [ $(grep -aos 'corda checksum' " + part + " | wc -l) -ge " +
                       (from == From::kFirstChunk ? "1" : "2") + " ] || ! kill -0 $p; do sleep 0.01; done; ";
        command += "sleep " + std::to_string(after_s) + "; kill -s " + signal + " $p; wait $p; ";
        // Waits until no process has the part locked.
        command += "[ ! -e " + part + " ] || flock -w 60 " + part + " true";
        static_cast<void>(test::run_shell(command));
    }

    [[nodiscard]] std::string bytes_of_a_whole(const std::string& name,
                                               const std::vector<std::string>& more = {}) const {
        EXPECT_EQ(run_corda(render(name, more)).exit_code, 0);
        return read_file(file(name));
    }

    test::ScratchFolder folder_;
};

/// A few kills, or a hundred with CORDA_TEST_LONG.
TEST_F(Resume, MakesTheSameVideoAfterAKillAtAnyMoment) {
    // Long enough that most kills come before its end.
    const std::vector<std::string> slowly{"--preset", "medium", "--duration", "15"};
    const std::string whole = bytes_of_a_whole("whole.mp4", slowly);
    const int kills = std::getenv("CORDA_TEST_LONG") != nullptr ? 100 : 4;
    std::mt19937 random(20261123);  // NOLINT(cert-msc51-cpp): the same kills on every run
    std::uniform_real_distribution<double> moment_s(0.0, 1.5);
    int parts = 0;
    for (int i = 0; i < kills; ++i) {
        const double after_s = moment_s(random);
        interrupt("a.mp4", "KILL", after_s, i % 2 == 0 ? From::kStart : From::kFirstChunk, slowly);
        // The final file is complete or absent; between its renaming and the removal of the part, both exist.
        const bool is_finished = std::filesystem::exists(file("a.mp4"));
        if (is_finished) {
            EXPECT_TRUE(read_file(file("a.mp4")) == whole) << after_s;
        }
        const std::string part = read_file(file("a.mp4.part"));
        if (part.find("corda checksum") != std::string::npos) {  // a whole chunk
            ++parts;
            test::write_file(file("copy.mp4.part"), part);
            EXPECT_EQ(run_corda({"recover", file("copy.mp4.part"), "-o", file("copy.mp4")}).exit_code, 0)
                << after_s;
            EXPECT_EQ(run_corda({"verify", file("copy.mp4")}).exit_code, 0) << after_s;
        }
        if (!is_finished) {
            std::vector<std::string> again = slowly;
            again.emplace_back("--resume");
            const auto resumed = run_corda(render("a.mp4", again));
            EXPECT_EQ(resumed.exit_code, 0) << after_s << resumed.err;
            EXPECT_FALSE(std::filesystem::exists(file("a.mp4.part")));
            for (const std::string& left : folder_.files()) EXPECT_FALSE(left.ends_with(".tmp")) << left;
        }
        EXPECT_TRUE(read_file(file("a.mp4")) == whole) << after_s;
        for (const char* const name : {"a.mp4", "a.mp4.part", "copy.mp4"})
            std::filesystem::remove(file(name));
    }
    RecordProperty("parts", parts);
}

TEST_F(Resume, APartThatCrashesItsReaderIsDamaged) {
    interrupt("a.mp4", "KILL", 0.0, From::kFirstChunk, {"--preset", "medium", "--duration", "15"});
    const std::string part = read_file(file("a.mp4.part"));
    ASSERT_FALSE(part.empty());
    const std::string crashes = "LD_PRELOAD=" FOREIGN_FAULTS " DEMUXER_CRASHES=1";
    const auto resume = render("a.mp4", {"--preset", "medium", "--duration", "15", "--resume"});
    for (const auto& command : {std::vector<std::string>{"recover", file("a.mp4.part")}, resume}) {
        const auto result = run_corda(command, crashes);
        EXPECT_EQ(result.exit_code, 7) << result.err;
        EXPECT_THAT(result.err, HasSubstr("a.mp4.part' is damaged: reading it crashed (Aborted)"));
        EXPECT_TRUE(read_file(file("a.mp4.part")) == part);
    }
}

TEST_F(Resume, MakesTheSameVideoInEveryFormat) {
    using Words = std::vector<std::string>;
    for (const auto& [name, more] : std::vector<std::pair<std::string, Words>>{
             {"a.webm", {"--duration", "6"}},
             {"b.mkv", {"--frames", "7:300"}},
             {"c.mov", {"--duration", "2"}},
             {"d.gif", {"--fps", "50", "--duration", "4"}},
             {"e.mp4", {"--codec", "libx265", "--duration", "4"}},
         }) {
        const std::string whole = bytes_of_a_whole("whole" + name, more);
        interrupt(name, "INT", 0.0, From::kFirstChunk, more);
        ASSERT_FALSE(std::filesystem::exists(file(name))) << name;
        Words again = more;
        again.insert(again.end(), {"--resume", "--json"});
        const auto resumed = run_corda(render(name, again));
        ASSERT_EQ(resumed.exit_code, 0) << name << resumed.err;
        const auto report = nlohmann::json::parse(resumed.out);
        EXPECT_GT(report.at("resumed_frames"), 0) << name;
        EXPECT_TRUE(read_file(file(name)) == whole) << name;
    }
}

TEST_F(Resume, RefusesAPartOfAnotherRenderNamingTheDifference) {
    const std::vector<std::string> more{"--duration", "600", "--set", "solver.method=exact"};
    interrupt("a.mp4", "KILL", 0.0, From::kFirstChunk, more);
    const std::string part = read_file(file("a.mp4.part"));
    ASSERT_FALSE(part.empty());
    const auto refused = [&](const std::vector<std::string>& other) {
        std::vector<std::string> all{"--resume", "--set", "solver.method=exact"};
        all.insert(all.end(), other.begin(), other.end());
        const auto result = run_corda(render("a.mp4", all));
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_TRUE(read_file(file("a.mp4.part")) == part);
        return result.err;
    };
    EXPECT_THAT(refused({"--duration", "600", "--crf", "30"}),
                HasSubstr("video.crf is 30 and was not given"));
    EXPECT_THAT(refused({}), HasSubstr("frames is 0:600 and was 0:36000"));
    EXPECT_THAT(refused({"--duration", "600", "--set", "rope[0].mass=2"}),
                HasSubstr("rope[0].mass is 2 and was 1"));
    EXPECT_THAT(refused({"--duration", "600", "--frames", "0:300"}),
                HasSubstr("frames is 0:300 and was 0:36000"));
    EXPECT_THAT(run_corda(render("a.mp4")).err, HasSubstr("resume it (--resume)"));
}

TEST_F(Resume, StartsOverIfNoChunkIsUsable) {
    const std::vector<std::string> more{"--duration", "0.5", "--resume", "--json"};
    const auto anew = run_corda(render("a.mp4", more));
    EXPECT_EQ(anew.exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(anew.out).at("resumed_frames"), 0);
    EXPECT_EQ(run_corda(render("a.mp4", more)).exit_code, 6);  // the output exists
    test::write_file(file("b.mp4.part"), "");
    EXPECT_EQ(run_corda(render("b.mp4", more)).exit_code, 0);
    test::write_file(file("c.mp4.part"), "this is no video");
    const auto broken = run_corda(render("c.mp4", more));
    EXPECT_NE(broken.exit_code, 0);
    EXPECT_EQ(read_file(file("c.mp4.part")), "this is no video");
    test::write_file(file("d.mp4.part"), read_file(file("a.mp4")));  // a video that is not a part
    const auto foreign = run_corda(render("d.mp4", more));
    EXPECT_EQ(foreign.exit_code, 2);
    EXPECT_THAT(foreign.err, HasSubstr("holds no whole chunk of this render"));
    EXPECT_TRUE(read_file(file("d.mp4.part")) == read_file(file("a.mp4")));
    const auto pictures = run_corda(render("frames/%04d.png", more));
    EXPECT_EQ(pictures.exit_code, 2);
    EXPECT_THAT(pictures.err, HasSubstr("--frames FIRST:END"));
}

TEST_F(Resume, RecoveredVideoRecordsItsFrames) {
    const std::vector<std::string> more{"--duration", "20", "--set", "solver.method=exact"};
    interrupt("a.mp4", "INT", 0.0, From::kFirstChunk, more);
    const auto recovered = run_corda({"recover", file("a.mp4.part"), "--json"});
    ASSERT_EQ(recovered.exit_code, 0) << recovered.err;
    const auto again = run_corda({"render", "--from", file("a.mp4"), "-o", file("b.mp4"), "--json"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(nlohmann::json::parse(again.out).at("frames"),
              nlohmann::json::parse(recovered.out).at("frames"));
    EXPECT_EQ(run_corda({"compare", file("a.mp4"), file("b.mp4")}).exit_code, 0);
}

TEST_F(Resume, APartWithoutAChunkCannotBeRecovered) {
    test::write_file(file("a.mp4.part"), "");
    const auto refused = run_corda({"recover", file("a.mp4.part")});
    EXPECT_EQ(refused.exit_code, 7);
    EXPECT_THAT(refused.err, HasSubstr("is empty: no chunk of it was finished; render it again (--force)"));
    EXPECT_EQ(run_corda(render("a.mp4", {"--force", "--duration", "1"})).exit_code, 0);
}

TEST_F(Resume, RefusesAPartThatIsDamagedInItsFirstChunk) {
    const std::vector<std::string> more{"--duration", "20", "--set", "solver.method=exact"};
    interrupt("a.mp4", "INT", 0.0, From::kFirstChunk, more);
    std::string part = read_file(file("a.mp4.part"));
    ASSERT_NE(part.find("mdat"), std::string::npos);
    part[part.find("mdat") + 100] ^= 1;
    test::write_file(file("a.mp4.part"), part);
    std::vector<std::string> again = more;
    again.emplace_back("--resume");
    const auto refused = run_corda(render("a.mp4", again));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("is damaged in its first chunk"));
    EXPECT_THAT(refused.err, HasSubstr("start again (--force without --resume)"));
    EXPECT_TRUE(read_file(file("a.mp4.part")) == part);
}

TEST_F(Resume, ReportsADamagedPartAndRendersTheRestAgain) {
    const std::vector<std::string> more{"--duration", "20", "--set", "solver.method=exact"};
    const std::string whole = bytes_of_a_whole("whole.mp4", more);
    interrupt("a.mp4", "INT", 0.0, From::kSecondChunk, more);
    std::string part = read_file(file("a.mp4.part"));
    const std::size_t first = part.find("mdat");
    ASSERT_NE(part.find("mdat", first + 1), std::string::npos) << "one chunk alone";
    part[part.find("mdat", first + 1) + 100] ^= 1;
    test::write_file(file("a.mp4.part"), part);
    std::vector<std::string> again = more;
    again.emplace_back("--resume");
    const auto resumed = run_corda(render("a.mp4", again));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.err,
                HasSubstr("60 frames were there from the interrupted render, whose part was damaged"));
    EXPECT_TRUE(read_file(file("a.mp4")) == whole);
}

TEST_F(Resume, RemovesOnlyTheCopyThatAKillLeft) {
    const std::vector<std::string> more{"--duration", "20", "--set", "solver.method=exact"};
    interrupt("a.mp4", "INT", 0.0, From::kFirstChunk, more);
    const std::string part = read_file(file("a.mp4.part"));
    std::vector<std::string> again = more;
    again.emplace_back("--resume");
    test::write_file(file("a.mp4.part.new"), "precious");
    const auto refused = run_corda(render("a.mp4", again));
    EXPECT_EQ(refused.exit_code, 6);
    EXPECT_THAT(refused.err, HasSubstr("a.mp4.part.new' is in the way"));
    EXPECT_EQ(read_file(file("a.mp4.part.new")), "precious");
    EXPECT_TRUE(read_file(file("a.mp4.part")) == part);
    test::write_file(file("a.mp4.part.new"), part.substr(0, part.size() / 2));
    EXPECT_EQ(run_corda(render("a.mp4", again)).exit_code, 0);
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"a.mp4"});
}

}  // namespace
}  // namespace corda
