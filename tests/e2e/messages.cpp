// What commands say of their options and of what they read.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "support/command.hpp"

namespace corda {
namespace {

using test::run_corda;
using testing::HasSubstr;
using testing::Not;

class Messages : public testing::Test {
  protected:
    test::ScratchFolder folder_;
    std::string scene_ = folder_.write("scene.toml", R"(schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 2, length = 1.0, angle_deg = 30.0 }
[video]
size = [64, 64]
fps = 20
)");
    std::string video_ = folder_.file("out.mp4");
};

TEST_F(Messages, WarnOfTextsThatNoFrameShows) {
    const auto told = [&](const std::string& from) {
        return run_corda({"plan", scene_, "--set", "overlay.texts=[{text='a'},{text='b',from=" + from + "}]"})
            .err;
    };
    EXPECT_THAT(told("1.0"),
                HasSubstr("scene.toml: overlay.texts[1].from: 1 s is not before the end of the film "
                          "at 1 s, so that no frame shows the text; give an earlier time, or a "
                          "longer world.duration"));
    EXPECT_THAT(told("0.9"), Not(HasSubstr("overlay.texts")));
}

TEST_F(Messages, WarnOncePerFilmOfPlotsWithoutRoom) {
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"still", scene_, "--at", "0,0.1", "-o", folder_.file("a")},
                                               {"render", scene_, "-o", folder_.file("a.mp4")}}) {
        std::vector<std::string> words = command;
        words.insert(words.end(), {"--set", "overlay.plots=['energy']"});
        const std::string told = run_corda(words).err;
        const std::string warning =
            "scene.toml: overlay.plots: \"energy\" has little room in 64x64 pixels and is left out";
        EXPECT_THAT(told, HasSubstr(warning));
        EXPECT_EQ(told.find(warning), told.rfind(warning));
    }
}

TEST_F(Messages, NameTheValuesOfAnOption) {
    for (const auto& [command, message] :
         {std::pair(std::vector<std::string>{"simulate", scene_, "--decimal", "komma"},
                    "--decimal: komma not in {point,comma}"),
          std::pair(std::vector<std::string>{"watch", scene_, "--port", "70000"},
                    "\"70000\" is not a number within 0 .. 65535"),
          std::pair(std::vector<std::string>{"sheet", scene_, "--frame", "0:6:2", "-o", "a.png"},
                    "--frame 0:6:2: is neither a frame number nor a range FIRST:END of them; a range has no "
                    "step: list frames such as 0,24,48")}) {
        const auto result = run_corda(command);
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.err, HasSubstr(message));
    }
}

TEST_F(Messages, PlanNamesCopiesAndLabelsEach) {
    const std::string scene = folder_.write("copies.toml", R"(schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 1, length = 1.0 }
label = "first"
copies = { count = 3, angle_deg = 1.0 }
[[rope]]
hang = { links = 1, length = 1.0 }
label = "last"
[[rope]]
points = [[0, 0], [1, 0]]
[[solver.bodies]]
ropes = [4]
method = "relaxation"
)");
    EXPECT_THAT(run_corda({"plan", scene}).out, HasSubstr("first, rope 1 to rope 2, last"));
}

TEST_F(Messages, SimulateWarnsOfColumnsOfNoFile) {
    for (const char* const option : {"--tension", "--decimal=comma"}) {
        const auto result = run_corda({"simulate", scene_, option});
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_THAT(result.err, HasSubstr("change the file of -o alone; add -o FILE")) << option;
        EXPECT_THAT(run_corda({"simulate", scene_, option, "-o", "-"}).err, Not(HasSubstr("add -o FILE")));
    }
    EXPECT_THAT(run_corda({"simulate", scene_}).err, Not(HasSubstr("add -o FILE")));
}

TEST_F(Messages, CallASweepFileOne) {
    const auto missing = run_corda({"sweep", folder_.file("none.toml"), "-o", folder_.file("out")});
    EXPECT_EQ(missing.exit_code, 6);
    EXPECT_THAT(missing.err, HasSubstr("none.toml: cannot read the sweep file: "));
}

}  // namespace
}  // namespace corda
