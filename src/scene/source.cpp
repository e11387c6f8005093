#include "corda/scene/source.hpp"

#include <fmt/format.h>

#include "corda/core/error.hpp"

namespace corda::scene {
namespace {

bool is_continuation(char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U;
}

}  // namespace

std::string printable(std::string_view text, std::size_t longest) {
    std::size_t length = std::min(text.size(), longest);
    while (length < text.size() && length > 0 && is_continuation(text[length])) --length;
    std::string result;
    for (const char c : text.substr(0, length)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f) {
            result += fmt::format("\\x{:02x}", byte);
        } else {
            result += c;
        }
    }
    if (length < text.size()) result += "...";
    return result;
}

std::string joined(std::span<const std::string_view> names) {
    return fmt::format("{}", fmt::join(names.begin(), names.end(), ", "));
}

std::string described(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::table:
            return "this is a table";
        case toml::node_type::array:
            return fmt::format("this is a list of {}", node.as_array()->size());
        case toml::node_type::string:
            return fmt::format("\"{}\" is a string", printable(node.as_string()->get()));
        case toml::node_type::integer:
            return fmt::format("{} is an integer", node.as_integer()->get());
        case toml::node_type::floating_point:
            return fmt::format("{} is a number with a fraction", node.as_floating_point()->get());
        case toml::node_type::boolean:
            return fmt::format("{} is a boolean", node.as_boolean()->get());
        default:
            return "this is a date or a time";
    }
}

std::string Source::where(const toml::source_region& region) const {
    if (!region.path) return name_ + ":1:1";
    if (region.path != document_path_) return *region.path;
    return fmt::format("{}:{}:{}", name_, region.begin.line, region.begin.column);
}

void Source::fail(const toml::source_region& region, std::string_view key, std::string_view problem) const {
    throw Error(ExitCode::kInvalidScene, fmt::format("{}: {}: {}", where(region), key, problem));
}

}  // namespace corda::scene
