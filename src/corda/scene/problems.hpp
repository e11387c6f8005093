#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "corda/core/basics.hpp"

namespace corda::scene {

/// Text from a file as it may stand in a message: printable (see core/text.hpp), cut off after `longest`
/// bytes.
[[nodiscard]] std::string excerpt(std::string_view text, std::size_t longest = 60);

/// Description of a node, with its value if that is short: `"abc" is a string`, `this is a table`.
[[nodiscard]] std::string described(const toml::node& node);

/// The value of an integer or a number, rounded to the nearest double. Requires one of them.
[[nodiscard]] double number_of(const toml::node& node);

/// Whether a node is an integer that is written with a point: 3.0.
[[nodiscard]] bool is_whole(const toml::node& node);

/// The problems of a scene, collected over the whole file.
class Problems {
  public:
    /// For definitions, which have no place in a file: places name `source_name`, if there is one.
    explicit Problems(std::string source_name) : source_name_(std::move(source_name)), has_places_(false) {}
    /// `document` is what `toml::parse` returned for the text named `source_name`.
    Problems(std::string source_name, const toml::table& document)
        : source_name_(std::move(source_name)), document_path_(document.source().path) {}

    /// Adds a problem at `region`, which is in the file or in the setting that the value came with. Only the
    /// first problem of a key counts.
    void add(const toml::source_region& region, std::string_view key, std::string what,
             std::string remedy = "", std::string value = "");
    /// The same of a value.
    void add(const toml::node& value, std::string_view key, std::string what, std::string remedy = "");

    /// From now on, keys of rope i are those of rope `file_index[i]` of the file.
    void set_ropes(std::vector<std::size_t> file_index) { file_index_ = std::move(file_index); }

    /// Adds a problem of a setting that does not fit the document.
    void add_to_setting(Problem problem);

    /// Marks the key that a misspelt one stands for; the misspelt one has a problem already.
    void add_misspelt(std::string_view key) { unsound_.emplace(key); }

    /// True if neither `key` nor anything in it has a problem. A contradiction with an unsound value would
    /// only repeat its problem.
    [[nodiscard]] bool is_sound(std::string_view key) const { return !unsound_.contains(file_key(key)); }

    [[nodiscard]] Place place_of(const toml::source_region& region, std::string_view key) const;

    [[nodiscard]] bool empty() const { return problems_.empty(); }

    /// Throws one Error (kInvalidScene) with the first problems, one per line in the order of the file, then
    /// those of settings.
    void throw_if_any() const;

  private:
    struct Placed {
        std::tuple<bool, std::size_t, std::size_t> order;  ///< whether it is of a setting, line and column
        Problem problem;
    };

    [[nodiscard]] std::string file_key(std::string_view key) const;
    [[nodiscard]] bool is_setting(const toml::source_region& region) const {
        return region.path && region.path != document_path_;
    }

    std::vector<std::size_t> file_index_;
    std::string source_name_;
    bool has_places_ = true;
    toml::source_path_ptr document_path_;
    std::vector<Placed> problems_;
    std::size_t not_kept_ = 0;
    std::set<std::string, std::less<>> reported_;
    std::set<std::string, std::less<>> unsound_;
};

}  // namespace corda::scene
