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
#include "support/probe.hpp"

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
        const std::string parts = quoted(file(name + ".parts"));
        command += " & p=$!; ";
        if (from != From::kStart)
            command += "until [ $(ls " + parts + " 2>/dev/null | grep -c '^0') -ge " +
                       (from == From::kFirstChunk ? "1" : "2") + " ] || ! kill -0 $p; do sleep 0.01; done; ";
        command += "sleep " + std::to_string(after_s) + "; kill -s " + signal + " $p; wait $p; ";
        // Waits until no process has the folder locked.
        command += "[ ! -e " + parts + " ] || flock -w 60 " + parts + " true";
        static_cast<void>(test::run_shell(command));
    }

    /// Name of the file of chunk `number` of a video; empty if there is none.
    [[nodiscard]] std::string chunk(const std::string& name, int number) const {
        const auto found = test::run_shell("ls " + quoted(file(name + ".parts")) + " | grep -m 1 '^00000" +
                                           std::to_string(number) + "-'");
        return found.out.substr(0, found.out.find('\n'));
    }
    [[nodiscard]] std::string first_chunk(const std::string& name) const { return chunk(name, 0); }
    void damage(const std::string& name) const {
        std::string bytes = read_file(file(name));
        ASSERT_GT(bytes.size(), 100U);
        bytes[bytes.size() / 2] ^= 1;
        test::write_file(file(name), bytes);
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
    int folders = 0;
    for (int i = 0; i < kills; ++i) {
        const double after_s = moment_s(random);
        interrupt("a.mp4", "KILL", after_s, i % 2 == 0 ? From::kStart : From::kFirstChunk, slowly);
        // The final file is complete or absent; between its renaming and the removal of the folder, both
        // exist.
        const bool is_finished = std::filesystem::exists(file("a.mp4"));
        if (is_finished) {
            EXPECT_TRUE(read_file(file("a.mp4")) == whole) << after_s;
        }
        const bool has_first = !first_chunk("a.mp4").empty();
        if (has_first) {
            ++folders;
            std::filesystem::copy(file("a.mp4.parts"), file("copy.mp4.parts"));
            EXPECT_EQ(run_corda({"recover", file("copy.mp4.parts"), "-o", file("copy.mp4")}).exit_code, 0)
                << after_s;
            EXPECT_NO_THROW((void)test::probe(file("copy.mp4"))) << after_s;
        }
        if (!is_finished) {
            std::vector<std::string> again = slowly;
            again.emplace_back("--resume");
            const auto resumed = run_corda(render("a.mp4", again));
            EXPECT_EQ(resumed.exit_code, 0) << after_s << resumed.err;
            EXPECT_FALSE(std::filesystem::exists(file("a.mp4.parts")));
            for (const std::string& left : folder_.files()) EXPECT_FALSE(left.ends_with(".tmp")) << left;
        }
        EXPECT_TRUE(read_file(file("a.mp4")) == whole) << after_s;
        for (const char* const name : {"a.mp4", "a.mp4.parts", "copy.mp4", "copy.mp4.parts"})
            std::filesystem::remove_all(file(name));
    }
    RecordProperty("folders", folders);
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

TEST_F(Resume, RefusesChunksOfAnotherRenderNamingTheDifference) {
    const std::vector<std::string> more{"--duration", "600", "--set", "solver.method=exact"};
    interrupt("a.mp4", "KILL", 0.0, From::kFirstChunk, more);
    const std::string first = first_chunk("a.mp4");
    ASSERT_NE(first, "");
    const auto refused = [&](const std::vector<std::string>& other) {
        std::vector<std::string> all{"--set", "solver.method=exact"};
        all.insert(all.end(), other.begin(), other.end());
        const auto result = run_corda(render("a.mp4", all));
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_EQ(first_chunk("a.mp4"), first);
        return result.err;
    };
    EXPECT_THAT(refused({"--resume", "--duration", "600", "--crf", "30"}),
                HasSubstr("video.crf is 30 and was not given"));
    EXPECT_THAT(refused({"--resume"}), HasSubstr("frames is 0:600 and was 0:36000"));
    EXPECT_THAT(refused({"--shard", "0/2", "--duration", "600", "--set", "rope[0].mass=2"}),
                HasSubstr("rope[0].mass is 2 and was 1"));
    EXPECT_THAT(refused({"--resume", "--duration", "600", "--frames", "0:300"}),
                HasSubstr("frames is 0:300 and was 0:36000"));
    EXPECT_THAT(run_corda(render("a.mp4")).err, HasSubstr("resume it (--resume)"));
}

TEST_F(Resume, StartsOverIfNoChunkIsUsable) {
    const std::vector<std::string> more{"--duration", "0.5", "--resume", "--json"};
    const auto anew = run_corda(render("a.mp4", more));
    EXPECT_EQ(anew.exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(anew.out).at("resumed_frames"), 0);
    EXPECT_EQ(run_corda(render("a.mp4", more)).exit_code, 6);  // the output exists
    std::filesystem::create_directory(file("b.mp4.parts"));
    EXPECT_EQ(run_corda(render("b.mp4", more)).exit_code, 0);
    test::write_file(file("c.mp4.parts"), "this is no folder");
    for (const char* const how : {"--resume", "--force"}) {
        const auto broken = run_corda(render("c.mp4", {"--duration", "0.5", how}));
        EXPECT_EQ(broken.exit_code, 6);
        EXPECT_THAT(broken.err, HasSubstr("c.mp4.parts' is no folder"));
    }
    EXPECT_EQ(read_file(file("c.mp4.parts")), "this is no folder");
    const auto pictures = run_corda(render("frames/%04d.png", more));
    EXPECT_EQ(pictures.exit_code, 2);
    EXPECT_THAT(pictures.err, HasSubstr("--frames FIRST:END"));
}

TEST_F(Resume, RecoveredVideoRecordsItsFrames) {
    const std::vector<std::string> more{"--duration", "20", "--set", "solver.method=exact"};
    interrupt("a.mp4", "INT", 0.0, From::kFirstChunk, more);
    const auto recovered = run_corda({"recover", file("a.mp4.parts") + "/", "--json"});
    ASSERT_EQ(recovered.exit_code, 0) << recovered.err;
    const auto again = run_corda({"render", "--from", file("a.mp4"), "-o", file("b.mp4"), "--json"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(nlohmann::json::parse(again.out).at("frames"),
              nlohmann::json::parse(recovered.out).at("frames"));
}

TEST_F(Resume, AFolderWithoutAChunkCannotBeRecovered) {
    std::filesystem::create_directory(file("a.mp4.parts"));
    const auto refused = run_corda({"recover", file("a.mp4.parts")});
    EXPECT_EQ(refused.exit_code, 7);
    EXPECT_THAT(refused.err, HasSubstr("has no manifest"));
    EXPECT_EQ(run_corda(render("a.mp4", {"--duration", "1"})).exit_code, 0);
}

TEST_F(Resume, RefusesADamagedManifest) {
    const std::vector<std::string> more{"--duration", "20", "--set", "solver.method=exact"};
    interrupt("a.mp4", "INT", 0.0, From::kFirstChunk, more);
    test::write_file(file("a.mp4.parts/corda.json"), "{");
    std::vector<std::string> again = more;
    again.emplace_back("--resume");
    const auto refused = run_corda(render("a.mp4", again));
    EXPECT_EQ(refused.exit_code, 7);
    EXPECT_THAT(refused.err, HasSubstr("start again (--force without --resume)"));
    EXPECT_NE(first_chunk("a.mp4"), "");
    again.back() = "--force";
    EXPECT_EQ(run_corda(render("a.mp4", again)).exit_code, 0);
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"a.mp4"});
}

TEST_F(Resume, NamesDamagedChunksAndMakesThemAgain) {
    const std::vector<std::string> more{"--duration", "20", "--set", "solver.method=exact"};
    const std::string whole = bytes_of_a_whole("whole.mp4", more);
    interrupt("a.mp4", "INT", 0.0, From::kSecondChunk, more);
    damage("a.mp4.parts/" + first_chunk("a.mp4"));
    const auto recovered = run_corda({"recover", file("a.mp4.parts")});
    EXPECT_EQ(recovered.exit_code, 7);
    EXPECT_THAT(recovered.err, HasSubstr("chunk 0 (frames 0..59) is damaged"));
    std::vector<std::string> again = more;
    again.emplace_back("--resume");
    const auto resumed = run_corda(render("a.mp4", again));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.err, HasSubstr("damaged since they were written, and made again: chunk 0"));
    EXPECT_TRUE(read_file(file("a.mp4")) == whole);
}

