// The same scene gives the same bytes of state on every run, compiler and CPU: a hash of each golden scene's
// motion, by every method that can run it. A hash that changes means that pictures and videos of old scenes
// change: say why in the commit.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <string>

#include "corda/core/basics.hpp"
#include "corda/film/film.hpp"
#include "support/files.hpp"

namespace corda {
namespace {

/// FNV-1a over the bytes of all positions at ten times of the first second.
std::uint64_t hash_motion(const Scene& scene) {
    Film film(scene);
    std::uint64_t hash = 0xcbf29ce484222325U;
    const auto add = [&hash](double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        for (int byte = 0; byte < 8; ++byte) hash = (hash ^ ((bits >> (8 * byte)) & 0xffU)) * 0x100000001b3U;
    };
    for (int k = 0; k <= 10; ++k) {
        const State& state = film.state_at(0.1 * k);
        for (const double x : state.x_m) add(x);
        for (const double y : state.y_m) add(y);
    }
    return hash;
}

const std::map<std::string, std::uint64_t> kHashes{
    {"arrows as it is", 0x57a99d2710db07ecU},
    {"arrows by auto", 0x57a99d2710db07ecU},
    {"arrows by exact", 0x29e76fa846334d75U},
    {"arrows by rattle", 0x325bc3077361c40U},
    {"arrows_paper as it is", 0xd6adddd37524f7afU},
    {"arrows_paper by auto", 0xd6adddd37524f7afU},
    {"arrows_paper by exact", 0x58cb9687226960a0U},
    {"arrows_paper by rattle", 0x4914df69e161ebfeU},
    {"bars as it is", 0x97ed1722ee4cadbdU},
    {"bars by auto", 0x4bfac20ec77af926U},
    {"bars by exact", 0xf72b0842ee91b200U},
    {"bars by rattle", 0xc76c0f2c810844ebU},
    {"masses as it is", 0x7d17832e77db76e0U},
    {"masses by auto", 0xb17f61940caf0a4eU},
    {"masses by exact", 0x788a6d0351d27fbaU},
    {"masses by rattle", 0x59067ceab797f2ccU},
    {"palette as it is", 0x8da5d1c2106b55ffU},
    {"palette by auto", 0xefe8e7d78f863d1fU},
    {"palette by exact", 0xa7adae293de3933aU},
    {"palette by rattle", 0x365bdd6f14d669c9U},
    {"plain as it is", 0x8d7798cc2f506f91U},
    {"plain by auto", 0x8d7798cc2f506f91U},
    {"plain by exact", 0x385fb0d9a6c8d7c6U},
    {"plain by rattle", 0xcb16926a57e7d782U},
    {"real_bars as it is", 0x367d6ac4e6d6f1ddU},
    {"real_bars by auto", 0x4bfac20ec77af926U},
    {"real_bars by exact", 0xf72b0842ee91b200U},
    {"real_bars by rattle", 0xc76c0f2c810844ebU},
    {"report_rope as it is", 0xa90c661f6cf87ff8U},
    {"report_rope by auto", 0xeb6e290c34c9cb04U},
    {"report_rope by exact", 0x223cc4a1d1791eaaU},
    {"report_rope by rattle", 0x58a26f490bd986a8U},
    {"seven_ropes as it is", 0xee9851ca68a7f6d2U},
    {"seven_ropes by auto", 0xee9851ca68a7f6d2U},
    {"seven_ropes by exact", 0x25a132fb49303441U},
    {"seven_ropes by rattle", 0xfe66182a451090b2U},
    {"sideways as it is", 0x7f51a5499a3bf453U},
    {"sideways by auto", 0xe98475339a0cce5fU},
    {"sideways by exact", 0x4df472ce233d6d8dU},
    {"sideways by rattle", 0xb612abf69447708cU},
    {"thick as it is", 0x72a94d4d75b6c87dU},
    {"thick by auto", 0xa321e20c10269befU},
    {"thick by exact", 0x4c46ac67351f4ebfU},
    {"thick by rattle", 0x9cd02a008bce108U},
    {"thin as it is", 0xa7c70e04d0ecf3a7U},
    {"thin by auto", 0x19b86fa1a7eacca6U},
    {"thin by exact", 0xff972532def7aa14U},
    {"thin by rattle", 0x33eaf691d2617ad4U},
    {"thrown as it is", 0x172be6ef8bcd5157U},
    {"thrown by auto", 0xee9becea749ff89dU},
    {"thrown by exact", 0x51161644826d49d7U},
    {"thrown by rattle", 0x442ce901002386c7U},
    {"two_pins as it is", 0x1f94bb8b89a86d5eU},
    {"two_pins by auto", 0x1d330a611bb3999aU},
    {"two_pins by exact", 0x3f0a4dddbac9cc4bU},
    {"two_pins by rattle", 0x8f2ca1460c15c3f0U},
    {"cloth as it is", 0xc9eb6e5dda7a5613U},
    {"ring as it is", 0xf4f856eae4705054U},
    {"ring by rattle", 0xfef6838fc70e36f3U},
    {"ring by auto", 0x1817a7dadc7e4311U},
    {"cloth by rattle", 0x31a05d1a062a6728U},
    {"cloth by auto", 0x5da7ea555fc4a419U},
    {"materials as it is", 0x9b63a0511d01c9aaU},
    {"materials by auto", 0x9b63a0511d01c9aaU},
    {"materials by exact", 0xcd7ac8f61e43d823U},
    {"bare as it is", 0x37d425a52f3be44eU},
    {"bare by auto", 0x37d425a52f3be44eU},
    {"bare by rattle", 0x7f68a9262939bc7aU},
    {"paper as it is", 0x566355ed19aa7d19U},
    {"paper by auto", 0x802ed29079ae19a0U},
    {"paper by rattle", 0x87cf9cba05dd20c0U},
    {"pendulums as it is", 0x5a1d32230bf0c263U},
    {"pendulums by auto", 0x5a1d32230bf0c263U},
    {"pendulums by exact", 0x5c98b7c12179b864U},
    {"pendulums by rattle", 0xfd6fe7fd266fe4c3U},
    {"slack as it is", 0x01963fc93f43e408U},
    {"slack by auto", 0x01963fc93f43e408U},
    {"slack by exact", 0x8d96cf8bec8989e9U},
    {"plot_energy as it is", 0x44ee9e2eb5ed165bU},
    {"plot_energy by auto", 0x44ee9e2eb5ed165bU},
    {"plot_energy by exact", 0x70bb4f75090f2043U},
    {"plot_energy by rattle", 0xbcbc8e9286e564fbU},
    {"plot_phase_paper as it is", 0x44ee9e2eb5ed165bU},
    {"plot_phase_paper by auto", 0x44ee9e2eb5ed165bU},
    {"plot_phase_paper by exact", 0x70bb4f75090f2043U},
    {"plot_phase_paper by rattle", 0xbcbc8e9286e564fbU},
    {"plot_tip as it is", 0x44ee9e2eb5ed165bU},
    {"plot_tip by auto", 0x44ee9e2eb5ed165bU},
    {"plot_tip by exact", 0x70bb4f75090f2043U},
    {"plot_tip by rattle", 0xbcbc8e9286e564fbU},
    {"plots as it is", 0x1f0da781aaa267cdU},
    {"plots by auto", 0x1f0da781aaa267cdU},
    {"plots by exact", 0xcd079d1c5554a555U},
    {"plots by rattle", 0x26947f4078128fedU},
    {"events as it is", 0x19ee5fdc17d53035U},
    {"events by auto", 0x19ee5fdc17d53035U},
    {"events by rattle", 0x767f98ac15cd1418U},
    {"moves as it is", 0xb3f00cbbee92431bU},
    {"moves by auto", 0xb3f00cbbee92431bU},
    {"moves by rattle", 0x7d689fd84155f7ddU},
    {"overlay as it is", 0x8d7798cc2f506f91U},
    {"overlay by auto", 0x8d7798cc2f506f91U},
    {"overlay by exact", 0x385fb0d9a6c8d7c6U},
    {"overlay by rattle", 0xcb16926a57e7d782U},
    {"overlay_paper as it is", 0x8d7798cc2f506f91U},
    {"overlay_paper by auto", 0x8d7798cc2f506f91U},
    {"overlay_paper by exact", 0x385fb0d9a6c8d7c6U},
    {"overlay_paper by rattle", 0xcb16926a57e7d782U},
    {"trail as it is", 0xea7b0f8d4953d435U},
    {"trail by auto", 0xea7b0f8d4953d435U},
    {"trail by exact", 0x82d4b0c816d6a129U},
    {"trail by rattle", 0x621d8a953fb68c77U},
    {"transparent as it is", 0xbb47ec42b6305c98U},
    {"transparent by auto", 0x8757cbaeb1165bceU},
    {"transparent by exact", 0x10ee5ae2a33a517fU},
    {"transparent by rattle", 0xc325a0e8ccd851d9U},
    {"links as it is", 0xe3feb45dddb76030U},
    {"links by auto", 0xe3feb45dddb76030U},
    {"links by exact", 0x517bc89cffd9afbaU},
    {"links by rattle", 0xbcfe08ce3dfbe888U},
    {"speed as it is", 0x9bc76ccdcde4ecc8U},
    {"speed by auto", 0x9bc76ccdcde4ecc8U},
    {"speed by exact", 0x7fee48a6a55f033U},
    {"speed by rattle", 0xcc201cc866cd0609U},
    {"speed_paper as it is", 0xcb14ea3567eab4a6U},
    {"speed_paper by auto", 0x82f09089513f602U},
    {"speed_paper by exact", 0x49904fc855d68baeU},
    {"speed_paper by rattle", 0xd1102938b1eeeef1U},
    {"strain as it is", 0x8335e4817e6e7075U},
    {"strain by auto", 0x8335e4817e6e7075U},
    {"strain by exact", 0xdb87c689ce98df76U},
    {"strain by rattle", 0x4982bae4148ba258U},
    {"strain_paper as it is", 0x8335e4817e6e7075U},
    {"strain_paper by auto", 0x8335e4817e6e7075U},
    {"strain_paper by exact", 0xdb87c689ce98df76U},
    {"strain_paper by rattle", 0x4982bae4148ba258U},
    {"tension as it is", 0xc83318f7ff211625U},
    {"tension by auto", 0xc83318f7ff211625U},
    {"tension by exact", 0x87bd41d4e85ce5a1U},
    {"tension_paper as it is", 0x8cdeaefe2aac27ebU},
    {"tension_paper by auto", 0x8cdeaefe2aac27ebU},
    {"tension_paper by rattle", 0xec0815148a4a0b5fU},
    {"links_paper as it is", 0x3d090f6a4bc0ce4dU},
    {"links_paper by auto", 0x3d090f6a4bc0ce4dU},
    {"links_paper by exact", 0xb5d799fb09ac8ff5U},
    {"links_paper by rattle", 0x8dabf094d4cf3280U},
    {"blur as it is", 0xb476d7a90b0ca2f1U},
    {"blur by auto", 0xb476d7a90b0ca2f1U},
    {"blur by exact", 0x6288bb0e7bcfe44dU},
    {"blur by rattle", 0x0ee66cd62ce89535U},
    {"blur_clear as it is", 0x4cb9e163ad3e968bU},
    {"blur_clear by auto", 0x4cb9e163ad3e968bU},
    {"blur_clear by exact", 0x3558fb47c0b166a3U},
    {"blur_clear by rattle", 0x2d329ad4f18fbb0cU},
    {"copies as it is", 0xf9dad5951e6e13a3U},
    {"copies by auto", 0xf9dad5951e6e13a3U},
    {"copies by exact", 0xdf44676985f3caf3U},
    {"copies by rattle", 0x629da51fbe1e1e2dU},
    {"follow as it is", 0x3c6d0414a46f557dU},
    {"follow by auto", 0x3c6d0414a46f557dU},
    {"follow by exact", 0x2c032e1cf6540eefU},
    {"follow by rattle", 0xbc1e4f78cfb488abU},
    {"labels as it is", 0xa4b084df9bf2061aU},
    {"labels by auto", 0xa4b084df9bf2061aU},
    {"labels by exact", 0xa2ecb72cb0fa38ccU},
    {"labels by rattle", 0x6d54c6289a331a49U},
    {"400 links by implicit steps", 0x96c7fc170315b67dU},
    {"400 links that stretch by implicit steps", 0x1d049a38d87bed5cU},
    {"400 links by auto", 0x96c7fc170315b67dU},
};

/// Scenes that a method refuses, with a part of the message.
const std::map<std::string, std::string> kRefused{
    {"materials by rattle", "use method auto"},  // its string
    {"slack by rattle", "use method auto"},
    {"tension by rattle", "use method auto"},
};

/// The methods that a scene is run by besides its own: all of them where its bodies are chains.
std::vector<SolverDef> other_methods(const Scene& scene) {
    const bool chains = scene.nets.empty() && std::none_of(scene.ropes.begin(), scene.ropes.end(),
                                                           [](const RopeDef& rope) { return rope.closed; });
    if (!chains) return {RattleDef{}, AutoDef{}};
    return {RattleDef{}, ExactDef{}, AutoDef{}};
}

void expect_refusal(const Scene& scene, const std::string& label, const std::string& reason) {
    try {
        static_cast<void>(hash_motion(scene));
        ADD_FAILURE() << label << " runs: give it a hash";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kInvalidScene) << label;
        EXPECT_THAT(error.what(), testing::HasSubstr(reason)) << label;
    }
}

void expect_hash(const Scene& scene, const std::string& label) {
    const std::uint64_t hash = hash_motion(scene);
    EXPECT_EQ(hash, hash_motion(scene)) << label << ": two runs differ";
    const auto expected = kHashes.find(label);
    const bool same = expected != kHashes.end() && expected->second == hash;
    EXPECT_TRUE(same) << "    {\"" << label << "\", 0x" << std::hex << hash << "U},";
}

class StateHash : public testing::TestWithParam<std::string> {};

TEST_P(StateHash, IsTheSameEverywhere) {
    const std::string name = test::test_name(GetParam());
    const Scene own = load_scene(GetParam(), {"world.duration=1.0"});
    std::map<std::string, Scene> variants{{name + " as it is", own}};
    for (const SolverDef& solver : other_methods(own)) {
        Scene variant = own;
        variant.solver = solver;
        for (RopeDef& rope : variant.ropes) rope.reach = 1;
        variants.emplace(name + " by " + std::string(solver_name(solver)), variant);
    }
    for (const auto& [label, scene] : variants) {
        if (const auto refused = kRefused.find(label); refused != kRefused.end()) {
            expect_refusal(scene, label, refused->second);
        } else {
            expect_hash(scene, label);
        }
    }
}

TEST(StateHashOfALongRope, IsTheSameEverywhere) {
    Scene scene = parse_scene(
        "schema = 1\nworld.duration = 1.0\n[[rope]]\nhang = { links = 400, length = 1.0, angle_deg = 30.0 "
        "}\n",
        "long.toml");
    expect_hash(scene, "400 links by auto");
    scene.solver = ExactDef{1e-4, true};
    expect_hash(scene, "400 links by implicit steps");
    scene.ropes.front().material.compliance_1_n = 1e-7;
    expect_hash(scene, "400 links that stretch by implicit steps");
}

INSTANTIATE_TEST_SUITE_P(Scenes, StateHash,
                         testing::ValuesIn(test::list_files(CORDA_GOLDENS "/scenes", ".toml")),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace corda
