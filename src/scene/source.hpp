#pragma once

#include <toml++/toml.h>

#include <span>
#include <string>
#include <string_view>

namespace corda::scene {

/// Text from a file as it may stand in a message: control characters escaped, the end cut off beyond
/// `longest` bytes.
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 60);

/// "a, b, c".
[[nodiscard]] std::string joined(std::span<const std::string_view> names);

/// What a node is, with its value where that is short: `"abc" is a string`, `this is a table`.
[[nodiscard]] std::string described(const toml::node& node);

/// Where the values of a scene come from: a file, and the settings that were put over it.
class Source {
  public:
    /// `document` is what `toml::parse` gave for the text named `name`.
    Source(std::string name, const toml::table& document)
        : name_(std::move(name)), document_path_(document.source().path) {}

    [[nodiscard]] const std::string& name() const { return name_; }

    /// "swing.toml:12:5", or the setting that the value came with.
    [[nodiscard]] std::string where(const toml::source_region& region) const;

    /// Throws kInvalidScene with "where: key: problem".
    [[noreturn]] void fail(const toml::source_region& region, std::string_view key,
                           std::string_view problem) const;

  private:
    std::string name_;
    toml::source_path_ptr document_path_;
};

}  // namespace corda::scene
