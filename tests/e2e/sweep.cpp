// `corda sweep` makes the same files in every way, and names damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "support/command.hpp"

namespace corda {
namespace {

using nlohmann::json;
using test::CommandResult;
using test::quoted;
using test::read_file;
using test::run_corda;
using test::run_shell;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string kSceneOfSweep = R"(schema = 1
[world]
duration = 0.2
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 40.0 }
[solver]
method = "exact"
[video]
size = [64, 48]
fps = 30
)";

const std::string kVaried = R"("rope[0].hang.angle_deg" = { uniform = [5.0, 90.0] }
"rope[0].hang.links" = { integer = [1, 5] }
"rope[0].mass" = { log_uniform = [0.01, 10.0] }
"world.gravity" = [1.62, [0.5, -9.81]]
)";

class Sweep : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

    /// Writes a sweep file; `head` are its first keys.
    void define(const std::string& head, const std::string& vary = kVaried,
                const std::string& rest = "") const {
        static_cast<void>(folder_.write(
            "sweep.toml", "schema = 1\nscene = \"scene.toml\"\n" + head + "\n[vary]\n" + vary + rest));
    }
    [[nodiscard]] CommandResult sweep(const std::string& name, const std::vector<std::string>& more = {},
                                      const std::string& environment = "") const {
        std::vector<std::string> all{"sweep", file("sweep.toml"), "-o", file(name)};
        all.insert(all.end(), more.begin(), more.end());
        return run_corda(all, environment);
    }
    /// The same as a command of the shell.
    [[nodiscard]] std::string command(const std::string& name, const std::string& more = "") const {
        return quoted(CORDA_PROGRAM) + " sweep " + quoted(file("sweep.toml")) + " -q -o " +
               quoted(file(name)) + " " + more;
    }
    /// SHA-256 and name of every file of a folder, hidden ones as well, but for the temporary files of killed
    /// processes.
    [[nodiscard]] std::string sums(const std::string& name) const {
        const auto result = run_shell("cd " + quoted(file(name)) +
                                      " && find . -type f ! -name '*.tmp' | LC_ALL=C sort | xargs sha256sum");
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return result.out;
    }
    /// Those of a sweep that is made by one process.
    [[nodiscard]] std::string expected_sums() const {
        const auto made = sweep("whole", {"--jobs", "1"});
        EXPECT_EQ(made.exit_code, 0) << made.err;
        return sums("whole");
    }
    [[nodiscard]] json manifest(const std::string& name) const {
        return json::parse(read_file(file(name + "/manifest.json")));
    }
    void damage(const std::string& name) const {
        std::string bytes = read_file(file(name));
        ASSERT_GT(bytes.size(), 100U);
        bytes[bytes.size() / 2] ^= 1;
        test::write_file(file(name), bytes);
    }

    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", kSceneOfSweep);
};

/// Pictures of samples against those of `corda render`.
class SweepPictures : public Sweep {
  protected:
    /// Runs the sweep, unpacks its one shard, and renders each sample to `output`, which holds its key.
    void make(const std::string& output) const {
        ASSERT_EQ(sweep("out").exit_code, 0);
        ASSERT_EQ(run_shell("tar -xf " + file("out/shard-000000.tar") + " -C " + file("out")).exit_code, 0);
        for (const std::string& key : keys_) {
            const json info = json::parse(read_file(file("out/" + key + ".json")));
            EXPECT_EQ(info.at("key"), key);
            std::string name = output;
            name.replace(name.find("KEY"), 3, key);
            std::vector<std::string> render{"render", scene_, "-o", file(name)};
            for (const auto& [parameter, value] : info.at("parameters").items()) {
                std::string text = value.dump();
                if (const auto comma = text.find(','); comma != std::string::npos)
                    text.insert(comma + 1, " ");
                render.insert(render.end(), {"--set", parameter + "=" + text});  // as metadata.csv has it
            }
            const auto rendered = run_corda(render);
            ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
        }
    }
    void expect_equal_files(const std::string& first, const std::string& second) const {
        const std::string bytes = read_file(file(first));
        EXPECT_GT(bytes.size(), 100U) << first;
        EXPECT_TRUE(bytes == read_file(file(second))) << first;
    }

