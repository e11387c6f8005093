#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <vector>

namespace corda::scene {

class Value;
struct Key;

/// Limits of a scene, checked before any memory is taken.
struct Limits {
    static constexpr std::int64_t kFileBytes = 16 << 20;
    static constexpr std::size_t kTextBytes = 1000;  // of a title
    static constexpr std::int64_t kParticles = 1'000'000;
    static constexpr std::int64_t kBars = 20'000'000;
    static constexpr std::int64_t kFactoredParticles = 500'000;  // of a net; some 6 GB
    static constexpr double kTrailPoints = 2e7;                  // of all trails; up to 5 GB
    static constexpr std::int64_t kFrames = 10'000'000;
    static constexpr std::int64_t kSteps = 1'000'000'000;
    static constexpr double kBarUpdates = 1e13;  // about a day
    static constexpr double kCoordinateMetres = 1e9;
};

/// The type of a value. A choice is one word of a list; text is one line; a fraction is a number of up to
/// three decimals, or text.
enum class Kind { kTable, kTables, kBoolean, kInteger, kNumber, kChoice, kColor, kText, kFraction };

/// The forms of a value: one value, a pair, a list of values, a list of pairs. A key may allow several.
enum Form : unsigned { kOne = 1, kPair = 2, kList = 4, kPairs = 8 };

/// The allowed numbers; NaN and infinities never are.
struct Range {
    double low = std::numeric_limits<double>::lowest();
    double high = std::numeric_limits<double>::max();
    bool low_open = false;   ///< `low` itself is not allowed
    bool high_open = false;  ///< `high` itself is not allowed
};

/// The allowed values of a key.
struct Type {
    Kind kind = Kind::kNumber;
    unsigned forms = kOne;
    Range range = {};                            ///< of every number; of kFraction too
    std::vector<std::string_view> choices = {};  ///< the only values, in the order of their enum; empty: any
    std::vector<std::string_view> names = {};    ///< words that stand for values of another kind
    std::string_view pair = {};                  ///< the form of a pair, e.g. "[x, y]"
    std::string_view list = {};                  ///< the entries of a list
    std::size_t min_entries = 0;                 ///< of a list
};

/// The value that a key has if the file does not give it.
struct Default {
    std::string toml = {};        ///< as a file would give it; empty if it depends on something else
    std::string_view words = {};  ///< description of that
    bool required = false;        ///< there is no default
};

/// Connects a key with the member of a definition (...Def) that holds its value; see field.hpp.
struct Field {
    std::type_index def;  ///< type of the definition
    /// Stores a checked value in the definition. Empty for a key of a body whose reader does more than that.
    std::function<void(const Key&, const Value&, void*)> read;
    /// The value as a file gives it; empty if the definition leaves it open.
    std::function<std::string(const Key&, const void*)> toml;
    /// `toml` of a definition with default values.
    std::function<std::string(const Key&)> initial;
};

/// The fields of a key and its default. A key that several methods share has a field for each.
struct Binding {
    std::vector<Field> fields = {};
    Default initial = {};
};

/// One key of a scene file. Reading, checking, writing, comparing and documenting scenes follow from it.
struct Key {
    std::string_view section;  ///< dotted name of its table; empty: the top level
    std::string_view name;     ///< unique in its section
    Type type;
    std::string_view unit;
    Binding binding;
    std::string_view meaning;                    ///< completes "give ..."; of a table also an example
    std::string_view note = {};                  ///< further remarks
    std::vector<std::string_view> methods = {};  ///< those that use it; empty: all
    std::string_view instead = {};               ///< advice for other methods
};

/// All keys of scene files, section by section. The reader accepts no others.
[[nodiscard]] const std::vector<Key>& all_keys();

/// The key of that name; null if the section has none.
[[nodiscard]] const Key* find_key(std::string_view section, std::string_view name);

/// The key of the table, or the tables, that a section is; null for the top level.
[[nodiscard]] const Key* key_of_section(std::string_view section);

/// The keys of one section; none if there is no such section.
[[nodiscard]] std::span<const Key> keys_of(std::string_view section);

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

/// The shortest decimal text that reads as the same bits: "1e-9", "0.08", "-0.0".
[[nodiscard]] std::string number_text(double value);

/// The list of keys for a terminal: of all tables, or of one (`overlay`) and the tables in it. Empty if there
/// is no such table.
[[nodiscard]] std::string keys_text(std::string_view only = "");

/// The list of keys as a Markdown table.
[[nodiscard]] std::string keys_markdown();

/// The keys as a JSON Schema (draft 7, which TOML editors read): their types, ranges, words, defaults and
/// meanings. It accepts every scene that Corda reads, and refuses unknown keys, missing ones and values out
/// of range; it does not check dependencies between keys, such as those of a solver's keys on its method.
[[nodiscard]] std::string json_schema();

}  // namespace corda::scene
