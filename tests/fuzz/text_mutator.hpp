#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <string>
#include <string_view>

namespace corda::test {

/// Parts of TOML, and extreme numbers first.
inline constexpr std::array<std::string_view, 39> kTokens{"9223372036854775807",
                                                          "-9223372036854775808",
                                                          "1e308",
                                                          "-1e308",
                                                          "1e-320",
                                                          "nan",
                                                          "-inf",
                                                          "0",
                                                          "-0.0",
                                                          "-1",
                                                          "1000000",
                                                          "999999999999",
                                                          "0x7fffffff",
                                                          "[",
                                                          "]",
                                                          "{",
                                                          "}",
                                                          "[[",
                                                          "]]",
                                                          "=",
                                                          ",",
                                                          ".",
                                                          "\"",
                                                          "'",
                                                          "\"\"\"",
                                                          "#",
                                                          "\n",
                                                          "\r\n",
                                                          "\\u0000",
                                                          "true",
                                                          "1979-05-27T07:32:00Z",
                                                          "[rope]",
                                                          "[[rope]]\n",
                                                          "[[net]]\n",
                                                          "false",
                                                          "[0, 1], ",
                                                          "a.b.c",
                                                          "\xff\xfe",
                                                          "\xf0\x9f\x98\x80"};

/// std::mt19937 is the same everywhere; the standard distributions are not.
class TextMutator {
  public:
    explicit TextMutator(std::uint32_t seed) : random_(seed) {}

    /// A copy of one of the texts with a few changes.
    std::string broken(std::span<const std::string_view> texts) {
        std::string text(texts[below(texts.size())]);
        const std::size_t count = 1 + below(4);
        for (std::size_t i = 0; i < count; ++i) mutate(text);
        return text;
    }

  private:
    std::size_t below(std::size_t count) { return random_() % count; }

    void mutate(std::string& text) {
        if (text.empty()) return;
        const std::size_t at = below(text.size());
        switch (below(6)) {
            case 0:
                text[at] = static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1U << below(8)));
                break;
            case 1:
                text.erase(at, 1 + below(12));
                break;
            case 2:
                text.insert(at, kTokens[below(kTokens.size())]);
                break;
            case 3:
                replace_number(text, at);
                break;
            case 4:
                text.insert(at, text.substr(below(text.size()), 1 + below(60)));
                break;
            default:
                text.resize(at);
                break;
        }
    }

    /// Replaces the next number after `at` by an extreme one.
    void replace_number(std::string& text, std::size_t at) {
        constexpr std::size_t kNumbers = 13;  // the first of kTokens
        const std::size_t begin = text.find_first_of("0123456789", at);
        if (begin == std::string::npos) return;
        const std::size_t end = std::min(text.find_first_not_of("0123456789.e-", begin), text.size());
        text.replace(begin, end - begin, kTokens[below(kNumbers)]);
    }

    std::mt19937 random_;
};

}  // namespace corda::test
