// The schema says what the reader does, and the reference page says what the schema says.
#include "corda/scene/schema.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "corda/scene/write_scene.hpp"
#include "unit/scene/support.hpp"

namespace corda::scene {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A scene that has the section of `key`, read with one more setting for that key; "" for none.
Scene scene_with(const Key& key, const std::string& value) {
    const std::string rope = "[[rope]]\nline = { particles = 3, step = [0, -1] }\n";
    const std::string grid = "[[net]]\ngrid = { columns = 3, rows = 2, spacing = 0.5 }\n";
    std::string toml = "schema = 1\n" + rope;
    if (key.section == "rope.hang") toml = "schema = 1\n[[rope]]\nhang = { links = 3, length = 1 }\n";
    if (key.section == "net" || key.section == "net.grid") toml = "schema = 1\n" + grid;
    const std::string moves =
        "moves = [{ pin = 0, waves = [{ amplitude = [1, 0], frequency = 1 }], path = [{ t = 0, by = [0, 0] "
        "}] }]\n";
    if (key.section.starts_with("rope.moves")) toml += moves;
    if (key.section.starts_with("net.moves")) toml = "schema = 1\n" + grid + moves;
    for (const std::string list : {"release", "cut"}) {
        const std::string events =
            list + (list == "cut" ? " = [{ link = 0, t = 1 }]\n" : " = [{ pin = 0, t = 1 }]\n");
        if (key.section == "rope." + list) toml += events;
        if (key.section == "net." + list) toml = "schema = 1\n" + grid + events;
    }
    if (key.section == "world.gusts") toml += "[world.gusts]\namplitude = [1, 0]\nfrequency = 1\n";
    if (key.section == "solver.bodies") toml += "[[solver.bodies]]\nropes = [0]\nmethod = \"exact\"\n";
    if (key.section == "solver.bodies" && key.name == "ropes")
        toml = "schema = 1\n" + grid + rope + "[[solver.bodies]]\nnets = [0]\nmethod = \"exact\"\n";
    if (key.section == "rope.copies" && key.name != "count") toml += "[rope.copies]\ncount = 2\n";
    if (key.section == "overlay.texts") toml += "[[overlay.texts]]\ntext = \"a\"\n";
    if (key.section == "camera.path") toml += "[[camera.path]]\nt = 0\n";
    if (key.section == "golden" && key.name != "at") toml += "[golden]\nat = [0]\n";
    std::string path = path_of(key);
    for (std::size_t list = path.find("[]"); list != std::string::npos; list = path.find("[]"))
        path.insert(list + 1, "0");
    std::vector<Setting> settings;
    if (!key.methods.empty()) {
        const std::string table = path.substr(0, path.rfind('.'));
        settings.push_back(fmt::format("{}.method={}", table, key.methods.front()));
    }
    if (!value.empty()) settings.push_back(path + "=" + value);
    return parse_scene(toml, "swing.toml", settings);
}

TEST(SceneKeys, AreUniqueInTheirSections) {
    std::set<std::string> paths;
    for (const Key& key : all_keys()) {
        EXPECT_TRUE(paths.insert(path_of(key)).second) << path_of(key);
        EXPECT_EQ(find_key(key.section, key.name), &key);
    }
    EXPECT_EQ(find_key("world", "gravty"), nullptr);
}

TEST(SceneKeys, OfASectionStandTogether) {
    for (const Key& key : all_keys()) {
        const std::span<const Key> keys = keys_of(key.section);
        EXPECT_TRUE(&key >= keys.data() && &key < keys.data() + keys.size()) << path_of(key);
        for (const Key& other : keys) EXPECT_EQ(other.section, key.section);
    }
    EXPECT_TRUE(keys_of("wrld").empty());
}

TEST(SceneKeys, HaveThePathsOfTheirTables) {
    EXPECT_EQ(path_of(*find_key("world", "drag")), "world.drag");
    EXPECT_EQ(path_of(*find_key("net.grid", "rows")), "net[].grid.rows");
    EXPECT_EQ(path_of(*find_key("solver.bodies", "step")), "solver.bodies[].step");
    EXPECT_EQ(key_of_section("solver.bodies"), find_key("solver", "bodies"));
    EXPECT_EQ(key_of_section(""), nullptr);
}

TEST(SceneKeys, HaveAMeaningATypeAndARemedy) {
    for (const Key& key : all_keys()) {
        SCOPED_TRACE(path_of(key));
        EXPECT_THAT(key.meaning, Not(IsEmpty()));
        EXPECT_THAT(type_text(key), Not(IsEmpty()));
        EXPECT_THAT(remedy(key), testing::AnyOf(testing::StartsWith("give "), testing::StartsWith("write ")));
        EXPECT_EQ((key.type.forms & (kPair | kPairs)) != 0, !key.type.pair.empty());
    }
}

TEST(SceneKeys, DefaultsAreThoseOfAFileWithoutTheKey) {
    int count = 0;
    for (const Key& key : all_keys()) {
        // Without a theme a scene has the dark one, and figures the paper one.
        if (key.binding.initial.toml.empty() || path_of(key) == "style.theme") continue;
        SCOPED_TRACE(path_of(key));
        EXPECT_THAT(
            differences(values_of(scene_with(key, key.binding.initial.toml)), values_of(scene_with(key, ""))),
            IsEmpty());
        ++count;
    }
    EXPECT_GT(count, 40);
}

TEST(SceneKeys, AllHaveAFieldButTablesAndTheSchema) {
    for (const Key& key : all_keys()) {
        const bool is_table = key.type.kind == Kind::kTable || key.type.kind == Kind::kTables;
        EXPECT_EQ(key.binding.fields.empty(), is_table || key.name == "schema") << path_of(key);
    }
}

/// A value of the key that holds `number`; empty for a list of pairs.
std::string value_with(const Key& key, const std::string& number) {
    if ((key.type.forms & kOne) != 0) return number;
    return (key.type.forms & kPair) != 0 ? fmt::format("[{}, {}]", number, number) : "";
}

TEST(SceneKeys, RefuseValuesOutsideTheirRangeNamingIt) {
    int count = 0;
    for (const Key& key : all_keys()) {
        const Range& range = key.type.range;
        const auto expect_refused = [&](double number) {
            const std::string value = value_with(key, fmt::format("{}", number));
            if (value.empty() || !std::isfinite(number)) return;
            SCOPED_TRACE(path_of(key) + " = " + value);
            try {
                static_cast<void>(scene_with(key, value));
                ADD_FAILURE() << "is accepted";
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ExitCode::kInvalidScene);
                EXPECT_THAT(error.what(), HasSubstr(range_text(key)));
                EXPECT_THAT(error.what(), HasSubstr(key.name));
            }
            ++count;
        };
        if (range.low != Range{}.low) expect_refused(range.low_open ? range.low : range.low - 1.0);
        if (range.high != Range{}.high) expect_refused(range.high_open ? range.high : 2.0 * range.high);
    }
    EXPECT_GT(count, 50);
}

