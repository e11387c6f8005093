#include "corda/core/machine.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "support/command.hpp"

namespace corda {
namespace {

/// A fake system whose files in /proc and /sys the test writes.
class Machine : public testing::Test {
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

TEST_F(Machine, HasTheFreeMemoryOfLinux) {
    EXPECT_EQ(available(), std::nullopt);
    write("proc/meminfo", "MemTotal:  9000 kB\nMemFree: 100 kB\nMemAvailable:    2000 kB\nBuffers: 5 kB\n");
    EXPECT_EQ(available(), 2000U * 1024U);
}

TEST_F(Machine, RespectsTheMemoryLimitsOfControlGroups) {
    write("proc/meminfo", "MemAvailable:    2000 kB\n");
    write("proc/self/cgroup", "9:name=systemd:/x\n0::/user.slice/inner\n");
    write("sys/fs/cgroup/user.slice/memory.max", "1000000\n");
    write("sys/fs/cgroup/user.slice/memory.current", "600000\n");
    write("sys/fs/cgroup/user.slice/memory.stat", "anon 500000\nfile 90000\ninactive_file 50000\n");
    write("sys/fs/cgroup/user.slice/inner/memory.max", "max\n");
    write("sys/fs/cgroup/user.slice/inner/memory.current", "600000\n");
    EXPECT_EQ(available(), 450'000U);               // the cache is reclaimable
    write("sys/fs/cgroup/memory.max", "300000\n");  // a container sees its own group as the root
    write("sys/fs/cgroup/memory.current", "400000\n");
    EXPECT_EQ(available(), 0U);
}

TEST_F(Machine, RespectsTheLimitOfTheAddressSpace) {
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

TEST_F(Machine, HasTheCoresOfTheAffinityMask) {
    cpu_set_t old;
    ASSERT_EQ(::sched_getaffinity(0, sizeof old, &old), 0);
    EXPECT_EQ(usable_cores(root()), CPU_COUNT(&old));
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int core = 0; CPU_COUNT(&one) == 0; ++core)
        if (CPU_ISSET(core, &old)) CPU_SET(core, &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(usable_cores(root()), 1);
    ASSERT_EQ(::sched_setaffinity(0, sizeof old, &old), 0);
}

TEST_F(Machine, RespectsTheCpuLimitsOfControlGroups) {
    const int all = usable_cores(root());
    if (all < 2) GTEST_SKIP() << "one core has no part that could be told";
    write("proc/self/cgroup", "0::/user.slice/inner\n");
    write("sys/fs/cgroup/user.slice/cpu.max", "max 100000\n");
    EXPECT_EQ(usable_cores(root()), all);
    write("sys/fs/cgroup/user.slice/inner/cpu.max", "100001 100000\n");  // a little more than one core
    EXPECT_EQ(usable_cores(root()), std::min(all, 2));
    write("sys/fs/cgroup/user.slice/cpu.max", "50000 100000\n");
    EXPECT_EQ(usable_cores(root()), 1);
    write("sys/fs/cgroup/user.slice/cpu.max", "-5 0\n");
    write("sys/fs/cgroup/user.slice/inner/cpu.max", "9000000000000000000 1\n");
    EXPECT_EQ(usable_cores(root()), all);
    write("sys/fs/cgroup/cpu.max", "1000 1000\n");  // a container sees its own group as the root
    EXPECT_EQ(usable_cores(root()), 1);
}

TEST_F(Machine, ReportsItsMemory) {
    const auto here = available_memory_bytes();
    ASSERT_TRUE(here);
    EXPECT_GT(*here, std::uint64_t{1} << 20U);
}

}  // namespace
}  // namespace corda
