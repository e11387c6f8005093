#include "corda/scene/document.hpp"

#include <algorithm>
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
    if (deep != std::string_view::npos) {
        const auto line =
            1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(deep), '\n');
        const std::size_t line_end = text.substr(0, deep).rfind('\n');
        const std::size_t column = line_end == std::string_view::npos ? deep + 1 : deep - line_end;
        fail_at({source_name, static_cast<std::size_t>(line), column, ""},
                fmt::format("a key of more than {} parts", kKeyParts), "give a key of the scene format");
    }
    CancellableBuffer buffer(text);
    std::istream stream(&buffer);
    try {
        toml::table document = toml::parse(stream, std::string_view(source_name));
        buffer.check();
        return document;
    } catch (const toml::parse_error& error) {
        buffer.check();
        const auto& begin = error.source().begin;
        fail_at({source_name, begin.line, begin.column, ""}, std::string(error.description()),
                "see https://toml.io for the syntax");
    }
}

}  // namespace corda::scene
