#pragma once

#include <toml++/toml.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/scene/problems.hpp"
#include "corda/scene/scene.hpp"
#include "corda/scene/schema.hpp"

namespace corda::scene {

/// Parts that a dotted key may have. The scene format needs 3; the TOML parser and its tree recurse once per
/// part.
inline constexpr int kKeyParts = 32;

/// Throws corda::Error (kInvalidScene) if `bytes` is more than Limits::kFileBytes.
void check_file_bytes(const std::string& source_name, std::size_t bytes);

/// Parses TOML text. Throws kInvalidScene with `source_name`:line:column and the parser's description, and
/// kInterrupted if cancelled.
[[nodiscard]] toml::table parse_document(std::string_view text, const std::string& source_name);

/// A dotted key of too many parts, as an offset into the TOML text; npos if there is none.
[[nodiscard]] std::size_t find_deep_key(std::string_view text);

/// One part of a dotted key: a name, or an index if the name is empty.
struct KeyStep {
    std::string name;
    std::size_t index = 0;

    [[nodiscard]] bool is_index() const { return name.empty(); }
    friend bool operator==(const KeyStep&, const KeyStep&) = default;
};

/// The parts of a dotted key such as "rope[0].mass", with spaces around it or not; std::nullopt for any other
/// text.
[[nodiscard]] std::optional<std::vector<KeyStep>> parse_key(std::string_view key);

/// Puts `setting` into the document, making missing tables on its way, or removes its key if the value is
/// empty. What it puts there has `place`, by default --set, and the setting as its source, so that messages
/// about it name them. A setting that does not fit the document is a problem. Throws corda::Error (kUsage) if
/// it is not key=value.
void apply_setting(toml::table& document, const Setting& setting, Problems& problems,
                   const std::string& place = "");

/// Why a dotted key does not fit the document, such as an index beyond a list, with a remedy; empty if it
/// does. A key that fits is 0 from then on.
[[nodiscard]] std::string misfit_of(toml::table& document, std::string_view key);

/// Checks a document against the schema: unknown and missing keys, types, ranges and keys of other methods.
/// Bad values are taken out of the document, so that their defaults stand in for them.
void check_document(toml::table& document, Problems& problems);

/// Adds the copies of ropes as ropes, in a document without problems; the problem of a copy is that of its
/// rope.
void expand_copies(toml::table& document, Problems& problems);

/// Checks one value of a key, as TOML, against the schema.
void check_value(const Key& key, const std::string& toml, const std::string& path, Problems& problems);

}  // namespace corda::scene