    const std::vector<std::string> keys_{"000000", "000001"};
};
TEST_F(SweepPictures, ClipsEqualRenders) {
    const std::string automatic =
        "schema = 1\n[world]\nduration = 0.5\n[[rope]]\nhang = { links = 3, length = 1.0, "
        "angle_deg = 40.0 }\n[video]\nsize = [64, 48]\nfps = \"30000/1001\"\n";
    std::string longer = kSceneOfSweep + "shutter = 0.5\nsubframes = 2\ncrf = 30\n[style]\ntrail_s = 0.5\n";
    longer.replace(longer.find("0.2"), 3, "4.5");  // 135 frames: several key frames
    for (const std::string& scene : {automatic, longer}) {
        static_cast<void>(folder_.write("scene.toml", scene));
        define("samples = 2");
        make("KEY.mp4");
        for (const std::string& key : keys_) expect_equal_files("out/" + key + ".mp4", key + ".mp4");
        for (const char* const name : {"out", "000000.mp4", "000001.mp4"})
            std::filesystem::remove_all(file(name));
    }
}

TEST_F(SweepPictures, PngFramesEqualRenders) {
    define("samples = 2", kVaried, "[output]\npictures = \"png\"\n");
    make("KEY/%06d.png");
    for (const std::string& key : keys_) {
        const int frames = json::parse(read_file(file("out/" + key + ".json"))).at("frames").get<int>();
        EXPECT_EQ(frames, 6);
        for (int k = 0; k < frames; ++k) {
            const std::string name = "00000" + std::to_string(k) + ".png";
            expect_equal_files("out/" + key + "." + name, key + "/" + name);
        }
        EXPECT_FALSE(std::filesystem::exists(file("out/" + key + ".000006.png")));
    }
}

TEST_F(Sweep, HasTheSameFilesForAnyNumberOfJobs) {
    define("samples = 7\nshard_samples = 3\nseed = 11", kVaried, "[split]\ntrain = 0.5\ntest = 0.5\n");
    const std::string whole = expected_sums();
    EXPECT_EQ(std::count(whole.begin(), whole.end(), '\n'), 3 * 2 + 2);
    for (const char* const jobs : {"0", "3"}) {
        ASSERT_EQ(sweep(jobs, {"--jobs", jobs}).exit_code, 0);
        EXPECT_EQ(sums(jobs), whole) << jobs;
    }
    const json all = manifest("whole");
    EXPECT_EQ(all.at("samples"), 7);
    EXPECT_EQ(all.at("complete"), true);
    for (const json& shard : all.at("shards"))
        EXPECT_THAT(whole, HasSubstr(shard.at("sha256").get<std::string>() + "  ./" +
                                     shard.at("file").get<std::string>()));
    EXPECT_EQ(all.at("splits").at("train").get<int>() + all.at("splits").at("test").get<int>(), 7);
}

const std::string kQuick = "[output]\npictures = \"none\"\nlabels = [\"positions\", \"mask\"]\n";

TEST_F(Sweep, HasTheSameFilesFromSixtyFourProcessesInAnyOrder) {
    define("samples = 64\nshard_samples = 1", kVaried, kQuick);
    const std::string whole = expected_sums();
    std::vector<int> order(64);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    std::shuffle(order.begin(), order.end(), std::mt19937(64));  // NOLINT(cert-msc51-cpp)
    std::string tasks;
    for (const int task : order) tasks += std::to_string(task) + "\\n";
    const auto all = run_shell("printf '" + tasks + "' | xargs -P 4 -I TASK " +
                               command("tasks", "--jobs 1 --shard TASK/64"));
    EXPECT_EQ(all.exit_code, 0) << all.err;
    EXPECT_EQ(sums("tasks"), whole);
}

TEST_F(Sweep, TwoOfOneFolderAtATimeGiveTheSameFiles) {
    define("samples = 12\nshard_samples = 2");
    const std::string whole = expected_sums();
    const auto both =
        run_shell(command("both") + " & a=$!; " + command("both") + " & b=$!; wait $a && wait $b");
    EXPECT_EQ(both.exit_code, 0) << both.err;
    EXPECT_EQ(sums("both"), whole);
}

