// The comparison behind MatchesGolden, and the matcher itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "corda/film/provenance.hpp"
#include "corda/media/defs.hpp"
#include "corda/testing.hpp"
#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda {
namespace {

using corda::testing::check_golden;
using corda::testing::MatchesGolden;
using ::testing::HasSubstr;
using ::testing::Not;

Image with_dot(std::uint8_t level) {
    Image image(8, 6);
    for (std::size_t i = 3; i < image.size_bytes(); i += 4) image.data()[i] = 255;
    image.pixel(3, 2)[1] = level;
    return image;
}

class CheckGolden : public ::testing::Test {
  protected:
    CheckGolden() {
        clear();
        std::filesystem::create_directory(folder_.file("ref"));
        write_png(folder_.file("ref/dot.png"), with_dot(200));
        setenv("CORDA_GOLDEN_DIR", folder_.file("ref").c_str(), 1);
    }
    ~CheckGolden() override { clear(); }
    CheckGolden(const CheckGolden&) = delete;
    CheckGolden& operator=(const CheckGolden&) = delete;

    static void clear() {
        for (const char* const name : {"CORDA_GOLDEN_DIR", "CORDA_UPDATE_GOLDENS", "CORDA_GOLDEN_ARTIFACTS"})
            unsetenv(name);
    }

