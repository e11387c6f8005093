#include "corda/scene/document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <istream>
#include <streambuf>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"

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

[[noreturn]] void fail_at(const Place& place, const std::string& what, const std::string& remedy) {
    throw Error(ExitCode::kInvalidScene, Problem{place, what, remedy});
}

/// Text for the parser that can be cancelled at every block. The parser turns any exception into an error of
/// its own, so a cancellation ends the text, and check() throws it.
class CancellableBuffer : public std::streambuf {
  public:
    explicit CancellableBuffer(std::string_view text) : text_(text) { set_place(0); }

    void check() const {
        if (cancellation_) std::rethrow_exception(cancellation_);
    }

  protected:
    int_type underflow() override {
        constexpr std::size_t kBlock = 65536;
        if (cancellation_ || end_ == text_.size()) return traits_type::eof();
        try {
            check_cancelled();
        } catch (...) {
            cancellation_ = std::current_exception();
            return traits_type::eof();
        }
        const std::size_t begin = std::exchange(end_, std::min(end_ + kBlock, text_.size()));
        set_place(begin);
        return traits_type::to_int_type(text_[begin]);
    }

    /// The parser goes back to the beginning once it has looked for a byte order mark.
    pos_type seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode) override {
        const off_type place = from == std::ios_base::cur ? gptr() - eback() : 0;
        set_place(static_cast<std::size_t>(place + by));
        return place + by;
    }
    pos_type seekpos(pos_type place, std::ios_base::openmode which) override {
        return seekoff(place, std::ios_base::beg, which);
    }

  private:
    void set_place(std::size_t place) { setg(text_.data(), text_.data() + place, text_.data() + end_); }

    std::string text_;  // std::streambuf takes no pointer to const
    std::exception_ptr cancellation_;
    std::size_t end_ = 0;
};

Place place_of(std::string_view text, std::size_t at, const std::string& source_name) {
    const auto line = 1 + std::ranges::count(text.substr(0, at), '\n');
    const std::size_t line_end = text.substr(0, at).rfind('\n');
    std::size_t column = 1;
    for (std::size_t i = line_end == std::string_view::npos ? 0 : line_end + 1; i < at; ++i)
        column += is_continuation(text[i]) ? 0 : 1;
    return {source_name, static_cast<std::size_t>(line), column, ""};
}

/// The first character outside of strings and comments that `is_it` takes, as an offset; npos if there is
/// none.
template <class Is>
std::size_t find_bare(std::string_view text, const Is& is_it) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (is_it(i)) return i;
        if (text[i] == '#') i = std::min(text.find('\n', i), text.size());
        if (i < text.size() && (text[i] == '"' || text[i] == '\'')) i = skip_string(text, i) - 1;
    }
    return std::string_view::npos;
}

/// Refuses text of another encoding than UTF-8, which the parser would call a syntax error of its first byte.
void refuse_other_encodings(std::string_view text, const std::string& source_name) {
    const std::string_view start = text.substr(0, 4);
    const bool has_mark = start.starts_with("\xff\xfe") || start.starts_with("\xfe\xff");
    const bool has_zeros = start.size() >= 2 && (start[0] == '\0') != (start[1] == '\0');
    if (has_mark || has_zeros)
        fail_at({source_name, 1, 1, ""}, "the text is UTF-16", "save the file as UTF-8");
    const std::string sound = utf8(text);  // with "\\x.." in the place of other bytes
    std::size_t same = 0;
    while (same < text.size() && text[same] == sound[same]) ++same;
    if (same == text.size()) return;
    fail_at(place_of(text, same, source_name),
            fmt::format("the byte 0x{:02x} is not UTF-8 text", static_cast<unsigned char>(text[same])),
            "save the file as UTF-8");
}

/// The ASCII character that editors and web pages replace by this one, in words; empty for other characters.
std::string_view meant_by(char32_t code) {
    if (code == 0x2212 || (code >= 0x2010 && code <= 0x2015)) return "\"-\"";
    if (code == 0x00ab || code == 0x00bb || (code >= 0x201c && code <= 0x201f)) return "'\"'";
    if ((code >= 0x2018 && code <= 0x201b) || code == 0x00b4) return "\"'\"";
    if (code == 0x00a0 || code == 0x202f || code == 0xfeff || (code >= 0x2000 && code <= 0x200d))
        return "a space";
    if (code == 0xff0c) return "\",\"";
    if (code == 0xff1d) return "\"=\"";
    return {};
}