TEST_F(Sweep, RefusedSamplesAreCountedAndNamed) {
    // Particles that are too heavy, and a relaxation that diverges.
    define("samples = 8",
           "\"rope[0].payload\" = { normal = [0.0, 1.0] }\n\"solver.force\" = [[0.0, -9.8], [1e300, 0.0]]\n",
           kQuick + "[split]\ntrain = 1\n");
    std::string scene = kSceneOfSweep;
    scene.replace(scene.find("\"exact\""), 7, "\"relaxation\"\nreach = 1");
    static_cast<void>(folder_.write("scene.toml", scene));
    const auto made = sweep("out", {"--json"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const json all = manifest("out");
    const int failed = all.at("failed").get<int>();
    EXPECT_THAT(made.err, HasSubstr(std::to_string(failed) + " samples refused, see column \"failure\""));
    EXPECT_EQ(json::parse(made.out).at("failed"), failed);
    EXPECT_EQ(all.at("samples"), 8 - failed);
    EXPECT_EQ(all.at("splits").at("train"), 8 - failed);
    EXPECT_EQ(all.at("shards")[0].at("failed"), failed);
    int invalid = 0;
    int diverged = 0;
    const std::string metadata = read_file(file("out/metadata.csv"));
    const std::string names = run_shell("tar -tf " + file("out/shard-000000.tar")).out;
    for (const json& failure : all.at("failures")) {
        const int code = failure.at("failure").at("code").get<int>();
        const auto message = failure.at("failure").at("message").get<std::string>();
        invalid += code == 3 ? 1 : 0;
        diverged += code == 8 ? 1 : 0;
        EXPECT_THAT(message, HasSubstr(code == 3 ? "vary rope[0].payload=" : "diverged"));
        const auto key = failure.at("key").get<std::string>();
        EXPECT_THAT(names, Not(HasSubstr(key)));
        const std::size_t row = metadata.find("\n" + key + ",");
        ASSERT_NE(row, std::string::npos);
        EXPECT_THAT(metadata.substr(row, metadata.find("\n0", row + 1) - row),
                    HasSubstr(message.substr(0, 20)));
    }
    EXPECT_EQ(invalid + diverged, failed);
    EXPECT_GT(invalid, 0);
    EXPECT_GT(diverged, 0);
    EXPECT_LT(failed, 8);
    EXPECT_EQ(sweep("out", {"--check"}).exit_code, 0);
}

TEST_F(Sweep, FailsIfAllSamplesAreRefused) {
    define("samples = 3", "\"rope[0].hang.links\" = { uniform = [3.1, 3.9] }\n", kQuick);
    const auto refused = sweep("out");
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("all samples were refused; the first, 000000: "),
                                   HasSubstr("rope[0].hang.links")));
    EXPECT_EQ(sweep("out").exit_code, 3);  // although its shard is there
}

TEST_F(Sweep, NeedsAFolder) {
    define("samples = 3", kVaried, kQuick);
    EXPECT_EQ(run_corda({"sweep", file("sweep.toml"), "-o", "-"}).exit_code, 2);
}

TEST_F(Sweep, CheckComparesTheSummariesWithTheShards) {
    define("samples = 3", kVaried, kQuick);
    ASSERT_EQ(sweep("out").exit_code, 0);
    const std::string whole = sums("out");
    for (const std::string name : {"out/metadata.csv", "out/manifest.json"}) {
        const std::string text = read_file(file(name));
        test::write_file(file(name), text.substr(0, text.size() - 2) + " \n");
        const auto checked = sweep("out", {"--check"});
        EXPECT_EQ(checked.exit_code, 7);
        EXPECT_THAT(checked.err, HasSubstr(file(name) + "' does not say what the shards hold"));
        std::filesystem::remove(file(name));
        EXPECT_EQ(sweep("out").exit_code, 0);
        EXPECT_EQ(sums("out"), whole);
    }
}

