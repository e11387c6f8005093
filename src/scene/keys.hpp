#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace corda::scene {

/// The type of a value. A choice is one word of a list; text is one line; a frame rate is an integer, or a
/// fraction as text.
enum class Kind { kTable, kTables, kBoolean, kInteger, kNumber, kChoice, kColor, kText, kFrameRate };

/// Whether a key takes one value, a pair, a list of values or a list of pairs; the sum of those it takes.
enum Form : unsigned { kOne = 1, kPair = 2, kList = 4, kPairs = 8 };

/// The numbers that are allowed; NaN and infinities never are.
struct Range {
    double low = std::numeric_limits<double>::lowest();
    double high = std::numeric_limits<double>::max();
    bool low_open = false;   ///< `low` itself is not allowed
    bool high_open = false;  ///< `high` itself is not allowed
};

/// What the value of a key may be.
struct Type {
    Kind kind = Kind::kNumber;
    unsigned forms = kOne;
    Range range = {};                            ///< of every number; of kFrameRate too
    std::vector<std::string_view> choices = {};  ///< the only values, in the order of their enum; empty: any
    std::string_view pair = {};                  ///< what a pair looks like
    std::string_view list = {};                  ///< what a list holds
    std::size_t least_entries = 0;               ///< of a list
};

/// What a key stands for if the file does not have it.
struct Default {
    std::string toml = {};        ///< as a file would write it; empty if it depends on something else
    std::string_view words = {};  ///< what it depends on
    bool required = false;        ///< there is none
};

/// One key of a scene file: what the reader checks, what messages advise and what the documentation says.
struct Key {
    std::string_view section;  ///< dotted name of the table that it belongs to; empty: the top level
    std::string_view name;     ///< unique in its section
    Type type;
    std::string_view unit;
    Default initial;
    std::string_view meaning;                    ///< completes "give ..."; of a table also an example
    std::string_view note = {};                  ///< what else to know
    std::vector<std::string_view> methods = {};  ///< that use it; empty: all
    std::string_view instead = {};               ///< advice for other methods
};

/// All keys of scene files, section by section. The reader knows no others.
[[nodiscard]] const std::vector<Key>& all_keys();

/// The key of that name; null if the section has none.
[[nodiscard]] const Key* find_key(std::string_view section, std::string_view name);

/// The key of the table, or the tables, that a section is; null for the top level.
[[nodiscard]] const Key* key_of_section(std::string_view section);

/// The names of the keys of one section.
[[nodiscard]] std::vector<std::string_view> keys_of(std::string_view section);

/// "world.drag", or `name` alone if `front` is empty.
[[nodiscard]] std::string dotted(std::string_view front, std::string_view name);

/// "rope[].mass": the key as messages and documentation name it.
[[nodiscard]] std::string path_of(const Key& key);

/// "number or [gx, gy]".
[[nodiscard]] std::string type_text(const Key& key);

/// "1e-12 .. 1e12", "> 0"; empty if every value of the type is allowed.
[[nodiscard]] std::string range_text(const Key& key);

/// "give the mass of a particle in kg, 1e-12 .. 1e12, or a list with one per particle".
[[nodiscard]] std::string remedy(const Key& key);

/// A number as short as possible: "1e-9", "0.08".
[[nodiscard]] std::string number_text(double value);

/// The list of keys for a terminal.
[[nodiscard]] std::string keys_text();

/// The list of keys as a Markdown table.
[[nodiscard]] std::string keys_markdown();

}  // namespace corda::scene
