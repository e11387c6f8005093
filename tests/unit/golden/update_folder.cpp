// Updates of golden pictures are all or nothing, whether killed at any moment or stopped by a picture that
// cannot be replaced.
#include "corda/golden/update_folder.hpp"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "support/command.hpp"
#include "support/failure.hpp"

namespace corda::golden {
namespace {

namespace fs = std::filesystem;
using test::failure_of;
using ::testing::HasSubstr;

/// The last entry of a journal.
const std::string kEnd("end\0", 4);

class UpdateFolderTest : public ::testing::Test {
  protected:
    static constexpr int kCount = 200;

    [[nodiscard]] static std::string name(int i) { return "a" + std::to_string(i) + ".png"; }

    UpdateFolderTest() {
        for (int i = 0; i < kCount; ++i) names_.push_back(name(i));
    }

    /// Old pictures: those to replace, and one to remove.
    void make_old() const {
        fs::remove_all(pictures());
        fs::create_directory(pictures());
        for (int i = 1; i < kCount; ++i) test::write_file(pictures() + "/" + name(i), "old");
        test::write_file(pictures() + "/stale.png", "old");
    }

    void update() const {
        UpdateFolder folder = UpdateFolder::create(pictures());
        for (const std::string& picture : names_) test::write_file(folder.staged(picture), "new");
        folder.publish(names_, {"stale.png"});
        folder.remove();
    }

    /// "old" or "new" if all pictures are, otherwise "mixed".
    [[nodiscard]] std::string state() const {
        std::set<std::string> found;
        for (int i = 1; i < kCount; ++i) found.insert(test::read_file(pictures() + "/" + name(i)));
        found.insert(fs::exists(pictures() + "/stale.png") ? "old" : "new");
        found.insert(fs::exists(pictures() + "/" + name(0)) ? "new" : "old");
        return found.size() == 1 ? *found.begin() : "mixed";
    }

    [[nodiscard]] std::string inside() const { return pictures() + "/.corda-golden-update"; }
    [[nodiscard]] std::string pictures() const { return folder_.file("ref"); }