TEST_F(Sweep, AFullDiskKeepsFinishedShards) {
    define("grid = true\nshard_samples = 1", "\"world.duration\" = [0.1, 10.0, 0.2]\n", kQuick);
    const std::string whole = expected_sums();
    ASSERT_GT(std::filesystem::file_size(file("whole/shard-000001.tar")), 30'000U);
    ASSERT_LT(std::filesystem::file_size(file("whole/shard-000000.tar")), 8'000U);
    // Limits the size of a file in KiB, which a program sees as a full disk.
    const auto full = run_shell("trap '' XFSZ; ulimit -f 12; " + command("out", "--jobs 2"));
    EXPECT_EQ(full.exit_code, 6);
    EXPECT_THAT(full.err, AllOf(HasSubstr("shard-000001.tar"), HasSubstr("File too large")));
    EXPECT_THAT(run_shell("ls -A " + file("out")).out,
                "manifest.json\nshard-000000.json\nshard-000000.tar\n");
    const auto again = sweep("out", {"--json"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out).at("shards_made"), 2);
    EXPECT_EQ(sums("out"), whole);
}

TEST_F(Sweep, AFolderOfAnotherSweepIsRefusedNamingTheDifference) {
    define("samples = 4\nshard_samples = 2", kVaried, kQuick);
    const std::string whole = expected_sums();
    ASSERT_EQ(sweep("out").exit_code, 0);
    const auto refused = [&](const std::string& difference) {
        const auto result = sweep("out");
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.err, AllOf(HasSubstr("manifest.json' is of another sweep: " + difference),
                                      HasSubstr("; choose another folder"), HasSubstr("--force")));
        EXPECT_EQ(sums("out"), whole);
    };
    define("samples = 4\nshard_samples = 2\nseed = 8", kVaried, kQuick);
    refused("seed is 8 and was 0");
    define("samples = 4\nshard_samples = 2", kVaried + "\"world.drag\" = [0.1]\n", kQuick);
    refused("vary.\"world.drag\" is [0.1] and was not given");
    define("samples = 4\nshard_samples = 2", kVaried, kQuick);
    static_cast<void>(folder_.write("scene.toml", kSceneOfSweep + "crf = 30\n"));
    refused("scene is ");
    ASSERT_EQ(sweep("out", {"--force"}).exit_code, 0);
    EXPECT_NE(sums("out"), whole);
    static_cast<void>(folder_.write("scene.toml", kSceneOfSweep));
    ASSERT_EQ(sweep("out", {"--force"}).exit_code, 0);
    EXPECT_EQ(sums("out"), whole);
    test::write_file(file("out/manifest.json"), "{}");
    const auto foreign = sweep("out");
    EXPECT_EQ(foreign.exit_code, 6);
    EXPECT_THAT(foreign.err, HasSubstr("manifest.json' is no manifest of a sweep; move it away"));
}

TEST_F(Sweep, AShardOfAnotherSweepIsRefusedNamingTheDifference) {
    define("samples = 4\nshard_samples = 2\nseed = 8", kVaried, kQuick);
    ASSERT_EQ(sweep("other").exit_code, 0);
    define("samples = 4\nshard_samples = 2", kVaried, kQuick);
    const std::string whole = expected_sums();
    ASSERT_EQ(sweep("out").exit_code, 0);
    for (const char* const name : {"/shard-000001.tar", "/shard-000001.json"})
        std::filesystem::copy_file(file(std::string("other") + name), file(std::string("out") + name),
                                   std::filesystem::copy_options::overwrite_existing);
    const auto refused = sweep("out");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("shard-000001.tar' is of another sweep: seed is 0 and was 8; "));
    const auto checked = sweep("out", {"--check"});
    EXPECT_EQ(checked.exit_code, 7);
    EXPECT_THAT(checked.err, HasSubstr("shard-000001.tar' is of another sweep: seed is 0 and was 8; "));
    for (const char* const name : {"out/shard-000001.tar", "out/shard-000001.json"})
        std::filesystem::remove(file(name));
    EXPECT_EQ(sweep("out").exit_code, 0);
    EXPECT_EQ(sums("out"), whole);
}

