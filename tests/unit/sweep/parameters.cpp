// The parameters of samples: distributions, grids and splits.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "support/failure.hpp"
#include "unit/sweep/support.hpp"

namespace corda::sweep {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kSamples = 20'000;

class SweepParameters : public testing::Test {
  protected:
    [[nodiscard]] SweepDef of(const std::string& vary, const std::string& head = "samples = 20000\n") const {
        return folder_.load(head + "[vary]\n" + vary);
    }
    /// The values of the first key in all samples.
    static std::vector<Json> values_of(const SweepDef& sweep) {
        std::vector<Json> values;
        for (std::int64_t i = 0; i < sweep.samples; ++i)
            values.push_back(parameters_of(sweep, i).front().second);
        return values;
    }
    /// The same as numbers, with a function of them.
    [[nodiscard]] std::vector<double> numbers_of(const std::string& distribution,
                                                 double (*of_number)(double) = nullptr) const {
        std::vector<double> numbers;
        for (const Json& value : values_of(of("\"rope[0].mass\" = " + distribution))) {
            EXPECT_TRUE(value.is_number_float());
            numbers.push_back(of_number == nullptr ? value.get<double>() : of_number(value.get<double>()));
        }
        return numbers;
    }
    static double mean_of(const std::vector<double>& numbers) {
        return std::accumulate(numbers.begin(), numbers.end(), 0.0) / static_cast<double>(numbers.size());
    }
    static double deviation_of(const std::vector<double>& numbers) {
        const double mean = mean_of(numbers);
        double sum = 0.0;
        for (const double number : numbers) sum += (number - mean) * (number - mean);
        return std::sqrt(sum / static_cast<double>(numbers.size()));
    }
    static void expect_within(const std::vector<double>& numbers, double low, double high) {
        EXPECT_THAT(numbers, Each(testing::AllOf(testing::Ge(low), testing::Le(high))));
    }