    test::ScratchFolder folder_;
    std::vector<std::string> names_;
};

TEST_F(UpdateFolderTest, PublishesAllFilesAndLeavesNoOthers) {
    make_old();
    update();
    EXPECT_EQ(state(), "new");
    EXPECT_FALSE(fs::exists(inside()));
    EXPECT_EQ(settle_update(pictures(), false), "");
}

TEST_F(UpdateFolderTest, IsAllOrNothingAfterAKillAtAnyMoment) {
    const int kills = std::getenv("CORDA_TEST_LONG") != nullptr ? 300 : 8;
    std::mt19937 random(20261125);  // NOLINT(cert-msc51-cpp): the same kills on every run
    std::uniform_int_distribution<useconds_t> moment_us(0, 3000);  // most kills happen during the renames
    [[maybe_unused]] int mixed = 0;
    for (int i = 0; i < kills || (mixed == 0 && i < 100); ++i) {
        make_old();
        const pid_t child = fork();
        if (child == 0) {
            update();
            _exit(0);
        }
        while (!fs::exists(inside() + "/journal") && waitpid(child, nullptr, WNOHANG) == 0) usleep(50);
        usleep(moment_us(random));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        const std::string before = state();
        mixed += before == "mixed" ? 1 : 0;
        const std::string told = settle_update(pictures(), false);
        EXPECT_EQ(state(), "new") << before << " " << told;
        if (before != "new") {
            EXPECT_THAT(told, HasSubstr("completed an interrupted update"));
        }
    }
#ifndef CORDA_SANITIZE    // updates take longer there
    EXPECT_GT(mixed, 0);  // kills during the replacement of pictures
#endif
}

TEST_F(UpdateFolderTest, RevertsEverythingIfOnePictureCannotBeReplaced) {
    make_old();
    fs::remove(pictures() + "/" + name(150));
    fs::create_directory(pictures() + "/" + name(150));
    const auto failure = failure_of([&] { update(); });
    EXPECT_EQ(failure.code, ExitCode::kIo);
    EXPECT_THAT(failure.message,
                ::testing::AllOf(HasSubstr("a150.png"), HasSubstr("no picture was changed")));
    fs::remove(pictures() + "/" + name(150));
    test::write_file(pictures() + "/" + name(150), "old");
    EXPECT_EQ(state(), "old");
    update();
    EXPECT_EQ(state(), "new");
}

TEST_F(UpdateFolderTest, ContinuesAnInterruptedRevert) {
    make_old();
    static_cast<void>(UpdateFolder::create(pictures()));
    // The first picture is reverted; the second and the added one are not.
    test::write_file(inside() + "/undo",
                     "w" + name(1) + '\0' + "w" + name(2) + '\0' + "a" + name(0) + '\0' + kEnd);
    fs::rename(pictures() + "/" + name(2), inside() + "/old/" + name(2));
    test::write_file(pictures() + "/" + name(2), "new");
    test::write_file(pictures() + "/" + name(0), "new");
    EXPECT_THAT(settle_update(pictures(), false), HasSubstr("took back a failed update"));
    EXPECT_EQ(state(), "old");
    EXPECT_FALSE(fs::exists(inside()));
}

TEST_F(UpdateFolderTest, DoesNotCompleteAnUpdateThatTheUserReverted) {
    make_old();
    static_cast<void>(UpdateFolder::create(pictures()));
    // The first picture was replaced before the kill, and the user has restored it since.
    test::write_file(inside() + "/journal", "w" + name(1) + '\0' + "w" + name(2) + '\0' + kEnd);
    test::write_file(inside() + "/old/" + name(1), "old");
    test::write_file(inside() + "/new/" + name(2), "new");
    EXPECT_THAT(settle_update(pictures(), false), HasSubstr("some of whose pictures were restored since"));
    EXPECT_EQ(state(), "old");
}

TEST_F(UpdateFolderTest, RevertsAKilledUpdateThatCannotBeCompleted) {
    make_old();
    static_cast<void>(UpdateFolder::create(pictures()));  // not removed, as by a kill
    std::string journal;
    for (const std::string& one : names_) {
        test::write_file(inside() + "/new/" + one, "new");
        journal += (one == name(0) ? "a" : "w") + one + '\0';
    }
    test::write_file(inside() + "/journal", journal + kEnd);
    fs::remove(pictures() + "/" + name(150));
    fs::create_directory(pictures() + "/" + name(150));
    EXPECT_EQ(failure_of([&] { static_cast<void>(settle_update(pictures(), true)); }).code, ExitCode::kIo);
    EXPECT_THAT(settle_update(pictures(), false), HasSubstr("took back an interrupted update"));
    EXPECT_TRUE(fs::is_directory(pictures() + "/" + name(150)));
    EXPECT_EQ(test::read_file(pictures() + "/" + name(149)), "old");
    EXPECT_FALSE(fs::exists(pictures() + "/" + name(0)));
    EXPECT_FALSE(fs::exists(inside()));
}

TEST_F(UpdateFolderTest, LeavesFoldersThatItDidNotMake) {
    make_old();
    for (const char* const own : {"/.update", "/.corda-golden-update"}) {
        fs::create_directory(pictures() + own);
        test::write_file(pictures() + own + "/mine", "mine");
    }
    EXPECT_THAT(failure_of([&] { update(); }).message, HasSubstr("was not made by corda"));
    EXPECT_EQ(test::read_file(inside() + "/mine"), "mine");
    fs::remove_all(inside());
    update();
    EXPECT_EQ(test::read_file(pictures() + "/.update/mine"), "mine");
}

TEST_F(UpdateFolderTest, IgnoresJournalEntriesOutsideItsFolder) {
    make_old();
    static_cast<void>(UpdateFolder::create(pictures()));
    const std::string outside = folder_.write("outside.png", "outside");
    test::write_file(inside() + "/new/x", "new");
    test::write_file(inside() + "/journal", std::string("w../outside.png") + '\0' + kEnd);
    EXPECT_THAT(failure_of([&] { static_cast<void>(settle_update(pictures(), false)); }).message,
                HasSubstr("is damaged"));
    EXPECT_EQ(test::read_file(outside), "outside");
}

TEST_F(UpdateFolderTest, IgnoresATruncatedJournal) {
    make_old();
    static_cast<void>(UpdateFolder::create(pictures()));
    for (const std::string& text :
         {std::string(), "w" + name(1) + '\0', "w" + name(1) + '\0' + "w" + name(2)}) {
        test::write_file(inside() + "/new/" + name(1), "new");
        test::write_file(inside() + "/journal", text);
        EXPECT_THAT(failure_of([&] { static_cast<void>(settle_update(pictures(), false)); }).message,
                    HasSubstr("is damaged; restore the pictures"));
        EXPECT_EQ(state(), "old");
    }
}

}  // namespace
}  // namespace corda::golden
