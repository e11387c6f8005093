// The same scene gives the same bytes of state on every run, compiler and CPU: a hash of each golden scene's
// motion, by every method that can run it. A hash that changes means that pictures and videos of old scenes
// change: say why in the commit.

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <string>

#include "corda/scene/auto_plan.hpp"
#include "corda/scene/player.hpp"
#include "support/files.hpp"

namespace corda {
namespace {

/// FNV-1a over the bytes of all positions at ten times of the first second.
std::uint64_t hash_motion(scene::Scene scene) {
    static_cast<void>(scene::settle_method(scene));
    scene::Run run(scene);
    std::uint64_t hash = 0xcbf29ce484222325U;
    const auto add = [&hash](double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        for (int byte = 0; byte < 8; ++byte) hash = (hash ^ ((bits >> (8 * byte)) & 0xffU)) * 0x100000001b3U;
    };
    for (int k = 0; k <= 10; ++k) {
        const sim::State& state = run.at(0.1 * k);
        for (const double x : state.x_m) add(x);
        for (const double y : state.y_m) add(y);
    }
    return hash;
}

const std::map<std::string, std::uint64_t> kHashes{
    {"bars as it is", 0x97ed1722ee4cadbdU},        {"bars by auto", 0x46a62ea64b2e7f06U},
    {"bars by exact", 0x4d3ab60de3166396U},        {"bars by rope", 0x95ccb33de6d29f69U},
    {"masses as it is", 0x7d17832e77db76e0U},      {"masses by auto", 0xce4c6724d15b3d74U},
    {"masses by exact", 0xfd33ea0213b9f911U},      {"masses by rope", 0xf41af9f302e09e3bU},
    {"palette as it is", 0x8da5d1c2106b55ffU},     {"palette by auto", 0x2b275bd1c87e8219U},
    {"palette by exact", 0xc3d58e5ffb0cb64cU},     {"palette by rope", 0x527f82a5b0852db7U},
    {"plain as it is", 0xaac79d67b35b7411U},       {"plain by auto", 0xaac79d67b35b7411U},
    {"plain by exact", 0x7a700d505453e863U},       {"plain by rope", 0x34b9172620c7642U},
    {"real_bars as it is", 0x367d6ac4e6d6f1ddU},   {"real_bars by auto", 0x16e5d8e6f37b9bdaU},
    {"real_bars by exact", 0x4d3ab60de3166396U},   {"real_bars by rope", 0x95ccb33de6d29f69U},
    {"report_rope as it is", 0xa90c661f6cf87ff8U}, {"report_rope by auto", 0x4080128fd6cb16e9U},
    {"report_rope by exact", 0x4ef6dbc3f8baace0U}, {"report_rope by rope", 0x8bf6e4cc42d3a9cbU},
    {"seven_ropes as it is", 0xede83f46e7d316a6U}, {"seven_ropes by auto", 0xede83f46e7d316a6U},
    {"seven_ropes by exact", 0xf04d137dc4931f7fU}, {"seven_ropes by rope", 0x4cc5529d87b82266U},
    {"sideways as it is", 0x7f51a5499a3bf453U},    {"sideways by auto", 0xb0f76a2f5ff4360eU},
    {"sideways by exact", 0x6b57edff39566874U},    {"sideways by rope", 0xc6f01f109f60ff9fU},
    {"thick as it is", 0x72a94d4d75b6c87dU},       {"thick by auto", 0x2958ab15a1952ba8U},
    {"thick by exact", 0x3de9f31fb2ec56ceU},       {"thick by rope", 0xd66e2397df728065U},
    {"thin as it is", 0xa7c70e04d0ecf3a7U},        {"thin by auto", 0xbac4bef37a326d44U},
    {"thin by exact", 0xa4e475745d5b6a4cU},        {"thin by rope", 0x28ccf777b9e8af76U},
    {"thrown as it is", 0x172be6ef8bcd5157U},      {"thrown by auto", 0x199b8cc04989c5ffU},
    {"thrown by exact", 0xdb3c611ad62528b8U},      {"thrown by rope", 0x752a64a5540a57d7U},
    {"two_pins as it is", 0x1f94bb8b89a86d5eU},    {"two_pins by auto", 0x56fda6b3b8687775U},
    {"two_pins by exact", 0x1cdeaeda70860245U},    {"two_pins by rope", 0x3d9c30f85d4e7045U},
};

class StateHash : public testing::TestWithParam<std::string> {};

TEST_P(StateHash, IsTheSameEverywhere) {
    const std::string name = test::test_name(GetParam());
    const scene::Scene own = scene::load_scene(GetParam(), {"world.duration=1.0"});
    std::map<std::string, scene::Scene> variants{{name + " as it is", own}};
    for (const sim::Method method : {sim::Method::kRope, sim::Method::kExact, sim::Method::kAuto}) {
        scene::Scene variant = own;
        variant.solver = sim::SolverDef{};
        variant.solver.method = method;
        variant.solver.reach = 1;
        variants.emplace(name + " by " + std::string(sim::method_name(method)), variant);
    }
    for (const auto& [label, scene] : variants) {
        const std::uint64_t hash = hash_motion(scene);
        EXPECT_EQ(hash, hash_motion(scene)) << label << ": two runs differ";
        const auto expected = kHashes.find(label);
        const bool same = expected != kHashes.end() && expected->second == hash;
        EXPECT_TRUE(same) << "    {\"" << label << "\", 0x" << std::hex << hash << "U},";
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, StateHash,
                         testing::ValuesIn(test::list_files(CORDA_GOLDENS "/scenes", ".toml")),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace corda
