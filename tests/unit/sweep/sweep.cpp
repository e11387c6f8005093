#include "corda/sweep/sweep.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/media/bytes.hpp"
#include "support/failure.hpp"
#include "unit/sweep/support.hpp"

namespace corda::sweep {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SweepRun : public testing::Test {
  protected:
    [[nodiscard]] RunResult run(const SweepDef& sweep, const RunDef& more = {}) const {
        RunDef def = more;
        def.folder = folder_.file("out");
        return run_sweep(sweep, def);
    }
    [[nodiscard]] std::vector<SampleRow> rows_of(const SweepDef& sweep) const {
        std::vector<SampleRow> rows;
        read_rows(sweep, folder_.file("out"), [&](const SampleRow& row) { rows.push_back(row); });
        return rows;
    }
    [[nodiscard]] std::string shard_sum(const std::string& pictures) const {
        const SweepDef sweep = folder_.load(
            "samples = 2\nseed = 7\n[vary]\n"
            "\"rope[0].hang.angle_deg\" = { uniform = [5.0, 90.0] }\n"
            "\"rope[0].hang.links\" = { integer = [1, 5] }\n"
            "\"rope[0].mass\" = { log_uniform = [0.01, 10.0] }\n"
            "\"rope[0].payload\" = { normal = [1.0, 0.5], min = 0.0 }\n"
            "\"world.gravity\" = [1.62, 9.81]\n[output]\npictures = \"" +
            pictures + "\"\n[split]\ntrain = 0.5\ntest = 0.5\n");
        static_cast<void>(run(sweep, {.force = true}));
        return media::sha256_of_file(folder_.file("out/shard-000000.tar"));
    }

    SweepFolder folder_;
    const std::string vary_ =
        "[vary]\n\"rope[0].mass\" = { uniform = [1.0, 2.0] }\n[output]\npictures = \"none\"\n";
};

/// A change of these is a change of all data sets; src/CHANGELOG.md must name it.
TEST_F(SweepRun, ShardsHaveTheirBytes) {
    EXPECT_EQ(corda::version(), "0.1.0");  // it stands in every sample
    EXPECT_EQ(shard_sum("none"), "e20f47ccfcb56e9e01b48e7940855157c933fc0462c8485131118a10dc9901fb");
    EXPECT_EQ(shard_sum("png"), "9a2f4c6847682472c46e0b06faaaeadc4f282360fbf9bf352acf5074b684d77a");
    EXPECT_EQ(shard_sum("npz"), "8e9968c03da2fde16629d267afd1149b1c20fc09d3c7468a27c9df296c4fa171");
    // Those of a clip depend on the version of the encoder, which it names.
    const std::string sum = shard_sum("mp4");
    if (test::read_file(folder_.file("out/shard-000000.tar")).find("x264 - core 164 r3095 baee400 ") !=
        std::string::npos) {
        EXPECT_EQ(sum, "d750c2a8844d49f1f79fcaeb5d9426495a284e3cb9d0357b448fbbc8eec1293f");
    }
}

TEST_F(SweepRun, ReportsProgressAndStops) {
    const SweepDef sweep = folder_.load("samples = 6\nshard_samples = 2\n" + vary_);
    std::vector<std::int64_t> done;
    const auto take = [&](std::int64_t count, std::int64_t total) {
        EXPECT_EQ(total, 6);
        EXPECT_TRUE(done.empty() || count >= done.back());
        done.push_back(count);
        return count < 3;
    };
    EXPECT_EQ(test::code_of([&] { static_cast<void>(run(sweep, {.jobs = 1, .on_progress = take})); }),
              ExitCode::kInterrupted);
    EXPECT_EQ(done.front(), 0);
    EXPECT_EQ(done.back(), 3);
    EXPECT_EQ(rows_of(sweep).size(), 2U);  // of the shard that was finished
    const RunResult rest = run(sweep);
    EXPECT_EQ(rest.shards, 3);
    EXPECT_EQ(rest.shards_made, 2);
    EXPECT_EQ(rest.samples_made, 4);
    EXPECT_TRUE(rest.is_complete);
    EXPECT_EQ(rows_of(sweep).size(), 6U);
    EXPECT_THAT(check_sweep(sweep, folder_.file("out")), testing::IsEmpty());
}

TEST_F(SweepRun, RowsHaveParametersSummariesAndFailures) {
    const SweepDef sweep = folder_.load(
        "grid = true\nshard_samples = 2\n[vary]\n\"rope[0].mass\" = [1.0, -1.0, 2.0]\n[output]\npictures = "
        "\"none\"\n"
        "summary = [\"angle_max_deg\", \"period_s\"]\n");
    const RunResult result = run(sweep);
    EXPECT_EQ(result.failed, 1);
    const std::vector<SampleRow> rows = rows_of(sweep);
    ASSERT_EQ(rows.size(), 3U);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].number, static_cast<std::int64_t>(i));
        EXPECT_EQ(rows[i].parameters, parameters_of(sweep, rows[i].number));
        EXPECT_EQ(rows[i].failure.has_value(), i == 1);
        EXPECT_EQ(rows[i].summary.size(), i == 1 ? 0U : 1U);  // no period in 0.1 s
    }
    EXPECT_NEAR(rows[0].summary.at("angle_max_deg"), 40.0, 1e-9);
    EXPECT_EQ(rows[1].failure->code, ExitCode::kInvalidScene);
    EXPECT_THAT(rows[1].failure->message, HasSubstr("rope[0].mass: -1 is not >= 1e-12"));
}