    SweepFolder folder_;
};

TEST_F(SweepParameters, UniformNumbersHaveTheirMoments) {
    const auto numbers = numbers_of("{ uniform = [2.0, 6] }");
    expect_within(numbers, 2.0, 6.0);
    EXPECT_NEAR(mean_of(numbers), 4.0, 0.03);
    EXPECT_NEAR(deviation_of(numbers), 4.0 / std::sqrt(12.0), 0.02);
}

TEST_F(SweepParameters, LogUniformNumbersAreUniformInTheirLogarithm) {
    const auto logs = numbers_of("{ log_uniform = [0.01, 10.0] }", std::log10);
    expect_within(logs, -2.0, 1.0);
    EXPECT_NEAR(mean_of(logs), -0.5, 0.02);
    EXPECT_NEAR(deviation_of(logs), 3.0 / std::sqrt(12.0), 0.02);
}

TEST_F(SweepParameters, NormalNumbersHaveTheirMoments) {
    const auto numbers = numbers_of("{ normal = [3.0, 0.5] }");
    EXPECT_NEAR(mean_of(numbers), 3.0, 0.01);
    EXPECT_NEAR(deviation_of(numbers), 0.5, 0.01);
}

TEST_F(SweepParameters, BoundsTruncateNormalNumbers) {
    // Mean phi(0) / (1 - Phi(0)) above 3, in units of the deviation: sqrt(2 / pi).
    const auto numbers = numbers_of("{ normal = [3.0, 0.5], min = 3 }");
    EXPECT_GE(*std::min_element(numbers.begin(), numbers.end()), 3.0);
    EXPECT_NEAR(mean_of(numbers), 3.0 + 0.5 * std::sqrt(2.0 / 3.14159265), 0.01);
    expect_within(numbers_of("{ normal = [3.0, 0.5], min = 2.9, max = 3.1 }"), 2.9, 3.1);
}

TEST_F(SweepParameters, NormalNumbersThatBoundsKeepOutAreRefused) {
    const SweepDef sweep = of("\"rope[0].mass\" = { normal = [0.0, 1.0], min = 50.0 }");
    const test::Failure failure = test::failure_of([&] { static_cast<void>(parameters_of(sweep, 0)); });
    EXPECT_EQ(failure.code, ExitCode::kInvalidScene);
    EXPECT_THAT(failure.message, HasSubstr("vary.\"rope[0].mass\": of 1000 numbers"));
    EXPECT_THAT(failure.message, HasSubstr("give wider bounds"));
}

TEST_F(SweepParameters, IntegersAreEquallyLikelyWithBothEnds) {
    std::map<std::int64_t, int> counts;
    for (const Json& value : values_of(of("\"rope[0].hang.links\" = { integer = [3, 7] }"))) {
        ASSERT_TRUE(value.is_number_integer());
        ++counts[value.get<std::int64_t>()];
    }
    ASSERT_EQ(counts.size(), 5U);
    EXPECT_EQ(counts.begin()->first, 3);
    for (const auto& [value, count] : counts) EXPECT_NEAR(count, kSamples / 5, 200) << value;
    EXPECT_THAT(values_of(of("\"rope[0].hang.links\" = { integer = [-4, -4] }", "samples = 9\n")),
                Each(Json(-4)));
}

TEST_F(SweepParameters, ChoicesAreEquallyLikelyAndKeepTheirType) {
    std::map<std::string, int> counts;
    for (const Json& value : values_of(of("\"world.gravity\" = [9.81, 2, [0.0, -1], \"x\"]")))
        ++counts[value.dump()];
    EXPECT_EQ(counts.size(), 4U);
    for (const char* const text : {"9.81", "2", "[0.0,-1]", "\"x\""})
        EXPECT_NEAR(counts[text], kSamples / 4, 200) << text;
}

TEST_F(SweepParameters, ComponentsOfAVectorAreIndependent) {
    double sum = 0.0;
    for (const Json& value : values_of(of("\"world.gravity\" = { uniform = [[-1, 10], [1, 30.0]] }"))) {
        ASSERT_EQ(value.size(), 2U);
        const double x = value[0].get<double>();
        const double y = (value[1].get<double>() - 20.0) / 10.0;
        ASSERT_LE(std::abs(x), 1.0);
        ASSERT_LE(std::abs(y), 1.0);
        sum += 3.0 * x * y / static_cast<double>(kSamples);
    }
    EXPECT_NEAR(sum, 0.0, 0.02);  // their correlation
}

TEST_F(SweepParameters, KeysAreIndependentOfEachOther) {
    const std::string mass = "\"rope[0].mass\" = { uniform = [1.0, 2.0] }\n";
    const std::string links = "\"rope[0].hang.links\" = { integer = [3, 30] }\n";
    const std::string gravity = "\"world.gravity\" = { normal = [9.0, 1.0] }\n";
    const SweepDef one = of(mass);
    const SweepDef all = of(links + mass + gravity, "samples = 5\n");
    for (std::int64_t i = 0; i < all.samples; ++i) {
        const Parameters parameters = parameters_of(all, i);
        EXPECT_EQ(parameters[0].first, "rope[0].hang.links");
        EXPECT_EQ(parameters[1], parameters_of(one, i).front());
        EXPECT_EQ(parameters[2].first, "world.gravity");
        EXPECT_EQ(split_of(one, i), "");
    }
}

TEST_F(SweepParameters, SeedsChangeAllSamples) {
    const std::string mass = "\"rope[0].mass\" = { uniform = [1.0, 2.0] }\n";
    const SweepDef first = of(mass, "samples = 100\n");
    const SweepDef same = of(mass, "samples = 100\nseed = 0\n");
    const SweepDef other = of(mass, "samples = 100\nseed = 1\n");
    EXPECT_EQ(values_of(first), values_of(same));
    for (std::int64_t i = 0; i < 100; ++i) EXPECT_NE(parameters_of(first, i), parameters_of(other, i));
}

TEST_F(SweepParameters, GridHasEveryCombinationAndTheLastKeyVariesFastest) {
    const SweepDef sweep =
        of("\"world.gravity\" = [9.81, 1.62]\n\"rope[0].hang.links\" = [3, 5, 8]\n", "grid = true\n");
    ASSERT_EQ(sweep.samples, 6);
    std::vector<std::string> texts;
    for (std::int64_t i = 0; i < 6; ++i) {
        const auto settings = settings_of(parameters_of(sweep, i));
        texts.push_back(settings[0] + " " + settings[1]);
    }
    EXPECT_THAT(
        texts,
        ElementsAre("rope[0].hang.links=3 world.gravity=9.81", "rope[0].hang.links=5 world.gravity=9.81",
                    "rope[0].hang.links=8 world.gravity=9.81", "rope[0].hang.links=3 world.gravity=1.62",
                    "rope[0].hang.links=5 world.gravity=1.62", "rope[0].hang.links=8 world.gravity=1.62"));
}

TEST_F(SweepParameters, SplitsHaveTheirShares) {
    const std::string vary = "\"rope[0].mass\" = { uniform = [1.0, 2.0] }\n";
    const SweepDef sweep = of(vary + "[split]\ntrain = 0.7\ntest = 0.2\nunused = 0\nvalidation = 0.1\n");
    std::map<std::string, int> counts;
    double mass_of_test = 0.0;
    for (std::int64_t i = 0; i < kSamples; ++i) {
        const std::string split = split_of(sweep, i);
        ++counts[split];
        if (split == "test") mass_of_test += parameters_of(sweep, i).front().second.get<double>();
    }
    EXPECT_EQ(counts.size(), 3U);
    EXPECT_NEAR(counts["train"], 14'000, 150);
    EXPECT_NEAR(counts["test"], 4'000, 150);
    EXPECT_NEAR(counts["validation"], 2'000, 150);
    EXPECT_NEAR(mass_of_test / counts["test"], 1.5, 0.02);  // independent of the parameters
}

TEST_F(SweepParameters, SplitOfRoundedSharesIsOneOfThem) {
    SweepDef sweep = of("\"rope[0].mass\" = [1.0]\n[split]\na = 0.5\nb = 0.5\nc = 0\n");
    for (Split& split : sweep.splits) split.share *= 1e-12;
    EXPECT_EQ(split_of(sweep, 3), "b");
}

TEST_F(SweepParameters, SettingsAreToml) {
    EXPECT_EQ(toml_of(Json::parse(R"([1, -0.5, true, "a\"b", {"t": 0.0, "at": [1e300, 3]}])")),
              R"([1, -0.5, true, "a\"b", {"at" = [1e300, 3], "t" = 0}])");
    EXPECT_EQ(toml_of(0.1), "0.1");
    EXPECT_EQ(value_text("a b"), "a b");
    EXPECT_EQ(value_text(Json::array({1, 2})), "[1, 2]");
}

/// A number in the text of a setting is the same number.
TEST_F(SweepParameters, SettingsKeepAllDigits) {
    const SweepDef sweep = of("\"world.drag\" = { log_uniform = [1e-9, 1.0] }", "samples = 200\n");
    for (std::int64_t i = 0; i < sweep.samples; ++i) {
        const Parameters parameters = parameters_of(sweep, i);
        EXPECT_EQ(scene_of(sweep, parameters).world.drag_1_s, parameters.front().second.get<double>());
    }
}

}  // namespace
}  // namespace corda::sweep