TEST_F(Resume, RecoversUpToTheFirstGapAndNamesIt) {
    const std::vector<std::string> more{"--duration", "4"};
    for (const char* const shard : {"0/4", "1/4", "3/4"}) {
        std::vector<std::string> part = more;
        part.insert(part.end(), {"--shard", shard});
        ASSERT_EQ(run_corda(render("a.mp4", part)).exit_code, 0);
    }
    const auto recovered = run_corda({"recover", file("a.mp4.parts"), "--json"});
    EXPECT_EQ(recovered.exit_code, 0);
    EXPECT_THAT(recovered.err,
                HasSubstr("chunk 2 (frames 120..179) is missing; the 120 frames before it were "
                          "recovered, and 1 chunk file left out"));
    const auto report = nlohmann::json::parse(recovered.out);
    EXPECT_EQ(report.at("frames"), 120);
    EXPECT_EQ(report.at("truncated"), true);
    EXPECT_EQ(report.at("removed"), false);
}

/// `corda render --shard`: several processes make the chunks of one video.
class Shards : public Resume {
  protected:
    [[nodiscard]] std::string command(const std::string& shard) const {
        std::string text = test::quoted(CORDA_PROGRAM);
        for (const std::string& word : render("a.mp4", {"-q", "--duration", "12", "--shard", shard}))
            text += " " + quoted(word);
        return text;
    }
    void expect_joined(const std::string& whole) const {
        EXPECT_FALSE(std::filesystem::exists(file("a.mp4")));
        const auto joined = run_corda(render("a.mp4", {"--duration", "12", "--resume", "--json"}));
        EXPECT_EQ(joined.exit_code, 0) << joined.err;
        EXPECT_EQ(nlohmann::json::parse(joined.out).at("chunks"), 0);
        EXPECT_TRUE(read_file(file("a.mp4")) == whole);
        EXPECT_FALSE(std::filesystem::exists(file("a.mp4.parts")));
        std::filesystem::remove(file("a.mp4"));
    }
};