TEST(SweepKey, HasAtLeastSixDigits) {
    EXPECT_EQ(key_of(0), "000000");
    EXPECT_EQ(key_of(999'999), "999999");
    EXPECT_EQ(key_of(1'000'000), "1000000");
}

/// Labels, parameters and the bounds of the error are in each sample.
TEST_F(SweepRun, SamplesHaveArraysOfTheirShapes) {
    const SweepDef sweep =
        folder_.load("samples = 1\n[vary]\n\"rope[0].hang.links\" = [3]\n[output]\npictures = \"npz\"\n");
    const Sample sample = SampleMaker(sweep).make(0);
    ASSERT_FALSE(sample.failure) << sample.failure->message;
    std::map<std::string, std::vector<std::int64_t>> shapes;
    for (const Array& array : sample.arrays) {
        shapes[array.name] = array.shape;
        std::size_t bytes = array.is_bytes ? 1 : sizeof(double);
        for (const std::int64_t count : array.shape) bytes *= static_cast<std::size_t>(count);
        EXPECT_EQ(array.data.size(), bytes) << array.name;
    }
    EXPECT_EQ(shapes, (std::map<std::string, std::vector<std::int64_t>>{{"times", {3}},
                                                                        {"positions", {3, 4, 2}},
                                                                        {"velocities", {3, 4, 2}},
                                                                        {"tensions", {3, 3}},
                                                                        {"energy", {3, 3}},
                                                                        {"pixels", {3, 4, 2}},
                                                                        {"mask", {3, 32, 32}},
                                                                        {"frames", {3, 32, 32, 4}}}));
    EXPECT_TRUE(sample.pictures.empty());
    EXPECT_EQ(sample.info.at("fps"), "30");
    EXPECT_EQ(sample.info.at("frames"), 3);
    EXPECT_EQ(sample.info.at("parameters"), (Json{{"rope[0].hang.links", 3}}));
    EXPECT_EQ(sample.info.at("px_per_m").get<double>(),
              32.0 / sample.info.at("camera").at("height").get<double>());
    for (const char* const key : {"error_estimate_m", "error_estimate_px", "horizon_s"})
        EXPECT_TRUE(sample.info.contains(key)) << key;
}

}  // namespace
}  // namespace corda::sweep
