#pragma once

#include <string>

#include "corda/core/text.hpp"

namespace corda::report {

/// Makes every text in a value of nlohmann's JSON UTF-8 (see core/text.hpp), which is all that JSON can hold:
/// names of files can have any bytes.
template <typename Json>
void make_utf8(Json& json) {
    if (json.is_string()) json = utf8(json.template get_ref<const std::string&>());
    if (!json.is_structured()) return;
    for (Json& value : json) make_utf8(value);
}

}  // namespace corda::report
