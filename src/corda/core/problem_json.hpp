#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"

namespace corda {

/// Problems as results with --json give them: a list of objects, printable.
[[nodiscard]] inline nlohmann::json problems_json(const std::vector<Problem>& problems) {
    nlohmann::json list = nlohmann::json::array();
    for (const auto& [place, what, remedy, value] : problems)
        list.push_back({{"source", printable(place.source)},
                        {"line", place.line},
                        {"column", place.column},
                        {"key", printable(place.key)},
                        {"value", printable(value)},
                        {"what", printable_lines(what)},
                        {"remedy", printable_lines(remedy)}});
    return list;
}

}  // namespace corda
