#include "corda/core/memory.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>

#include "support/command.hpp"

namespace corda {
namespace {

/// A system whose files are written by hand.
class Memory : public testing::Test {
  protected:
    void write(const std::string& name, const std::string& text) const {
        const std::filesystem::path file = root() / name;
        std::filesystem::create_directories(file.parent_path());
        test::write_file(file.string(), text);
    }
    [[nodiscard]] std::filesystem::path root() const { return folder_.path(); }
    [[nodiscard]] std::optional<std::uint64_t> available() const { return available_memory_bytes(root()); }

  private:
    test::ScratchFolder folder_;
};

TEST_F(Memory, IsWhatLinuxTells) {
    EXPECT_EQ(available(), std::nullopt);
    write("proc/meminfo", "MemTotal:  9000 kB\nMemFree: 100 kB\nMemAvailable:    2000 kB\nBuffers: 5 kB\n");
    EXPECT_EQ(available(), 2000U * 1024U);
}

TEST_F(Memory, IsWhatTheGroupsLeave) {
    write("proc/meminfo", "MemAvailable:    2000 kB\n");
    write("proc/self/cgroup", "9:name=systemd:/x\n0::/user.slice/inner\n");
    write("sys/fs/cgroup/user.slice/memory.max", "1000000\n");
    write("sys/fs/cgroup/user.slice/memory.current", "600000\n");
    write("sys/fs/cgroup/user.slice/memory.stat", "anon 500000\nfile 90000\ninactive_file 50000\n");
    write("sys/fs/cgroup/user.slice/inner/memory.max", "max\n");
    write("sys/fs/cgroup/user.slice/inner/memory.current", "600000\n");
    EXPECT_EQ(available(), 450'000U);               // the cache gives way
    write("sys/fs/cgroup/memory.max", "300000\n");  // a container sees its own group as the root
    write("sys/fs/cgroup/memory.current", "400000\n");
    EXPECT_EQ(available(), 0U);
}

TEST_F(Memory, IsWhatTheLimitOfTheAddressSpaceLeaves) {
    write("proc/self/status", "VmPeak:  5000 kB\nVmSize:  1000000 kB\n");
    rlimit old{};
    ASSERT_EQ(::getrlimit(RLIMIT_AS, &old), 0);
    rlimit limit = old;
    limit.rlim_cur = std::uint64_t{1} << 46U;  // more than this process has, also under a sanitizer
    ASSERT_EQ(old.rlim_cur, RLIM_INFINITY) << "this test needs an unlimited address space";
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &limit), 0);
    EXPECT_EQ(available(), limit.rlim_cur - 1'024'000'000U);
    ASSERT_EQ(::setrlimit(RLIMIT_AS, &old), 0);
    EXPECT_EQ(available(), std::nullopt);
}

TEST_F(Memory, IsToldByThisMachine) {
    const auto here = available_memory_bytes();
    ASSERT_TRUE(here);
    EXPECT_GT(*here, std::uint64_t{1} << 20U);
}

}  // namespace
}  // namespace corda
