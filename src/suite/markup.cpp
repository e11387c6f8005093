#include "corda/suite/markup.hpp"

#include "corda/core/text.hpp"

namespace corda::suite {

std::string markup_text(const std::string& text) {
    std::string markup;
    for (const char c : printable(text)) {
        switch (c) {
            case '&':
                markup += "&amp;";
                break;
            case '<':
                markup += "&lt;";
                break;
            case '>':
                markup += "&gt;";
                break;
            case '"':
                markup += "&quot;";
                break;
            default:
                markup += c;
        }
    }
    return markup;
}

}  // namespace corda::suite
