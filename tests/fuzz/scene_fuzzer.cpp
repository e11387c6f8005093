// libFuzzer entry: clang++ -fsanitize=fuzzer,address,undefined. Any bytes give a scene or a corda::Error.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "corda/core/basics.hpp"
#include "corda/scene/scene.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
        const std::string_view toml(reinterpret_cast<const char*>(data), size);
        static_cast<void>(corda::parse_scene(toml, "fuzz.toml"));
    } catch (const corda::Error&) {
        return 0;
    }
    return 0;
}
