// `corda golden`: suites that pass, fail for each cause, miss pictures and go stale.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/command.hpp"

namespace corda {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kGoldenScene = R"(schema = 1
[world]
duration = 2
[[rope]]
hang = { links = 10, length = 1.0, angle_deg = 45.0 }
[golden]
at = [0.0, 0.5, 1.0]
)";

/// A suite of one scene whose pictures are kept.
class GoldenSuite : public testing::Test {
  protected:
    GoldenSuite() {
        std::filesystem::create_directory(folder_.file("scenes"));
        test::write_file(folder_.file("scenes/swing.toml"), kGoldenScene);
        EXPECT_EQ(run({"--update"}).exit_code, 0);
    }

    [[nodiscard]] test::CommandResult run(std::vector<std::string> options = {}) const {
        std::vector<std::string> arguments{"golden", folder_.file("scenes"), "--dir", folder_.file("ref")};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return test::run_corda(arguments);
    }

    [[nodiscard]] std::string reference(const std::string& name) const { return folder_.file("ref/" + name); }

    test::ScratchFolder folder_;
};

TEST_F(GoldenSuite, PassesWithWhatItHasKept) {
    const auto result = run({"--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("\"passed\": 3"), HasSubstr("\"failed\": 0"),
                                  HasSubstr("\"missing\": 0"), HasSubstr("\"stale\": 0")));
}

TEST_F(GoldenSuite, PassesIfOnlyTheDurationGrows) {
    EXPECT_EQ(run({"--set", "world.duration=5"}).exit_code, 0);
}

TEST_F(GoldenSuite, TellsOtherPositionsFromAnotherCamera) {
    const auto drag = run({"--set", "world.drag=0.001"});
    EXPECT_EQ(drag.exit_code, 7);
    EXPECT_THAT(drag.out, AllOf(HasSubstr("1 picture passed"), HasSubstr("positions differ by 0.000"),
                                HasSubstr("from t = 0.5 s on")));
    const auto camera = run({"--set", "camera.height=5"});
    EXPECT_EQ(camera.exit_code, 7);
    EXPECT_THAT(camera.out, HasSubstr("same positions, other camera"));
    const auto style = run({"--set", "style.rope_width_px=9"});
    EXPECT_EQ(style.exit_code, 7);
    EXPECT_THAT(style.out, HasSubstr("same positions, camera and version, but pixels differ"));
}

TEST_F(GoldenSuite, FailsForAnEmptyPictureEvenInAnUpdate) {
    for (const char* const option : {"--json", "--update"}) {
        const auto result = run({option, "--set", "camera.center=[100,100]"});
        EXPECT_EQ(result.exit_code, 7);
        EXPECT_THAT(result.out, HasSubstr("empty"));
    }
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(GoldenSuite, AddsMissingPicturesAndRemovesStaleOnes) {
    std::filesystem::rename(reference("swing_t0001_000000.png"), reference("swing_t0003_000000.png"));
    const auto result = run({"--junit", folder_.file("junit.xml")});
    EXPECT_EQ(result.exit_code, 7);
    EXPECT_THAT(result.out, AllOf(HasSubstr("swing_t0001_000000.png: missing"),
                                  HasSubstr("swing_t0003_000000.png: stale")));
    EXPECT_THAT(test::read_file(folder_.file("junit.xml")),
                AllOf(HasSubstr("<testsuite name=\"swing\" tests=\"3\" failures=\"1\">"),
                      HasSubstr("<testsuite name=\"stale\" tests=\"1\" failures=\"1\">")));
    EXPECT_THAT(run({"--update", "--dry-run"}).out, HasSubstr("would be removed"));
    EXPECT_TRUE(std::filesystem::exists(reference("swing_t0003_000000.png")));
    EXPECT_EQ(run({"--update"}).exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(reference("swing_t0003_000000.png")));
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(GoldenSuite, AcceptsAVariantNamedByItsCause) {
    std::filesystem::rename(reference("swing_t0001_000000.png"), reference("swing_t0001_000000.old.png"));
    EXPECT_EQ(run().exit_code, 0);
}

TEST_F(GoldenSuite, RefusesWhatIsNoSuite) {
    const std::string plain =
        folder_.write("plain.toml", "schema = 1\n[[rope]]\nhang = { links = 2, length = 1 }\n");
    const auto result = test::run_corda({"golden", plain, "--dir", folder_.file("ref")});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("has no table [golden]"));
    EXPECT_EQ(run({"--dry-run"}).exit_code, 2);
    const auto late = run({"--set", "golden.at=[9]"});
    EXPECT_EQ(late.exit_code, 3);
    EXPECT_THAT(late.err, HasSubstr("after the end of the motion"));
}

}  // namespace
}  // namespace corda
