// Hundreds of broken sweep files, the same on every run: each gives a sweep or a corda::Error.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>

#include "corda/core/basics.hpp"
#include "corda/sweep/sweep_file.hpp"
#include "fuzz/text_mutator.hpp"
#include "support/command.hpp"

namespace corda::sweep {
namespace {

constexpr std::array<std::string_view, 2> kSweeps{
    R"(schema = 1
scene = "scene.toml"
samples = 100000
seed = 7
shard_samples = 256
[vary]
"rope[0].hang.angle_deg" = { uniform = [5.0, 90.0] }
"rope[0].hang.links" = { integer = [3, 30] }
"rope[0].mass" = { log_uniform = [0.01, 10.0] }
"rope[0].hang.from" = { normal = [[0.0, 1.0], [0.5, 1e-3]], min = [-1, 0], max = [1, 2.0] }
"world.gravity" = [1.62, [0.5, -9.81]]
[output]
pictures = "mp4"
labels = ["positions", "velocities", "mask"]
summary = ["period_s", "horizon_s"]
[split]
train = 0.8
validation = 0.1
test = 0.1
)",
    R"(schema = 1
scene = "scene.toml" # comment
grid = true
vary = { "solver.method" = ["exact", "rattle"], "rope[0].payload" = [0, 1.5], "style.halo" = [true, false] }
output = { pictures = "none", labels = [], summary = [] }
)"};

/// Some hundreds, or many more with CORDA_TEST_LONG.
TEST(SweepMutations, GiveASweepOrAnError) {
    const std::uint32_t runs = std::getenv("CORDA_TEST_LONG") != nullptr ? 50'000 : 1'000;
    const test::ScratchFolder folder;
    static_cast<void>(
        folder.write("scene.toml", "schema = 1\n[[rope]]\nhang = { links = 2, length = 1.0 }\n"));
    int sweeps = 0;
    int scenes = 0;
    for (std::uint32_t seed = 0; seed < runs; ++seed) {
        const std::string text = test::TextMutator(seed).broken(kSweeps);
        const std::string path = folder.write("sweep.toml", text);
        try {
            const SweepDef sweep = load_sweep(path);
            ++sweeps;
            ASSERT_TRUE(sweep.samples >= 1 && sweep.samples <= SweepDef::kMaxSamples) << text;
            static_cast<void>(identity_of(sweep));
            for (const std::int64_t sample : {std::int64_t{0}, sweep.samples - 1}) {
                static_cast<void>(split_of(sweep, sample));
                static_cast<void>(scene_of(sweep, parameters_of(sweep, sample)));
                ++scenes;
            }
        } catch (const Error& error) {
            // A mutated path of the scene leads nowhere, or to a folder.
            ASSERT_TRUE(error.code() == ExitCode::kInvalidScene || error.code() == ExitCode::kIo ||
                        error.code() == ExitCode::kUsage)
                << text;
            const std::string_view message = error.what();
            ASSERT_NE(message, "") << text;
            ASSERT_LE(std::count(message.begin(), message.end(), '\n'), 20) << text;
        } catch (const std::exception& error) {
            FAIL() << "seed " << seed << ": " << error.what() << "\n" << text;
        }
    }
    // Measured: 36 and 32 of 1000.
    EXPECT_GT(sweeps, static_cast<int>(runs) / 50);
    EXPECT_GT(scenes, static_cast<int>(runs) / 50);
}

}  // namespace
}  // namespace corda::sweep
