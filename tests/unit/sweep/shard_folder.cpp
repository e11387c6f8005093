// Folders of any origin: nothing of others is lost, and no file crashes or blocks a sweep.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "corda/core/text.hpp"
#include "corda/sweep/shard_folder.hpp"
#include "corda/sweep/sweep.hpp"
#include "support/failure.hpp"
#include "unit/sweep/support.hpp"

namespace corda::sweep {
namespace {

using testing::HasSubstr;

class ShardFolder : public testing::Test {
  protected:
    ShardFolder() { std::filesystem::create_directory(folder_.file("out")); }

    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file("out/" + name); }
    [[nodiscard]] RunDef def() const {
        RunDef def;
        def.folder = folder_.file("out");
        return def;
    }
    [[nodiscard]] test::Failure failure_of(const RunDef& def) const {
        return test::failure_of([&] { run_sweep(sweep_, def); });
    }

    SweepFolder folder_;
    const SweepDef sweep_ = folder_.load(
        "samples = 4\nshard_samples = 1\n[vary]\n\"rope[0].mass\" = { uniform = [1.0, 2.0] }\n"
        "[output]\npictures = \"none\"\n");
};

TEST_F(ShardFolder, KeepsFilesOfOthers) {
    for (const std::string name : {"shard-000000.tar", "metadata.csv", "shard-000007.json"}) {
        test::write_file(file(name), "precious");
        for (const bool force : {false, true}) {
            RunDef forced = def();
            forced.force = force;
            const test::Failure failure = failure_of(forced);
            EXPECT_EQ(failure.code, ExitCode::kIo);
            EXPECT_THAT(failure.message, HasSubstr(name + "' is there, and no manifest of a sweep"));
        }
        EXPECT_EQ(test::read_file(file(name)), "precious");
        std::filesystem::remove(file(name));
    }
    for (const std::string name : {"shard-notes.txt", "shard-train-000000.tar", "shard-00.tar"})
        test::write_file(file(name), "precious");
    RunDef forced = def();
    forced.force = true;
    EXPECT_TRUE(run_sweep(sweep_, forced).is_complete);
    for (const std::string name : {"shard-notes.txt", "shard-train-000000.tar", "shard-00.tar"})
        EXPECT_EQ(test::read_file(file(name)), "precious");
}

TEST_F(ShardFolder, IsReplacedOnceASampleIsMade) {
    EXPECT_TRUE(run_sweep(sweep_, def()).is_complete);
    const std::string shard = test::read_file(file("shard-000003.tar"));
    RunDef forced = def();
    forced.force = true;
    forced.on_progress = [](std::int64_t, std::int64_t) { return false; };
    EXPECT_EQ(failure_of(forced).code, ExitCode::kInterrupted);
    EXPECT_EQ(test::read_file(file("shard-000003.tar")), shard);
}

TEST_F(ShardFolder, IsMendedWithoutItsManifest) {
    EXPECT_TRUE(run_sweep(sweep_, def()).is_complete);
    const std::string manifest = test::read_file(file("manifest.json"));
    std::filesystem::remove(file("manifest.json"));
    EXPECT_EQ(run_sweep(sweep_, def()).shards_made, 0);
    EXPECT_EQ(test::read_file(file("manifest.json")), manifest);
}

TEST_F(ShardFolder, RefusesLinksAndPipes) {
    test::write_file(folder_.file("victim"), "precious");
    for (const std::string name : {"shard-000002.tar", "shard-000002.json", "metadata.csv"}) {
        EXPECT_TRUE(run_sweep(sweep_, def()).is_complete);
        for (const bool is_pipe : {false, true}) {
            std::filesystem::remove(file(name));
            if (is_pipe)
                ASSERT_EQ(::mkfifo(file(name).c_str(), 0600), 0);
            else
                std::filesystem::create_symlink(folder_.file("victim"), file(name));
            const test::Failure failure = failure_of(def());
            EXPECT_EQ(failure.code, ExitCode::kIo) << name;
            EXPECT_THAT(failure.message, HasSubstr(name + "' is no ordinary file"));
            EXPECT_FALSE(check_sweep(sweep_, folder_.file("out")).empty());
        }
        std::filesystem::remove(file(name));
    }
    EXPECT_EQ(test::read_file(folder_.file("victim")), "precious");
}

TEST_F(ShardFolder, TakesAnyJsonForAnIndex) {
    EXPECT_TRUE(run_sweep(sweep_, def()).is_complete);
    const std::string shard = test::read_file(file("shard-000001.tar"));
    const std::string deep(300'000, '[');
    const Json sound = Json::parse(test::read_file(file("shard-000001.json")));
    std::vector<std::string> texts{R"({"checksum":1,"rows":)" + deep, R"({"made_from":{"a":)" + deep, "[]",
                                   ""};
    for (const auto& [key, value] : std::vector<std::pair<std::string, Json>>{
             {"rows", {1}},
             {"rows", 7},
             {"made_from", {1}},
             {"bytes", -1},
             {"bytes", 1e300},
             {"sha256", 1},
             {"rows", {{{"key", "000001"}, {"split", 1}}}},
             {"rows", {{{"key", "000001"}, {"split", ""}, {"failure", "no object"}}}}}) {
        Json forged = sound;
        forged[key] = value;
        forged.erase("checksum");
        forged["checksum"] = hash_text(forged.dump());
        texts.push_back(forged.dump());
    }
    for (const std::string& text : texts) {
        test::write_file(file("shard-000001.json"), text);
        EXPECT_FALSE(check_sweep(sweep_, folder_.file("out")).empty()) << text.substr(0, 100);
        EXPECT_EQ(run_sweep(sweep_, def()).shards_made, 1) << text.substr(0, 100);
        EXPECT_EQ(test::read_file(file("shard-000001.tar")), shard);
    }
}

TEST_F(ShardFolder, IsSharedByAnyNumberOfProcesses) {
    RunDef shared = def();
    shared.shard = Shard{2, std::numeric_limits<std::int64_t>::max()};
    EXPECT_EQ(run_sweep(sweep_, shared).shards_made, 1);
    EXPECT_TRUE(std::filesystem::exists(file("shard-000002.tar")));
    shared.shard = Shard{100, 101};
    EXPECT_EQ(run_sweep(sweep_, shared).shards, 0);
}

TEST(SweepKeys, ThatOverlapAreRefused) {
    const SweepFolder folder;
    for (const auto& [one, other] :
         {std::pair<std::string, std::string>{"rope[0].hang.links", "rope[0].hang"},
          {"rope[0].mass", "rope[00].mass"},
          {"camera.center[0]", "camera.center"}}) {
        const test::Failure failure = test::failure_of([&, key = one, within = other] {
            static_cast<void>(
                folder.load("samples = 1\n[vary]\n\"" + key + "\" = [1]\n\"" + within + "\" = [2]\n"));
        });
        EXPECT_EQ(failure.code, ExitCode::kInvalidScene);
        EXPECT_THAT(failure.message, HasSubstr("which varies, too; leave one of them out")) << one;
    }
}

}  // namespace
}  // namespace corda::sweep
