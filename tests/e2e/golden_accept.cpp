// `corda golden --new` and `--accept`, and suites of which some pictures are asked for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/core/text.hpp"
#include "corda/media/defs.hpp"
#include "e2e/golden_suite.hpp"
#include "support/command.hpp"

namespace corda {
namespace {

namespace fs = std::filesystem;
using test::kGoldenScene;
using test::kMiddle;
using test::read_file;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kStart = "swing_t0000_000000.png";
constexpr const char* kEnd = "swing_t0001_000000.png";

class GoldenReview : public test::GoldenSuite {
  protected:
    /// Changes the scene, so that all three pictures differ.
    void change_scene(const std::string& key = "gravity = 5\n") const {
        std::string text = kGoldenScene;
        text.insert(text.find("duration"), key);
        text.replace(text.find("45.0"), 4, "46.0");
        test::write_file(folder_.file("scenes/swing.toml"), text);
    }

    [[nodiscard]] std::string fresh(const std::string& name = "") const {
        return folder_.file("new/" + name);
    }

    /// Draws the failed pictures.
    [[nodiscard]] test::CommandResult draw_new(std::vector<std::string> options = {}) const {
        options.insert(options.end(), {"--new", fresh()});
        return run(options);
    }

    /// The bytes of all references.
    [[nodiscard]] std::vector<std::string> references() const {
        std::vector<std::string> all;
        for (const char* const name : {kStart, kMiddle, kEnd}) all.push_back(read_file(reference(name)));
        return all;
    }

