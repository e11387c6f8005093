#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"

namespace corda::view {

/// A text of a picture or a report in another language. `english`: words of the table in words.cpp, also
/// before a unit in brackets or an index, as in "tension (kN)" and "rope 3". Other texts are returned as they
/// are.
[[nodiscard]] std::string translated(std::string_view english, Language language);

[[nodiscard]] constexpr char decimal_sign(Language language) {
    return language == Language::kEnglish ? '.' : ',';
}

/// A text of numbers with the decimal sign of a language: "0,25".
[[nodiscard]] std::string localized(std::string numbers, Language language);

/// The label of a rope or net, or what body_name() calls it, in a language.
[[nodiscard]] std::string translated_name(const System& system, std::size_t body, Language language);

}  // namespace corda::view
