#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "corda/scene/scene.hpp"
#include "corda/sweep/labels.hpp"

namespace corda::sweep {

using Json = nlohmann::json;

/// One of these values, each as likely.
struct Choice {
    std::vector<Json> values;
};

enum class Shape { kUniform, kLogUniform, kNormal, kInteger };
inline constexpr std::array<std::string_view, 4> kShapeNames{"uniform", "log_uniform", "normal", "integer"};

/// A distribution of numbers, or of vectors with independent components.
struct Distribution {
    Shape shape = Shape::kUniform;
    bool is_vector = false;
    std::vector<double> first;   ///< per component: the least value; of kNormal the mean
    std::vector<double> second;  ///< per component: the largest value; of kNormal the standard deviation
    /// Bounds of kNormal, which is truncated to them; may be infinite.
    std::vector<double> min;
    std::vector<double> max;
};

/// A key of the scene and its values.
struct VariedKey {
    std::string key;
    std::variant<Choice, Distribution> values;
};

enum class Pictures { kMp4, kPng, kNpz, kNone };
inline constexpr std::array<std::string_view, 4> kPictureNames{"mp4", "png", "npz", "none"};

struct Split {
    std::string name;
    double share = 0.0;
};

/// A sweep file: one scene, many parameters. See README.md.
struct SweepDef {
    static constexpr std::int64_t kMaxSamples = 1'000'000'000;
    static constexpr std::int64_t kMaxShardSamples = 1'000'000;

    std::string source;      ///< path of the sweep file, as messages name it
    std::string scene_name;  ///< the scene's path as the sweep file gives it
    std::string scene_toml;
    std::int64_t samples = 0;
    bool is_grid = false;  ///< every combination of the choices; the last key varies fastest
    std::uint64_t seed = 0;
    std::int64_t shard_samples = 256;
    std::vector<VariedKey> vary;  ///< in the order of the file
    Pictures pictures = Pictures::kMp4;
    std::string encoder;               ///< of kMp4, with its versions: clips depend on them
    std::vector<const Label*> labels;  ///< the times first
    std::vector<std::string> summary;  ///< names of summary columns
    std::vector<Split> splits;         ///< shares with the sum 1, or none
};

/// Reads a sweep file and its scene. Throws corda::Error: kIo if one cannot be read, kInvalidScene with all
/// that is wrong in the sweep file, one problem per line, or in the scene.
[[nodiscard]] SweepDef load_sweep(const std::string& path);

/// A value of a scene's key, by the key.
using Parameters = std::vector<std::pair<std::string, Json>>;

/// The parameters of a sample, in the order of SweepDef::vary: a function of the definition and the number
/// alone. Throws corda::Error (kInvalidScene) if no number of a normal distribution falls within its bounds.
[[nodiscard]] Parameters parameters_of(const SweepDef& sweep, std::int64_t sample);

/// The split of a sample; empty if there are none. It does not depend on the parameters.
[[nodiscard]] std::string split_of(const SweepDef& sweep, std::int64_t sample);

/// The parameters as settings of the scene, "key=value".
[[nodiscard]] std::vector<Setting> settings_of(const Parameters& parameters);

/// The scene of a sample. Throws corda::Error as parse_scene().
[[nodiscard]] Scene scene_of(const SweepDef& sweep, const Parameters& parameters);

/// A value as TOML on one line.
[[nodiscard]] std::string toml_of(const Json& value);
/// A value as it stands in CSV and in messages: text without quotes.
[[nodiscard]] std::string value_text(const Json& value);

/// All that determines the bytes of a sample, by key: two sweeps with the same have the same samples.
[[nodiscard]] std::map<std::string, std::string> identity_of(const SweepDef& sweep);

}  // namespace corda::sweep
