// Every way in which a sweep file can be wrong has a message with the exact place, the key, the value and the
// remedy.
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "corda/sweep/summary.hpp"
#include "support/failure.hpp"
#include "unit/sweep/support.hpp"

namespace corda::sweep {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// A wrong sweep file, and its message.
struct Case {
    std::string more;   ///< from line 3 on
    std::string begin;  ///< of the message, behind the name of the file: place and key
    std::string part;   ///< stands in the message
};

class SweepFile : public testing::Test {
  protected:
    [[nodiscard]] test::Failure failure_of(const std::string& more) const {
        return test::failure_of([&] { static_cast<void>(folder_.load(more)); });
    }
    void expect_errors(const std::vector<Case>& cases) const {
        for (const Case& wrong : cases) {
            SCOPED_TRACE(wrong.more);
            const test::Failure failure = failure_of(wrong.more);
            EXPECT_EQ(failure.code, ExitCode::kInvalidScene);
            EXPECT_THAT(failure.message, StartsWith(folder_.file("sweep.toml") + wrong.begin));
            EXPECT_THAT(failure.message, HasSubstr(wrong.part));
            EXPECT_EQ(std::count(failure.message.begin(), failure.message.end(), '\n'), 0);
        }
    }
    /// A sweep of a key with these values, on line 5.
    static std::string vary(const std::string& values) {
        return "samples = 1\n[vary]\n\"rope[0].mass\" = " + values + "\n";
    }

