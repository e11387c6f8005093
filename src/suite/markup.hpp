#pragma once

#include <string>

namespace corda::suite {

/// Any bytes as a text or an attribute value of XML and HTML.
[[nodiscard]] std::string markup_text(const std::string& text);

}  // namespace corda::suite
