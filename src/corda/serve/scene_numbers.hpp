#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "corda/scene/scene.hpp"

namespace corda::serve {

/// A number in a scene file.
struct SceneNumber {
    std::string key;          ///< as --set takes it: "rope[0].hang.angle_deg", "world.gravity[1]"
    double value = 0.0;       ///< that of a setting, if there is one
    bool is_integer = false;  ///< the key takes integers only
    double low = 0.0;         ///< its range
    double high = 0.0;
    bool low_open = false;  ///< `low` itself is not allowed
    std::string unit;
    std::string meaning;
    std::size_t line = 0;  ///< in the file, from 1
};

/// The numbers of a scene file that change motion or picture, in the order of the file: those of long lists
/// and of [video] and [golden], and indices of pins are left out. Throws corda::Error: kInvalidScene if it is
/// no TOML, kUsage for a setting that is not key=value.
[[nodiscard]] std::vector<SceneNumber> numbers_of(std::string_view text, const std::string& name,
                                                  const std::vector<Setting>& settings = {});

/// True if a setting gives the value of this key, or of a table or list that the key lies in.
[[nodiscard]] bool sets(const Setting& setting, const std::string& key);

/// New values of numbers, by their keys.
using NumberChanges = std::map<std::string, double>;

/// The changes as --set would give them.
[[nodiscard]] std::vector<Setting> settings_of(const NumberChanges& changes,
                                               const std::vector<SceneNumber>& numbers);

/// A scene file with other numbers in the place of its own; all else keeps its bytes, and the text that is
/// returned has been read again and says these numbers. Throws corda::Error (kUsage) for a key that is not
/// among numbers_of(), and if the text would say anything else.
[[nodiscard]] std::string with_changes(const std::string& before, const std::string& name,
                                       const NumberChanges& changes);

}  // namespace corda::serve