/// Better words for a syntax error in the last line of a text: a quote or a brace that is missing.
void explain_line(std::string_view text, const std::string& source_name) {
    const std::size_t begin = text.find_last_of('\n', text.size() - 2) + 1;  // npos + 1 is 0
    const std::string_view line = text.substr(begin, text.find_last_not_of("\r\n") + 1 - begin);
    const std::size_t equals = line.find('=');
    const std::size_t value =
        line.find_first_not_of(" \t", equals == std::string_view::npos ? equals : equals + 1);
    std::vector<std::size_t> open;  // braces
    static_cast<void>(find_bare(text, [&](std::size_t i) {
        if (text[i] == '{') open.push_back(i);
        if (text[i] == '}' && !open.empty()) open.pop_back();
        return false;
    }));
    if (value == std::string_view::npos) return;
    if (line[value] == '"' && std::ranges::count(line, '"') == 1)
        fail_at(place_of(text, begin + value, source_name), "a text has no closing quote", "end it with \"");
    if (!open.empty())
        fail_at(place_of(text, open.back(), source_name), "a table in braces has no end in its own line",
                "write it on one line, or as a table [...] with a line for each key");
    std::string word(line.substr(value, line.find_first_of(",#]}", value) - value));
    word.erase(word.find_last_not_of(" \t") + 1);
    if (word.empty()) return;
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const std::size_t unit = word.find_first_not_of("0123456789+-.eE_");
    std::string remedy;
    if (lower(word) == "true" || lower(word) == "false")
        remedy = "write true or false, in small letters";
    else if (is_letter(word.front()))
        remedy = "put text in quotes";
    else if (unit != std::string::npos && unit > 0 && word.find_first_of("\"'[{") == std::string::npos)
        remedy = "write a number without its unit, or text in quotes";
    if (!remedy.empty())
        fail_at(place_of(text, begin + value, source_name), excerpt(word) + " is no value", remedy);
}

/// Better words for a syntax error, of which the parser only knows the place, up to the end of its line.
void explain_syntax(std::string_view text, std::size_t line, const std::string& source_name) {
    std::size_t end = 0;
    for (std::size_t i = 0; i < line && end < text.size(); ++i)
        end = std::min(text.find('\n', end), text.size() - 1) + 1;
    text = text.substr(0, end);
    constexpr unsigned char kLastAscii = 0x7f;
    const bool has_mark = text.starts_with("\xef\xbb\xbf");
    const std::size_t foreign = find_bare(text, [&](std::size_t i) {
        return static_cast<unsigned char>(text[i]) > kLastAscii && !(has_mark && i < 3);
    });
    if (foreign != std::string_view::npos) {
        std::size_t length = 1;
        while (foreign + length < text.size() && is_continuation(text[foreign + length])) ++length;
        char32_t code = static_cast<unsigned char>(text[foreign]) & (0xffU >> (length + 1));
        for (std::size_t i = 1; i < length; ++i)
            code = (code << 6U) | (static_cast<unsigned char>(text[foreign + i]) & 0x3fU);
        const std::string_view meant = meant_by(code);
        fail_at(place_of(text, foreign, source_name),
                fmt::format("the character U+{:04X} ({}) has no meaning outside of quotes",
                            static_cast<std::uint32_t>(code), printable(text.substr(foreign, length))),
                meant.empty() ? "put text in quotes" : fmt::format("write {}", meant));
    }
    // key = 1,5
    const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    const std::size_t comma = find_bare(text, [&](std::size_t i) {
        if (text[i] != ',' || i == 0 || !is_digit(i - 1) || !is_digit(i + 1)) return false;
        const std::size_t begin = text.find_last_not_of("0123456789+-", i - 1);
        const std::size_t equals =
            begin == std::string_view::npos ? begin : text.find_last_not_of(" \t", begin);
        return equals != std::string_view::npos && text[equals] == '=';
    });
    if (comma == std::string_view::npos) return explain_line(text, source_name);
    const std::size_t first = text.find_last_not_of("0123456789+-", comma - 1) + 1;
    std::string number(text.substr(first, text.find_first_not_of("0123456789", comma + 1) - first));
    const std::string given = number;
    number[comma - first] = '.';
    fail_at(place_of(text, first, source_name),
            fmt::format("\"{}\" is no number: decimals need a point", given),
            fmt::format("write {}", number));
}

}  // namespace

void check_file_bytes(const std::string& source_name, std::size_t bytes) {
    if (bytes <= static_cast<std::size_t>(Limits::kFileBytes)) return;
    throw Error(
        ExitCode::kInvalidScene,
        Problem{{.source = source_name, .key = {}},
                fmt::format("{} bytes or more are over the limit of {} bytes", bytes, Limits::kFileBytes),
                "a scene has fewer particles"});
}

std::size_t find_deep_key(std::string_view text) {
    constexpr std::string_view kEndsOfKeys = "\n,=[]{}";
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
            default:
                if (kEndsOfKeys.find(text[i]) != std::string_view::npos) dots = 0;
        }
        ++i;
    }
    return std::string_view::npos;
}

toml::table parse_document(std::string_view text, const std::string& source_name) {
    check_file_bytes(source_name, text.size());
    const std::size_t deep = find_deep_key(text);
    if (deep != std::string_view::npos)
        fail_at(place_of(text, deep, source_name), fmt::format("a key of more than {} parts", kKeyParts),
                "give a key of the scene format");
    CancellableBuffer buffer(text);
    std::istream stream(&buffer);
    try {
        toml::table document = toml::parse(stream, std::string_view(source_name));
        buffer.check();
        return document;
    } catch (const toml::parse_error& error) {
        buffer.check();
        const auto& begin = error.source().begin;
        refuse_other_encodings(text, source_name);
        explain_syntax(text, begin.line, source_name);
        fail_at({source_name, begin.line, begin.column, ""}, std::string(error.description()),
                "see https://toml.io for the syntax");
    }
}

}  // namespace corda::scene