    SweepFolder folder_;
};

const std::string kVary = "[vary]\n\"rope[0].mass\" = [1, 2]\n";

TEST_F(SweepFile, DefaultsAreAllPicturesLabelsAndColumns) {
    const SweepDef sweep = folder_.load("samples = 3\n" + kVary);
    EXPECT_EQ(sweep.source, folder_.file("sweep.toml"));
    EXPECT_EQ(sweep.scene_name, "scene.toml");
    EXPECT_EQ(sweep.scene_toml, kScene);
    EXPECT_EQ(sweep.samples, 3);
    EXPECT_FALSE(sweep.is_grid);
    EXPECT_EQ(sweep.seed, 0U);
    EXPECT_EQ(sweep.shard_samples, 256);
    EXPECT_EQ(sweep.pictures, Pictures::kMp4);
    EXPECT_EQ(sweep.labels.size(), all_labels().size());
    EXPECT_EQ(sweep.summary.size(), summary_columns().size());
    EXPECT_THAT(sweep.splits, IsEmpty());
}

TEST_F(SweepFile, EveryKeyIsRead) {
    const SweepDef sweep = folder_.load(R"(samples = 1000000000
seed = 9223372036854775807
shard_samples = 1000000
[vary]
"world.gravity" = [1.62, [0.0, -9.81]]
"rope[0].hang.links" = { integer = [-3, 30] }
"rope[0].mass" = { normal = [1, 2], min = 0.1 }
"rope[0].hang.from" = { uniform = [[0, 0], [1.0, 2]] }
[output]
pictures = "npz"
labels = ["mask", "energy"]
summary = ["horizon_s", "period_s"]
[split]
train = 0.9
test = 0.1
)");
    EXPECT_EQ(sweep.samples, 1'000'000'000);
    EXPECT_EQ(sweep.seed, 9223372036854775807U);
    EXPECT_EQ(sweep.shard_samples, 1'000'000);
    ASSERT_EQ(sweep.vary.size(), 4U);
    EXPECT_EQ(sweep.vary[0].key, "world.gravity");
    EXPECT_EQ(Json(std::get<Choice>(sweep.vary[0].values).values).dump(), "[1.62,[0.0,-9.81]]");
    const auto& links = std::get<Distribution>(sweep.vary[1].values);
    EXPECT_EQ(links.shape, Shape::kInteger);
    EXPECT_FALSE(links.is_vector);
    EXPECT_THAT(links.first, ElementsAre(-3.0));
    EXPECT_THAT(links.second, ElementsAre(30.0));
    const auto& mass = std::get<Distribution>(sweep.vary[2].values);
    EXPECT_THAT(mass.min, ElementsAre(0.1));
    EXPECT_THAT(mass.max, ElementsAre(std::numeric_limits<double>::infinity()));
    const auto& from = std::get<Distribution>(sweep.vary[3].values);
    EXPECT_TRUE(from.is_vector);
    EXPECT_THAT(from.second, ElementsAre(1.0, 2.0));
    EXPECT_EQ(sweep.pictures, Pictures::kNpz);
    EXPECT_THAT(sweep.labels, ElementsAre(find_label("times"), find_label("energy"), find_label("mask")));
    EXPECT_THAT(sweep.summary, ElementsAre("horizon_s", "period_s"));
    ASSERT_EQ(sweep.splits.size(), 2U);
}

TEST_F(SweepFile, KeysAreCheckedAtTheTop) {
    expect_errors({
        {kVary, ":1:1: samples: ", "is missing; give a number of samples, or grid = true"},
        {"samples = 1\nshards = 3\n" + kVary,
         ":4:1: shards: ", "unknown key \"shards\"; there are schema, scene, samples"},
        {"samples = 1\nsede = 3\n" + kVary, ":4:1: sede: ", "unknown key \"sede\"; did you mean \"seed\"?"},
        {"samples = 0\n" + kVary, ":3:11: samples: ", "0 is an integer; give an integer, 1 .. 1000000000"},
        {"samples = 10.0\n" + kVary, ":3:11: samples: ", "10 is a number with a fraction; give an integer"},
        {"samples = 1000000001\n" + kVary, ":3:11: samples: ", "give an integer, 1 .. 1000000000"},
        {"samples = 1\nseed = -1\n" + kVary, ":4:8: seed: ", "-1 is an integer; give an integer, 0 .. "},
        {"samples = 1\nshard_samples = 0\n" + kVary,
         ":4:17: shard_samples: ", "give an integer, 1 .. 1000000"},
        {"samples = 1\n", ":1:1: vary: ", "no key varies; give [vary] with keys of the scene"},
        {"samples = 1\n[vary]\n", ":4:1: vary: ", "no key varies"},
        {"samples = 1\nvary = 3\n", ":4:8: vary: ", "3 is an integer; give a table [vary]"},
        {"samples = 1\noutput = \"mp4\"\n" + kVary,
         ":4:10: output: ", "\"mp4\" is a string; give a table [output]"},
        {"samples = \n" + kVary, ":3:", "expected value"},
    });
}

TEST_F(SweepFile, AGridHasListsAndNoNumberOfSamples) {
    const std::string mass = "\"rope[0].mass\" = { uniform = [1, 2] }\n";
    expect_errors({
        {"samples = 3\ngrid = true\n" + kVary,
         ":3:11: samples: ", "a grid has a sample for each combination; leave it out"},
        {"grid = 1\n" + kVary, ":3:8: grid: ", "1 is an integer; give true or false"},
        {"grid = false\n" + kVary, ":1:1: samples: ", "is missing"},
        {"grid = true\n[vary]\n" + mass, ":5:18: vary.\"rope[0].mass\": ",
         "a distribution has no combinations; give a list of values, or leave out grid"},
    });
    std::string many = "grid = true\n[vary]\n";
    for (const char* const key :
         {"rope[0].mass", "rope[0].payload", "world.drag", "world.gravity", "world.duration"}) {
        many += "\"" + std::string(key) + "\" = [";
        for (int k = 0; k < 100; ++k) many += "1, ";
        many += "]\n";
    }
    expect_errors({{many, ":3:8: grid: ", "more than 1000000000 combinations; give shorter lists"}});
}

TEST_F(SweepFile, VariedKeysAreThoseOfScenes) {
    expect_errors({
        {"samples = 1\n[vary]\n\"rope[0].mas\" = [1]\n",
         ":5:1: vary.\"rope[0].mas\": ", "no key of a scene; did you mean \"mass\""},
        {"samples = 1\n[vary]\nrope.mass = [1]\n",
         ":5:1: vary.\"rope\": ", "quote a dotted key, such as \"rope[0].hang.angle_deg\""},
        {"samples = 1\n[vary]\n\"mass\" = [1]\n", ":5:1: vary.\"mass\": ", "no key of a scene"},
        {"samples = 1\n[vary]\n\"rope[7].mass\" = [1]\n", ":5:18: vary.\"rope[7].mass\": ",
         "does not fit scene.toml: rope: index 7 is out of range; the list has 1; give 0"},
        {"samples = 1\n[vary]\n\"net[0].mass\" = [1]\n",
         ":5:17: vary.\"net[0].mass\": ", "the scene gives no list \"net\"; add net to it first"},
        {"samples = 1\n[vary]\n\"rope.mass\" = [1]\n",
         ":5:15: vary.\"rope.mass\": ", "give an index: rope[0]"},
        {"samples = 1\n[vary]\n\"rope[a].mass\" = [1]\n",
         ":5:18: vary.\"rope[a].mass\": ", "is not a key; give one such as rope[0].mass"},
    });
}

TEST_F(SweepFile, ValuesAreListsOrDistributions) {
    const std::string at = ":5:18: vary.\"rope[0].mass\": ";
    expect_errors({
        {vary("1.0"), at,
         "1 is a number with a fraction; give a list of values, or a distribution such as { uniform"},
        {vary("[]"), at, "an empty list; give values to choose from"},
        {vary("[1979-05-27]"),
         ":5:19: vary.\"rope[0].mass\": ", "this is a date or a time; no key of a scene takes"},
        {vary("{ }"), at, "no distribution; give uniform, log_uniform, normal, integer"},
        {vary("{ unifrom = [1, 2] }"),
         ":5:20: vary.\"rope[0].mass\".unifrom: ", "unknown key \"unifrom\"; did you mean \"uniform\"?"},
        {vary("{ uniform = [1, 2], normal = [1, 2] }"), ":5:", "two distributions; give one"},
    });
}

TEST_F(SweepFile, DistributionsHaveSoundEnds) {
    const std::string uniform =
        "uniform is [least, largest], two numbers, the smaller first, or two vectors of one length";
    const std::string log_uniform = "log_uniform is [least, largest], two positive numbers";
    const std::string normal = "normal is [mean, standard deviation], the second positive";
    const std::string integer = "integer is [least, largest], two whole numbers, both included";
    for (const auto& [values, part] : std::vector<std::pair<std::string, std::string>>{
             {"uniform = 3", uniform},
             {"uniform = [1]", uniform},
             {"uniform = [1, 2, 3]", uniform},
             {"uniform = [2, 1]", uniform},
             {"uniform = [1, \"2\"]", uniform},
             {"uniform = [[1], 2]", uniform},
             {"uniform = [[1, 2], [3]]", uniform},
             {"uniform = [[], []]", uniform},
             {"uniform = [1, inf]", uniform},
             {"uniform = [nan, 1]", uniform},
             {"uniform = [-1e308, 1e308]", uniform},
             {"log_uniform = [0, 1]", log_uniform},
             {"log_uniform = [-1, 1]", log_uniform},
             {"log_uniform = [2, 1]", log_uniform},
             {"log_uniform = [1e-320, 1]", log_uniform},
             {"log_uniform = [1e-300, 1e300]", log_uniform},
             {"normal = [1, 0]", normal},
             {"normal = [1, -1]", normal},
             {"integer = [1.5, 2]", integer},
             {"integer = [2, 1]", integer},
             {"integer = [0, 9007199254740992]", integer},
         }) {
        SCOPED_TRACE(values);
        expect_errors({{vary("{ " + values + " }"), ":5:", part}});
        EXPECT_THAT(failure_of(vary("{ " + values + " }")).message, HasSubstr(": vary.\"rope[0].mass\": "));
    }
    for (const char* const values : {"uniform = [1, 1]", "integer = [2.0, 2]", "log_uniform = [1, 1]"})
        EXPECT_EQ(failure_of(vary("{ " + std::string(values) + " }")).message, "") << values;
}

TEST_F(SweepFile, BoundsAreOfANormalDistribution) {
    expect_errors({
        {vary("{ uniform = [1, 2], min = 1 }"),
         ":5:44: vary.\"rope[0].mass\": ", "min bounds a normal distribution only; leave it out"},
        {vary("{ normal = [1, 2], max = \"3\" }"),
         ":5:43: vary.\"rope[0].mass\": ", "max: \"3\" is a string; give as many numbers as normal has"},
        {vary("{ normal = [[1, 2], [3, 4]], max = 3 }"),
         ":5:53: vary.\"rope[0].mass\": ", "as many numbers as normal has"},
        {vary("{ normal = [1, 2], min = 3, max = 3 }"),
         ":5:18: vary.\"rope[0].mass\": ", "min is not less than max"},
    });
}

TEST_F(SweepFile, OutputIsCheckedWordByWord) {
    const std::string head = "samples = 1\n" + kVary + "[output]\n";
    expect_errors({
        {head + "pictures = \"gif\"\n",
         ":7:12: output.pictures: ", "\"gif\" is a string; give mp4, png, npz, none"},
        {head + "pictures = true\n", ":7:12: output.pictures: ", "true is a boolean; give mp4"},
        {head + "labels = \"mask\"\n",
         ":7:10: output.labels: ", "\"mask\" is a string; give a list of positions, velocities"},
        {head + "labels = [\"mask\", \"masks\"]\n",
         ":7:19: output.labels[1]: ", "\"masks\" is a string; give positions, velocities"},
        {head + "summary = [\"angle\"]\n",
         ":7:12: output.summary[0]: ", "\"angle\" is a string; give period_s, angle_max_deg"},
        {head + "picture = \"mp4\"\n", ":7:1: output.picture: ", "did you mean \"pictures\"?"},
    });
    const SweepDef none = folder_.load(head + "labels = []\nsummary = []\n");
    EXPECT_THAT(none.labels, ElementsAre(find_label("times")));
    EXPECT_THAT(none.summary, IsEmpty());
}

TEST_F(SweepFile, SharesOfSplitsHaveTheSumOne) {
    const std::string head = "samples = 1\n" + kVary + "[split]\n";
    expect_errors({
        {head + "train = 0.8\ntest = 0.1\n",
         ":6:1: split: ", "the shares have the sum 0.9; give shares with the sum 1"},
        {head + "train = 0.8\ntest = 0.3\n", ":6:1: split: ", "the sum 1.1"},
        {head + "train = 1\n\"a/b\" = 0\n",
         ":8:9: split.a/b: ", "no name of a split; give a word such as train"},
    });
    const test::Failure wrong = failure_of(head + "train = \"all\"\ntest = -0.1\n");
    EXPECT_THAT(wrong.message,
                AllOf(HasSubstr(":7:9: split.train: \"all\" is a string; give a share, 0 .. 1"),
                      HasSubstr(":8:8: split.test: -0.1 is a number with a fraction; give a share")));
    EXPECT_EQ(failure_of(head + "a = 0.1\nb = 0.2\nc = 0.7\n").message, "");
}

TEST_F(SweepFile, AllProblemsAreNamedInOrder) {
    const std::string message = failure_of("samples = 0\nsede = 1\n[vary]\n\"rope[0].mas\" = [1]\n").message;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 2);
    EXPECT_THAT(message, AllOf(HasSubstr("sweep.toml:3:11: samples: "), HasSubstr("sweep.toml:4:1: sede: "),
                               HasSubstr("sweep.toml:6:1: vary.\"rope[0].mas\": ")));
}

TEST_F(SweepFile, ItsSceneMustBeThereAndSound) {
    const test::ScratchFolder folder;
    const auto failure_of_scene = [&](const std::string& line) {
        const std::string path =
            folder.write("sweep.toml", "schema = 1\n" + line + "\nsamples = 1\n" + kVary);
        return test::failure_of([&] { static_cast<void>(load_sweep(path)); });
    };
    const test::Failure missing = failure_of_scene("scene = \"none.toml\"");
    EXPECT_EQ(missing.code, ExitCode::kIo);
    EXPECT_THAT(missing.message,
                StartsWith(folder.file("sweep.toml") + ":2:9: scene: " + folder.file("none.toml") +
                           ": cannot read the scene file: No such file"));
    EXPECT_THAT(failure_of_scene("").message,
                HasSubstr("sweep.toml:1:1: scene: is missing; give the path of a scene"));
    EXPECT_THAT(failure_of_scene("scene = 3").message,
                HasSubstr(":2:9: scene: 3 is an integer; give the path of a scene"));
    EXPECT_THAT(failure_of_scene("scene = \"\"").message,
                HasSubstr(":2:9: scene: \"\" is a string; give the path"));
    static_cast<void>(
        folder.write("bad.toml", "schema = 1\n[world]\ngravty = 1\n" + kScene.substr(kScene.find("[[rope"))));
    const test::Failure bad = failure_of_scene("scene = \"bad.toml\"");
    EXPECT_EQ(bad.code, ExitCode::kInvalidScene);
    EXPECT_THAT(bad.message, StartsWith("bad.toml:3:1: world.gravty: unknown key"));
    EXPECT_EQ(test::code_of([&] { static_cast<void>(load_sweep(folder.file("no.toml"))); }), ExitCode::kIo);
}

TEST_F(SweepFile, IdentityIsAllThatDeterminesASample) {
    const std::string vary = "[vary]\n\"rope[0].mass\" = { normal = [1, 2], min = 0.5 }\n";
    const auto identity = identity_of(folder_.load("samples = 3\n" + vary));
    EXPECT_EQ(identity_of(folder_.load("samples = 9\n" + vary)), identity);  // more of the same samples
    for (const std::string& other :
         {"samples = 3\nseed = 1\n" + vary, "samples = 3\nshard_samples = 2\n" + vary,
          "samples = 3\n" + vary + "[output]\npictures = \"png\"\n",
          "samples = 3\n" + vary + "[output]\nlabels = []\n",
          "samples = 3\n" + vary + "[output]\nsummary = []\n",
          "samples = 3\n" + vary + "[split]\ntrain = 1\n", "samples = 3\n" + vary + "\"world.drag\" = [0]\n",
          std::string("samples = 3\n[vary]\n\"rope[0].mass\" = { normal = [1, 2], min = 0.6 }\n"),
          std::string("samples = 3\n[vary]\n\"rope[0].mass\" = { uniform = [1, 2] }\n")})
        EXPECT_NE(identity_of(folder_.load(other)), identity) << other;
    const SweepFolder longer(kScene + "# another scene\n");
    EXPECT_NE(identity_of(longer.load("samples = 3\n" + vary)), identity);
}

}  // namespace
}  // namespace corda::sweep