TEST_F(Sweep, GrowsAndDoesNotShrink) {
    define("samples = 3\nshard_samples = 2", kVaried, kQuick);
    ASSERT_EQ(sweep("out").exit_code, 0);
    define("samples = 7\nshard_samples = 2", kVaried, kQuick);
    const auto longer = sweep("out", {"--json"});
    ASSERT_EQ(longer.exit_code, 0) << longer.err;
    EXPECT_EQ(json::parse(longer.out).at("shards_made"), 3);  // the second had one sample
    EXPECT_EQ(sums("out"), expected_sums());
    define("samples = 3\nshard_samples = 2", kVaried, kQuick);
    const auto shorter = sweep("out");
    EXPECT_EQ(shorter.exit_code, 2);
    EXPECT_THAT(shorter.err, HasSubstr("' is of a sweep of more samples; move it away"));
    EXPECT_EQ(sweep("out", {"--check"}).exit_code, 7);
    define("samples = 6\nshard_samples = 2", kVaried, kQuick);
    ASSERT_EQ(sweep("out", {"--force"}).exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(file("out/shard-000003.tar")));
    const std::string kept = sums("out");
    define("samples = 5\nshard_samples = 2", kVaried, kQuick);  // with as many shards
    EXPECT_EQ(sweep("out").exit_code, 2);
    EXPECT_EQ(sums("out"), kept);
}

TEST_F(Sweep, CheckNamesWhatIsWrongAndItsAdviceWorks) {
    define("samples = 6\nshard_samples = 2", kVaried, kQuick);
    const std::string whole = expected_sums();
    ASSERT_EQ(sweep("out").exit_code, 0);
    const auto sound = sweep("out", {"--check"});
    EXPECT_EQ(sound.exit_code, 0) << sound.err;
    EXPECT_THAT(sound.out, HasSubstr("all shards are as they were written"));
    const std::string shard = file("out/shard-000001.tar");
    const auto expect_named = [&](const std::string& problem) {
        const auto checked = sweep("out", {"--check", "--json"});
        EXPECT_EQ(checked.exit_code, 7);
        const json report = json::parse(checked.out);
        EXPECT_EQ(report.at("ok"), false);
        ASSERT_EQ(report.at("problems").size(), 1U) << report;
        EXPECT_EQ(report.at("problems")[0], "'" + shard + "' " + problem);
        EXPECT_THAT(checked.err, HasSubstr(problem));
    };
    const auto expect_mended = [&] {
        EXPECT_EQ(sweep("out").exit_code, 0);
        EXPECT_EQ(sums("out"), whole);
        EXPECT_EQ(sweep("out", {"--check"}).exit_code, 0);
    };
    damage("out/shard-000001.tar");
    expect_named(
        "is damaged: its SHA-256 is another one than its index says; remove it, and run the sweep again");
    std::filesystem::remove(shard);
    expect_named("is missing; run the sweep again");
    expect_mended();
    std::filesystem::resize_file(shard, 1000);
    expect_named("does not fit its index; run the sweep again");
    expect_mended();
    damage("out/shard-000001.json");
    expect_named("does not fit its index; run the sweep again");
    expect_mended();
    std::filesystem::remove(file("out/shard-000001.json"));
    expect_named("does not fit its index; run the sweep again");
    expect_mended();
    const auto nothing = sweep("nothing", {"--check"});
    EXPECT_EQ(nothing.exit_code, 7);
    EXPECT_THAT(nothing.err,
                AllOf(HasSubstr("shard-000000.tar' is missing"), HasSubstr("shard-000002.tar' is missing")));
    EXPECT_FALSE(std::filesystem::exists(file("nothing")));
}

TEST_F(Sweep, ReportsAndErrorsAreJson) {
    define("samples = 5\nshard_samples = 2", kVaried, kQuick);
    const auto part = sweep("out", {"--json", "--shard", "1/2"});
    ASSERT_EQ(part.exit_code, 0) << part.err;
    json report = json::parse(part.out);
    EXPECT_GT(report.at("wall_s"), 0.0);
    report.erase("wall_s");
    EXPECT_EQ(report, (json{{"schema", 1},
                            {"output", file("out")},
                            {"samples", 5},
                            {"shards", 1},
                            {"shards_made", 1},
                            {"samples_made", 2},
                            {"failed", 0},
                            {"complete", false},
                            {"figures", json::array()}}));
    const auto rest = json::parse(sweep("out", {"--json"}).out);
    EXPECT_EQ(rest.at("shards"), 3);
    EXPECT_EQ(rest.at("shards_made"), 2);
    EXPECT_EQ(rest.at("complete"), true);
    EXPECT_EQ(sweep("out").out, file("out") + "\n");
    EXPECT_EQ(sweep("out", {"--shard", "2/2"}).exit_code, 2);
    EXPECT_EQ(sweep("out", {"--check", "--force"}).exit_code, 2);
    define("samples = 0");
    const auto wrong = sweep("out", {"--json"});
    EXPECT_EQ(wrong.exit_code, 3);
    const json error = json::parse(wrong.out).at("error");
    EXPECT_EQ(error.at("code"), 3);
    EXPECT_THAT(error.at("message").get<std::string>(), StartsWith(file("sweep.toml") + ":3:11: samples: "));
}

