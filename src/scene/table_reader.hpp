#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "corda/scene/value.hpp"

namespace corda::scene {

/// One table of a scene file, read key by key. The document must outlive it.
class TableReader {
  public:
    /// Refuses every key that `section` of the list of keys (keys.hpp) does not have. `path` is the table's
    /// dotted key in messages: section "rope", path "rope[0]".
    TableReader(const Source& source, const toml::table& table, std::string_view section, std::string path);

    /// The value of a key, which must be one of the section's; nothing where the file does not give it.
    [[nodiscard]] std::optional<Value> find(std::string_view key) const;
    [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }

    /// The value of a key that must be there; `remedy` ends the message where it is not.
    [[nodiscard]] Value require(std::string_view key, std::string_view remedy) const;

    /// The table of that key, an empty one where the file does not give it. `remedy` ends the message for a
    /// value that is no table.
    [[nodiscard]] TableReader table(std::string_view key, std::string_view remedy) const;

    /// Puts the value of a key into `target`, if the file gives it.
    void read_number(std::string_view key, double& target, const Range& range, std::string_view remedy) const;
    void read_number(std::string_view key, std::optional<double>& target, const Range& range,
                     std::string_view remedy) const;
    void read_integer(std::string_view key, int& target, int low, int high, std::string_view remedy) const;
    void read_color(std::string_view key, Color& target) const;

    [[nodiscard]] const Source& source() const { return *source_; }
    [[nodiscard]] std::string path_of(std::string_view key) const;

    /// Throws kInvalidScene with the place and the key of this table before `problem`.
    [[noreturn]] void fail(std::string_view problem) const;

  private:
    void refuse_unknown_keys() const;
    [[noreturn]] void fail_unknown_key(const toml::key& key) const;

    const Source* source_;
    const toml::table* table_;
    std::string_view section_;
    std::string path_;
};

}  // namespace corda::scene