TEST_F(Shards, GiveTheBytesOfOneRenderInAnyOrderAndSideBySide) {
    const std::string whole = bytes_of_a_whole("whole.mp4", {"--duration", "12"});
    const auto first = run_corda(render("a.mp4", {"--duration", "12", "--shard", "2/3", "--json"}));
    ASSERT_EQ(first.exit_code, 0) << first.err;
    const auto report = nlohmann::json::parse(first.out);
    EXPECT_EQ(report.at("shard"), "2/3");
    EXPECT_EQ(report.at("chunks"), 4);
    EXPECT_EQ(report.at("frames"), 240);
    EXPECT_EQ(test::run_shell(command("0/3")).out, file("a.mp4.parts") + "\n");
    EXPECT_EQ(test::run_shell(command("1/3")).exit_code, 0);
    expect_joined(whole);
    const auto all = test::run_shell(command("0/3") + " & a=$!; " + command("1/3") + " & b=$!; " +
                                     command("2/3") + " & c=$!; wait $a && wait $b && wait $c");
    EXPECT_EQ(all.exit_code, 0) << all.err;
    expect_joined(whole);
    // The same shard twice at a time, and one that is killed.
    const auto twice = test::run_shell(command("0/1") + " & a=$!; " + command("0/1") + " & b=$!; " +
                                       command("1/2") + " & c=$!; sleep 0.3; kill -9 $c; wait $a && wait $b");
    EXPECT_EQ(twice.exit_code, 0) << twice.err;
    expect_joined(whole);
}

TEST_F(Shards, KeepOthersFromTheFolder) {
    const auto both =
        test::run_shell(command("0/2") + " & a=$!; until [ -e " + file("a.mp4.parts/corda.json") +
                        " ]; do sleep 0.01; done; " + test::quoted(CORDA_PROGRAM) +
                        " render " CORDA_EXAMPLES "/first.toml --duration 1 --force -o " + file("a.mp4") +
                        "; echo $?; wait $a; echo $?");
    EXPECT_EQ(both.out, "6\n" + file("a.mp4.parts") + "\n0\n") << both.err;
    EXPECT_THAT(both.err, HasSubstr("another render is writing"));
}

TEST_F(Shards, AreWordsOfTwoNumbers) {
    for (const char* const text : {"3/3", "-1/3", "0/0", "1", "1/", "/2", "1/2/3", "a/b", "1/2 ", "01/2",
                                   "1/-2", "0/99999999999999999999"}) {
        const auto refused = run_corda(render("a.mp4", {"--shard=" + std::string(text)}));
        EXPECT_EQ(refused.exit_code, 2) << text;
        EXPECT_THAT(refused.err, HasSubstr("is not I/N")) << text;
    }
    for (const char* const other : {"--resume", "--force"})
        EXPECT_EQ(run_corda(render("a.mp4", {"--shard", "0/2", other})).exit_code, 2) << other;
    const auto pictures = run_corda(render("frames/%04d.png", {"--shard", "0/2"}));
    EXPECT_EQ(pictures.exit_code, 2);
    EXPECT_THAT(pictures.err, HasSubstr("has no chunk files, which --shard needs"));
    EXPECT_TRUE(folder_.files().empty());
}

}  // namespace
}  // namespace corda
