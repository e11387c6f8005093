#include "corda/scene/document.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "corda/core/basics.hpp"
#include "corda/scene/read_file.hpp"

namespace corda::scene {
namespace {

/// The end of the string that opens at `begin`, past its closing quote or at the end of its line.
std::size_t skip_string(std::string_view text, std::size_t begin) {
    const char quote = text[begin];
    const std::string three(3, quote);
    const bool multi_line = text.substr(begin, 3) == three;
    std::size_t i = begin + (multi_line ? 3 : 1);
    while (i < text.size()) {
        if (text[i] == '\\' && quote == '"') {
            i += 2;
        } else if (multi_line && text.substr(i, 3) == three) {
            return i + 3;
        } else if (!multi_line && (text[i] == quote || text[i] == '\n')) {
            return i + 1;
        } else {
            ++i;
        }
    }
    return text.size();
}

}  // namespace

std::size_t find_deep_key(std::string_view text) {
    int dots = 0;
    std::size_t i = 0;
    while (i < text.size()) {
        switch (text[i]) {
            case '#':
                i = std::min(text.find('\n', i), text.size());
                continue;
            case '"':
            case '\'':
                i = skip_string(text, i);
                continue;
            case '.':
                if (++dots >= kKeyParts) return i;
                break;
            case '\n':
            case ',':
            case '=':
            case '[':
            case ']':
            case '{':
            case '}':
                dots = 0;
                break;
            default:
                break;
        }
        ++i;
    }
    return std::string_view::npos;
}

toml::table parse_document(std::string_view text, const std::string& source_name) {
    check_file_bytes(source_name, text.size());
    const std::size_t deep = find_deep_key(text);
    if (deep != std::string_view::npos) {
        const auto line =
            1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(deep), '\n');
        const std::size_t line_end = text.substr(0, deep).rfind('\n');
        const std::size_t column = line_end == std::string_view::npos ? deep + 1 : deep - line_end;
        throw Error(ExitCode::kInvalidScene,
                    fmt::format("{}:{}:{}: a key of more than {} parts; no key of a scene has that many",
                                source_name, line, column, kKeyParts));
    }
    try {
        return toml::parse(text, std::string_view(source_name));
    } catch (const toml::parse_error& error) {
        const auto& begin = error.source().begin;
        throw Error(ExitCode::kInvalidScene,
                    fmt::format("{}:{}:{}: {}; see https://toml.io for the syntax", source_name, begin.line,
                                begin.column, error.description()));
    }
}

}  // namespace corda::scene