    test::ScratchFolder folder_;
};

TEST_F(CheckGolden, MatchesEqualPicturesAndThoseWithinLimits) {
    EXPECT_THAT(with_dot(200), MatchesGolden("dot.png"));
    EXPECT_THAT(with_dot(201), Not(MatchesGolden("dot.png")));
    EXPECT_THAT(with_dot(201), MatchesGolden("dot.png", {.limits = {.max = 1.0, .mean = {}, .share = {}}}));
    EXPECT_THAT(check_golden(with_dot(203), "dot.png").message, HasSubstr("max 3, "));
    EXPECT_THAT(check_golden(Image(8, 6), "dot.png").message, HasSubstr("one colour alone"));
}

TEST_F(CheckGolden, MatchesAnyVariant) {
    write_png(folder_.file("ref/dot.older.png"), with_dot(90));
    EXPECT_THAT(with_dot(90), MatchesGolden("dot.png"));
    EXPECT_THAT(with_dot(200), MatchesGolden("dot.png"));
    EXPECT_THAT(check_golden(with_dot(91), "dot.png").message, HasSubstr("ref/dot.png': max 109"));
}

TEST_F(CheckGolden, NamesTheMissingPictureAndTheNewOne) {
    EXPECT_THAT(check_golden(with_dot(1), "no/such.png").message,
                AllOf(HasSubstr("there is no golden picture"),
                      HasSubstr("accept it: CORDA_UPDATE_GOLDENS=1 with the same test"),
                      HasSubstr("set CORDA_GOLDEN_ARTIFACTS")));
    setenv("CORDA_GOLDEN_ARTIFACTS", folder_.file("out").c_str(), 1);
    EXPECT_THAT(check_golden(with_dot(1), "no/such.png").message, HasSubstr("out/no/such.new.png"));
    EXPECT_EQ(read_png(folder_.file("out/no/such.new.png")), with_dot(1));
    EXPECT_THAT(with_dot(199), Not(MatchesGolden("dot.png")));
    EXPECT_EQ(read_png(folder_.file("out/dot.new.png")), with_dot(199));
    EXPECT_EQ(read_png(folder_.file("out/dot.difference.png")),
              difference_image(with_dot(200), with_dot(199)));
}

TEST_F(CheckGolden, RefusesArtifactsAmongGoldenPictures) {
    setenv("CORDA_GOLDEN_ARTIFACTS", folder_.file("ref/../ref").c_str(), 1);
    for (int run = 0; run < 2; ++run)  // an artifact of the first run would be a variant for the second
        EXPECT_EQ(test::code_of([] { (void)check_golden(with_dot(7), "dot.png"); }), ExitCode::kUsage);
    setenv("CORDA_GOLDEN_ARTIFACTS", folder_.file("out").c_str(), 1);
    const std::string name =
        folder_.file("ref/dot.png");  // an absolute path; nothing may be written next to it
    EXPECT_FALSE(check_golden(with_dot(7), name).matches);
    EXPECT_EQ(read_png(folder_.file("out" + folder_.file("ref/dot.new.png"))), with_dot(7));
    EXPECT_FALSE(check_golden(with_dot(7), name).matches);
}

TEST_F(CheckGolden, UpdatesItsOwnPictures) {
    setenv("CORDA_UPDATE_GOLDENS", "0", 1);
    EXPECT_FALSE(check_golden(with_dot(7), "dot.png").matches);
    setenv("CORDA_UPDATE_GOLDENS", "1", 1);
    EXPECT_FALSE(check_golden(with_dot(200), "dot.png").written);
    EXPECT_FALSE(check_golden(Image(8, 6), "dot.png").matches);
    EXPECT_TRUE(check_golden(with_dot(7), "dot.png").written);
    EXPECT_TRUE(check_golden(with_dot(7), "new/dot.png").written);
    EXPECT_EQ(read_png(folder_.file("ref/dot.png")), with_dot(7));
    EXPECT_EQ(read_png(folder_.file("ref/new/dot.png")), with_dot(7));
}

TEST_F(CheckGolden, NamesTheCauseAndTheCommands) {
    const std::string scene = "schema = 1\n[[rope]]\nhang = { links = 1, length = 1.0 }\n";
    const Film before(parse_scene(scene, "swing.toml"));
    const Film now(parse_scene(scene + "[world]\ndrag = 0.2\n", "swing.toml"));
    setenv("CORDA_UPDATE_GOLDENS", "1", 1);
    EXPECT_TRUE(check_golden(with_dot(7), "dot.png", {.film = &before}).written);
    clear();
    const auto message_of = [&](const corda::testing::GoldenOptions& options) {
        return check_golden(with_dot(8), folder_.file("ref/dot.png"), options).message;
    };
    EXPECT_THAT(message_of({.film = &now, .rerun = "a --test"}),
                AllOf(HasSubstr("; world.drag is 0.2 and was "), HasSubstr("; repeat the test: a --test; "),
                      HasSubstr("accept it: CORDA_UPDATE_GOLDENS=1 a --test")));
    EXPECT_THAT(message_of({.film = &before}), HasSubstr("its scene and its version of corda are the same"));
    EXPECT_THAT(corda::testing::rerun_command(),
                ::testing::EndsWith(" --gtest_filter=CheckGolden.NamesTheCauseAndTheCommands"));
    PngInfo older;
    older.text = {{"Software", "corda 0.0.1"}};
    write_png(folder_.file("ref/dot.png"), with_dot(7), older, {.force = true});
    EXPECT_THAT(message_of({}), HasSubstr("; corda 0.0.1 drew it, and this is corda 0.1.0"));
    older.text = {
        {kProvenanceKeyword,
         provenance_text({.corda = "0.1.0", .name = "dot", .golden = GoldenRecord{.renderer = "llvmpipe"}})}};
    write_png(folder_.file("ref/dot.png"), with_dot(7), older, {.force = true});
    EXPECT_THAT(message_of({}), HasSubstr("ref --only dot --update"));
}

TEST_F(CheckGolden, LeavesPicturesOfTheCommandAlone) {
    PngInfo info;
    const Provenance made{.corda = "0.1.0", .name = "dot", .golden = GoldenRecord{.renderer = "llvmpipe"}};
    info.text = {{kProvenanceKeyword, provenance_text(made)}};
    write_png(folder_.file("ref/dot.png"), with_dot(200), info, {.force = true});
    setenv("CORDA_UPDATE_GOLDENS", "1", 1);
    const auto outcome = check_golden(with_dot(7), "dot.png");
    EXPECT_FALSE(outcome.matches);
    EXPECT_THAT(outcome.message, HasSubstr("corda golden --update"));
    EXPECT_EQ(read_png(folder_.file("ref/dot.png")), with_dot(200));
}

TEST_F(CheckGolden, RefusesOtherExtensions) {
    EXPECT_EQ(test::code_of([] { (void)check_golden(with_dot(7), "dot.jpg"); }), ExitCode::kUsage);
}

TEST_F(CheckGolden, ADamagedPictureDoesNotMatchAndIsUpdated) {
    test::write_file(folder_.file("ref/dot.png"), "no picture");
    const auto damaged = check_golden(with_dot(7), "dot.png");
    EXPECT_FALSE(damaged.matches);
    EXPECT_THAT(damaged.message, HasSubstr("cannot read PNG"));
    write_png(folder_.file("ref/dot.older.png"), with_dot(7));
    EXPECT_TRUE(check_golden(with_dot(7), "dot.png").matches);  // the variant matches
    std::filesystem::remove(folder_.file("ref/dot.older.png"));
    setenv("CORDA_UPDATE_GOLDENS", "1", 1);
    const auto kept = check_golden(with_dot(7), "dot.png");
    EXPECT_FALSE(kept.written);
    EXPECT_THAT(kept.message, HasSubstr("is no PNG and stays"));
    test::write_file(folder_.file("ref/dot.png"), "\x89PNG\r\n\x1a\n half");
    EXPECT_TRUE(check_golden(with_dot(7), "dot.png").written);
    EXPECT_EQ(read_png(folder_.file("ref/dot.png")), with_dot(7));
}

}  // namespace
}  // namespace corda
