#include "corda/scene/keys.hpp"

namespace corda::scene {

std::vector<std::string_view> keys_of(std::string_view section) {
    std::vector<std::string_view> names;
    for (const KeyText& key : kKeys) {
        if (key.section == section) names.push_back(key.name);
    }
    return names;
}

}  // namespace corda::scene
