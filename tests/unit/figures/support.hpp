#pragma once

#include <map>
#include <string>
#include <vector>

#include "corda/figures/motion_summary.hpp"

namespace corda::figures {

inline FilmDef def_of(const Scene& scene, const std::vector<double>& stills_s = {}) {
    FilmDef def = film_def(scene);
    def.stills_s.insert(def.stills_s.end(), stills_s.begin(), stills_s.end());
    return def;
}

inline Scene scene_of(const std::string& toml) {
    return parse_scene("schema = 1\n" + toml, "scene.toml");
}

/// A motion and its rows.
struct ReadScene {
    explicit ReadScene(const std::string& toml, const std::vector<double>& stills_s = {})
        : film(scene_of(toml), def_of(scene_of(toml), stills_s)),
          motion(read_motion(film,
                             [this](const std::string& name, const std::vector<std::string>& keys) -> OnRow {
                                 columns[name] = keys;
                                 return [&all = rows[name]](std::span<const double> values) {
                                     all.emplace_back(values.begin(), values.end());
                                 };
                             },
                             {})) {}

    /// Column `key` of a file.
    [[nodiscard]] std::vector<double> column(const std::string& name, const std::string& key) const {
        const auto& keys = columns.at(name);
        std::size_t at = 0;
        while (keys.at(at) != key) ++at;
        std::vector<double> values;
        for (const auto& row : rows.at(name)) values.push_back(row.at(at));
        return values;
    }

    std::map<std::string, std::vector<std::string>> columns;
    std::map<std::string, std::vector<std::vector<double>>> rows;
    Film film;
    MotionSummary motion;
};

/// A pendulum of 2 kg on a link of 1 m, released from 60 degrees.
inline std::string pendulum_toml(const std::string& world = "duration = 1.0",
                                 const std::string& fps = "200") {
    return "[world]\n" + world +
           "\n[[rope]]\nhang = { links = 1, length = 1.0, angle_deg = 60.0, from = [3.0, 4.0] }\nmass = "
           "2.0\n[solver]\nmethod = \"exact\"\n[video]\nsize = [320, 180]\nfps = " +
           fps + "\n";
}

}  // namespace corda::figures
