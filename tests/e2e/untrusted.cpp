// Files of unknown origin: whatever they contain, the program ends with a defined exit code.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::HasSubstr;

class Untrusted : public testing::Test {
  protected:
    test::ScratchFolder folder_;
};

TEST_F(Untrusted, StoredSceneMayNotRequestMuchMemory) {
    const std::string scene = folder_.write("scene.toml",
                                            "schema = 1\nworld = { duration = 0.1 }\n[[rope]]\n"
                                            "hang = { links = 6, length = 1.0, angle_deg = 30.0 }\n"
                                            "[video]\nsize = [1024, 1024]\nfps = 10\n");
    const std::string video = folder_.file("a.mp4");
    ASSERT_EQ(run_corda({"render", scene, "-o", video}).exit_code, 0);
    std::string bytes = test::read_file(video);
    const std::size_t at = bytes.find("[1024, 1024]");
    ASSERT_NE(at, std::string::npos);
    test::write_file(video, bytes.replace(at, 12, "[8024, 8024]"));
    const std::string picture = folder_.file("a.png");
    const auto refused = run_corda({"still", "--from", video, "--at", "0", "-o", picture});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_THAT(refused.err, HasSubstr("8024x8024 pixels, which take some 0.8 GB to draw"));
    EXPECT_THAT(refused.err, HasSubstr("--size 8024x8024"));
    EXPECT_EQ(run_corda({"still", "--from", video, "--at", "0", "-o", picture, "--size", "64x64"}).exit_code,
              0);
    EXPECT_EQ(run_corda({"still", "--from", video, "--at", "0", "-o", folder_.file("b.png"), "--size",
                         "8024x8024", "--dry-run"})
                  .exit_code,
              0);
}

}  // namespace
}  // namespace corda