TEST_F(Sweep, ReadsStandardInput) {
    define("samples = 3", kVaried, kQuick);
    const std::string whole = expected_sums();
    const auto piped =
        run_shell("cd " + folder_.path() + " && " + quoted(CORDA_PROGRAM) + " sweep - -o out < sweep.toml");
    EXPECT_EQ(piped.exit_code, 0) << piped.err;
    EXPECT_EQ(sums("out"), whole);
}

#ifndef CORDA_SANITIZE  // whose run time must be loaded first
/// 20 tasks of 2 samples; two are killed before they can name their shard, two at a random moment.
TEST_F(Sweep, HasTheSameFilesAfterKills) {
    define("samples = 40\nshard_samples = 2", kVaried, kQuick);
    const std::string whole = expected_sums();
    std::mt19937 random(20261126);  // NOLINT(cert-msc51-cpp): the same kills on every run
    std::vector<std::string> killed;
    for (int task = 0; task < 20; ++task) {
        const std::string run = command("tasks", "--shard " + std::to_string(task) + "/20");
        if (task % 10 == 3) {
            const auto result = run_shell("LD_PRELOAD=" FOREIGN_FAULTS " FSYNC_TAKES_MS=60000 " + run +
                                          " & pid=$!; until ls " + file("tasks") +
                                          "/*.tar.*.tmp >/dev/null 2>&1 || ! kill -0 $pid; do sleep 0.01; "
                                          "done; kill -9 $pid; wait $pid");
            EXPECT_EQ(result.exit_code, 137);
            killed.push_back(std::to_string(task));
        } else if (task % 10 == 7) {
            static_cast<void>(
                run_shell("timeout -s KILL 0." + std::to_string(10 + random() % 90) + " " + run));
        } else {
            const auto result = run_shell(run);
            EXPECT_EQ(result.exit_code, 0) << result.err;
        }
    }
    EXPECT_THAT(killed, ElementsAre("3", "13"));
    EXPECT_EQ(manifest("tasks").at("complete"), false);
    EXPECT_FALSE(std::filesystem::exists(file("tasks/shard-000003.tar")));
    EXPECT_FALSE(std::filesystem::exists(file("tasks/metadata.csv")));
    const auto again = sweep("tasks", {"--json"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_GE(json::parse(again.out).at("shards_made"), 2);
    EXPECT_LE(json::parse(again.out).at("shards_made"), 4);
    EXPECT_EQ(sums("tasks"), whole);
}

TEST_F(Sweep, AnInterruptKeepsFinishedShards) {
    define("samples = 40\nshard_samples = 1", kVaried, kQuick);
    const std::string whole = expected_sums();
    // Slowed down, so that the signal comes long before the end.
    const auto stopped = run_shell("LD_PRELOAD=" FOREIGN_FAULTS " FSYNC_TAKES_MS=300 " + command("out") +
                                   " & pid=$!; until [ -e " + file("out/shard-000000.json") +
                                   " ] || ! kill -0 $pid; do sleep 0.01; done; kill -INT $pid; wait $pid");
    EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
    EXPECT_THAT(stopped.err, HasSubstr("interrupted: finished shards stay in " + file("out")));
    EXPECT_TRUE(std::filesystem::exists(file("out/shard-000000.tar")));
    EXPECT_FALSE(std::filesystem::exists(file("out/shard-000039.tar")));
    EXPECT_EQ(run_shell("find " + file("out") + " -name '*.tmp'").out, "");
    const auto again = sweep("out", {"--json"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_LT(json::parse(again.out).at("shards_made"), 40);
    EXPECT_EQ(sums("out"), whole);
}

#endif

}  // namespace
}  // namespace corda