TEST(SceneKeys, AreAllInTheHelp) {
    const std::string help = keys_text();
    for (const Key& key : all_keys()) EXPECT_THAT(help, HasSubstr(fmt::format("\n  {} ", key.name)));
    EXPECT_THAT(help, HasSubstr("\n[[rope]]\n"));
    EXPECT_THAT(help, HasSubstr("\nnet.grid\n"));
    EXPECT_THAT(help, HasSubstr("\n[[solver.bodies]]\n"));
    EXPECT_THAT(help, HasSubstr("  margin               number, 0 .. 0.45, default 0.08\n"));
}

TEST(SceneKeys, NumbersAreShort) {
    for (const auto& [value, words] : {std::pair{1e-9, "1e-9"},
                                       {0.08, "0.08"},
                                       {4e9, "4e9"},
                                       {16384.0, "16384"},
                                       {1e6, "1e6"},
                                       {999999.0, "999999"},
                                       {-1e9, "-1e9"},
                                       {9.81, "9.81"},
                                       {0.0, "0"},
                                       {1e-12, "1e-12"},
                                       {0.0001, "0.0001"},
                                       {1.0 / 3e5, "3.3333333333333333e-6"},
                                       {1e22, "1e22"},
                                       {5e-324, "5e-324"},
                                       {-0.0, "-0.0"}})
        EXPECT_EQ(number_text(value), words);
}

std::string file_text(const std::string& path) {
    std::ostringstream all;
    all << std::ifstream(path).rdbuf();
    return all.str();
}

/// CORDA_UPDATE_README=1 in the environment writes the table into the page.
TEST(SceneKeys, AreListedInTheReadme) {
    const std::string path = CORDA_EXAMPLES "/../src/corda/scene/README.md";
    const std::string begin = "<!-- begin of the scene keys -->\n";
    const std::string end = "<!-- end of the scene keys -->\n";
    std::string readme = file_text(path);
    const std::size_t first = readme.find(begin);
    const std::size_t last = readme.find(end);
    ASSERT_NE(first, std::string::npos);
    ASSERT_NE(last, std::string::npos);
    const std::size_t table = first + begin.size();
    const std::string expected = "\n" + keys_markdown() + "\n";
    if (std::getenv("CORDA_UPDATE_README") != nullptr) {
        readme.replace(table, last - table, expected);
        std::ofstream(path) << readme;
    }
    EXPECT_EQ(file_text(path).substr(table, expected.size()), expected)
        << "run this test with CORDA_UPDATE_README=1";
}

}  // namespace
}  // namespace corda::scene