    /// Expects that nothing is accepted, for a reason.
    void expect_refused(const std::string& reason, const std::vector<std::string>& options = {}) const {
        const auto before = references();
        std::vector<std::string> arguments{"--accept", fresh()};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const auto result = run(arguments);
        EXPECT_EQ(result.exit_code, 2) << reason;
        EXPECT_THAT(result.err, HasSubstr(reason));
        EXPECT_EQ(references(), before) << reason;
    }
};

TEST_F(GoldenReview, AcceptsTheBytesThatAnUpdateWrites) {
    change_scene();
    const auto failed = draw_new({"--json"});
    EXPECT_EQ(failed.exit_code, 7);
    EXPECT_EQ(nlohmann::json::parse(failed.out)["pictures"][1]["new"], fresh(kMiddle));
    const auto before = references();
    const auto shown = run({"--accept", fresh(), "--dry-run"});
    EXPECT_EQ(shown.exit_code, 0) << shown.err;
    EXPECT_THAT(shown.out, HasSubstr("3 would be written or removed"));
    EXPECT_EQ(references(), before);
    const auto accepted = run({"--accept", fresh()});
    EXPECT_EQ(accepted.exit_code, 0) << accepted.err;
    EXPECT_THAT(accepted.out,
                HasSubstr("3 pictures: 0 passed, 0 failed, 0 missing, 0 stale, 3 written or removed"));
    const auto after = references();
    EXPECT_EQ(run().exit_code, 0);
    EXPECT_EQ(run({"--accept", fresh()}).exit_code, 0);  // once more
    fs::remove_all(folder_.file("ref"));
    EXPECT_EQ(run({"--update"}).exit_code, 0);
    EXPECT_EQ(references(), after);
}

TEST_F(GoldenReview, AcceptsOnePictureAndRejectsAnother) {
    change_scene();
    EXPECT_EQ(draw_new().exit_code, 7);
    const auto before = references();
    EXPECT_EQ(run({"--accept", fresh(), "--only", "swing_t0000_5*"}).exit_code, 0);
    EXPECT_EQ(references()[0], before[0]);
    EXPECT_NE(references()[1], before[1]);
    fs::remove(fresh(kStart));
    EXPECT_THAT(run({"--accept", fresh(), "--only", kStart}).err,
                AllOf(HasSubstr("nothing to accept: '"), HasSubstr("name some of "), HasSubstr(kEnd)));
    EXPECT_EQ(run({"--accept", fresh()}).exit_code, 0);
    EXPECT_EQ(references()[0], before[0]);
    EXPECT_NE(references()[2], before[2]);
    EXPECT_THAT(run().out, HasSubstr("3 pictures: 2 passed, 1 failed"));
}

TEST_F(GoldenReview, AcceptsMissingPicturesAndKeepsNothingOfEarlierRuns) {
    fs::remove(reference(kEnd));
    EXPECT_EQ(draw_new().exit_code, 7);
    EXPECT_FALSE(fs::exists(fresh(kMiddle)));
    EXPECT_EQ(run({"--accept", fresh()}).exit_code, 0);
    EXPECT_EQ(draw_new().exit_code, 0);
    EXPECT_FALSE(fs::exists(fresh(kEnd)));
    EXPECT_EQ(run({"--accept", fresh()}).exit_code, 0);
    fs::remove_all(fresh());
    EXPECT_EQ(draw_new().exit_code, 0);
    EXPECT_FALSE(fs::exists(fresh()));
}

TEST_F(GoldenReview, RefusesPicturesOfAnotherSuiteSceneOrReference) {
    fs::create_directory(fresh());
    fs::copy(reference(kMiddle), fresh(kMiddle));
    expect_refused("is no folder that corda golden --new has written");
    fs::remove_all(fresh());

    change_scene();
    EXPECT_EQ(draw_new().exit_code, 7);
    expect_refused("it is of another scene; world.drag is 0.1 and was 0 (by --set)",
                   {"--set", "world.drag=0.1"});
    expect_refused("it is of another scene; video.size is [64, 36]", {"--set", "golden.size=[64,36]"});
    expect_refused("no scene asks for it", {"--set", "golden.at=[0.0,1.0]"});

    const std::string drawn = read_file(fresh(kMiddle));
    fs::copy(fresh(kEnd), fresh(kMiddle), fs::copy_options::overwrite_existing);
    expect_refused("swing_t0000_500000.png: it was changed after corda golden --new wrote it");
    test::write_file(fresh(kMiddle), drawn);

    const std::string kept = read_file(reference(kMiddle));
    change_reference(kMiddle, [](Image& other, PngInfo&) { other.pixel(5, 5)[0] ^= 1U; });
    expect_refused("has changed since, or is another one");
    test::write_file(reference(kMiddle), kept);

    std::string manifest = read_file(fresh("golden.json"));
    manifest.replace(manifest.find("\"name\": \"swing"), 14, "\"name\": \"../..");
    test::write_file(fresh("golden.json"), manifest);
    expect_refused("is no name of a picture");
}

TEST_F(GoldenReview, RefusesWhatAForeignFolderHolds) {
    change_scene();
    EXPECT_EQ(draw_new().exit_code, 7);
    const std::string manifest = read_file(fresh("golden.json"));
    const auto change_manifest = [&](const auto& change) {
        auto json = nlohmann::json::parse(manifest);
        change(json["pictures"][1]);
        test::write_file(fresh("golden.json"), json.dump());
    };
    test::write_file(fresh(kMiddle), "no picture");
    change_manifest([](auto& picture) { picture["hash"] = hash_text("no picture"); });
    expect_refused("swing_t0000_500000.png: it is no picture: ");

    // A later --new removes what an earlier one wrote, and nothing else.
    test::write_file(fresh("mine"), "");
    test::write_file(fresh("mine.png"), "");
    change_manifest([](auto& picture) { picture["name"] = "mine.png"; });
    EXPECT_EQ(draw_new().exit_code, 7);
    change_manifest([](auto& picture) { picture["name"] = std::string("mine\0.png", 9); });
    expect_refused("is no name of a picture");
    EXPECT_EQ(draw_new().exit_code, 2);
    EXPECT_TRUE(fs::exists(fresh("mine")));
    EXPECT_TRUE(fs::exists(fresh("mine.png")));
}

TEST_F(GoldenReview, TakesAPictureOfTwoFoldersIfItIsTheSame) {
    change_scene();
    EXPECT_EQ(draw_new().exit_code, 7);
    const std::string second = folder_.file("second");
    fs::copy(fresh(), second);
    EXPECT_THAT(run({"--accept", fresh(), "--accept", second, "--dry-run"}).out, HasSubstr("3 pictures: "));
    change_scene("drag = 0.5\n");
    fs::remove_all(second);
    EXPECT_EQ(run({"--new", second}).exit_code, 7);
    expect_refused("second/swing_t0000_500000.png: another folder has another picture of this name",
                   {"--accept", second});
}

#ifndef CORDA_SANITIZE  // whose run time must be loaded first
TEST_F(GoldenReview, CompletesWhatAKillCutOff) {
    change_scene();
    EXPECT_EQ(draw_new().exit_code, 7);
    const auto before = references();
    const std::string second = reference(kMiddle) + ".*.tmp";
    const auto killed =
        test::run_shell("LD_PRELOAD=" FOREIGN_FAULTS " FSYNC_BLOCKS_AFTER='" + second +
                        "' FSYNC_BLOCKS_UNTIL=/never " + test::quoted(CORDA_PROGRAM) + " golden " +
                        folder_.file("scenes") + " --dir " + folder_.file("ref") + " --accept " + fresh() +
                        " & pid=$!; " + test::wait_until("ls " + second) + "kill -9 $pid; wait $pid");
    EXPECT_EQ(killed.exit_code, 137);
    const auto cut = references();
    EXPECT_EQ(cut[0], read_file(fresh(kStart)));
    EXPECT_EQ(cut[1], before[1]);
    EXPECT_EQ(cut[2], before[2]);
    const auto again = run({"--accept", fresh()});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.out,
                HasSubstr("3 pictures: 1 passed, 0 failed, 0 missing, 0 stale, 2 written or removed"));
    EXPECT_EQ(run().exit_code, 0);
}
#endif

TEST_F(GoldenReview, DrawsThePicturesThatAreNamed) {
    change_scene();
    for (const char* const name : {"swing[1]*.toml", "swing1.toml"})  // characters of patterns
        test::write_file(folder_.file("scenes/" + std::string(name)), kGoldenScene);
    const std::pair<std::vector<std::string>, const char*> cases[] = {
        {{kMiddle}, "1 picture: 0 passed, 1 failed"},
        {{"swing_t0001_000000", kStart}, "2 pictures: 0 passed, 2 failed"},
        {{"swing"}, "3 pictures: 0 passed, 3 failed"},
        {{"swing[1]*"}, "3 pictures: 0 passed, 0 failed, 3 missing"},
        {{"swing[1]*_t0000_500000.png"}, "1 picture: "},
        {{"swing[12]*"}, "3 pictures: "},
    };
    for (const auto& [names, totals] : cases) {
        std::vector<std::string> options{"--only"};
        options.insert(options.end(), names.begin(), names.end());
        EXPECT_THAT(run(options).out, HasSubstr(totals));
    }
    const auto unknown = run({"--only", "swng"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_THAT(unknown.err,
                HasSubstr("--only swng: no picture and no scene has this name; did you mean swing?"));
    const auto before = references();
    EXPECT_EQ(run({"--update", "--only", kMiddle}).exit_code, 0);
    EXPECT_EQ(references()[0], before[0]);
    EXPECT_NE(references()[1], before[1]);
    EXPECT_THAT(run().out, HasSubstr("9 pictures: 1 passed, 2 failed, 6 missing"));
}

TEST_F(GoldenReview, ShardsCoverEachPictureOnce) {
    for (const char* const name : {"a", "b"})
        test::write_file(folder_.file("scenes/" + std::string(name) + ".toml"), kGoldenScene);
    for (const char* const name : {"x_t0000_000000.png", "y_t0000_000000.png"})
        fs::copy(reference(kMiddle), reference(name));
    change_provenance("x_t0000_000000.png", [](Image&, auto& json) { json["name"] = "x"; });
    const auto count = [](const test::CommandResult& result, const char* key) {
        return nlohmann::json::parse(result.out)[key].get<int>();
    };
    const auto all = run({"--json"});
    for (const char* const key : {"passed", "missing", "stale"}) {
        int sum = 0;
        for (const char* const shard : {"0/4", "1/4", "2/4", "3/4"})
            sum += count(run({"--json", "--shard", shard}), key);
        EXPECT_EQ(sum, count(all, key)) << key;
        EXPECT_GT(sum, 0) << key;
    }
    EXPECT_EQ(run({"--shard", "4/4"}).exit_code, 2);
    EXPECT_THAT(run({"--stale"}).out, HasSubstr("2 pictures: 0 passed, 0 failed, 0 missing, 2 stale"));
}

TEST_F(GoldenReview, ComparesWhatTheMaskShows) {
    change_reference(kMiddle, [](Image& image, PngInfo&) { image.pixel(5, 5)[0] ^= 1U; });
    Image mask(320, 180);
    for (std::size_t i = 0; i < mask.size_bytes(); ++i) mask.data()[i] = 255;
    const auto with_mask = [&] {
        write_png(folder_.file("scenes/mask.png"), mask, {}, {.force = true});
        return run({"--set", "golden.mask=\"mask.png\""});
    };
    EXPECT_EQ(with_mask().exit_code, 7);
    for (int c = 0; c < 3; ++c) mask.pixel(5, 5)[c] = 0;
    EXPECT_EQ(with_mask().exit_code, 0);
    EXPECT_EQ(run().exit_code, 7);
    mask = Image(16, 9);
    const auto wrong = with_mask();
    EXPECT_EQ(wrong.exit_code, 3);
    EXPECT_THAT(wrong.err, AllOf(HasSubstr("golden.mask"), HasSubstr("mask.png"), HasSubstr("16x9")));
    fs::remove(folder_.file("scenes/mask.png"));
    EXPECT_THAT(run({"--set", "golden.mask=\"mask.png\""}).err, HasSubstr("golden.mask"));
}

TEST_F(GoldenReview, ReportsFailuresToPullRequests) {
    change_scene();
    fs::remove(reference(kEnd));
    EXPECT_EQ(run({"--markdown", folder_.file("a.md"), "--junit", folder_.file("a.xml")}).exit_code, 7);
    EXPECT_THAT(
        read_file(folder_.file("a.md")),
        AllOf(
            HasSubstr("3 pictures: 0 passed, 2 failed, 1 missing, 0 stale\n"),
            HasSubstr("**rope\\[0\\].hang.angle\\_deg is 46 and was 45, world.gravity is 5 and was 9.81**\n"),
            HasSubstr("| swing\\_t0000\\_500000.png | different | max "),
            HasSubstr("**there is no reference**\n"), HasSubstr("| swing\\_t0001\\_000000.png | missing |")));
    EXPECT_EQ(test::run_shell("xmllint --noout " + test::quoted(folder_.file("a.xml"))).exit_code, 0);
    EXPECT_THAT(read_file(folder_.file("a.xml")),
                AllOf(HasSubstr("<testsuites tests=\"3\" failures=\"3\" errors=\"0\" time=\""),
                      HasSubstr("<property name=\"mean\" value=\""), HasSubstr("<failure type=\"missing\""),
                      HasSubstr("<failure type=\"different\" message=\"max "),
                      Not(HasSubstr("time=\"0.000\">\n    <testcase"))));
}

TEST_F(GoldenReview, RefusesOptionsThatContradict) {
    for (const auto& options : std::vector<std::vector<std::string>>{{"--new", fresh(), "--update"},
                                                                     {"--accept", fresh(), "--update"},
                                                                     {"--accept", fresh(), "--force"}})
        EXPECT_EQ(run(options).exit_code, 2);
    const auto same = run({"--new", folder_.file("ref/.")});
    EXPECT_EQ(same.exit_code, 2);
    EXPECT_THAT(same.err, HasSubstr("name another folder"));
}

}  // namespace
}  // namespace corda
