#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace corda::test {

/// The advice of a message, followed literally: `was` becomes `is` in the scene or, if the scene does not
/// contain it, in the command. If both are empty, the command is run once more.
struct Edit {
    std::string was;
    std::string is;
};

/// A message with advice, and the result of following it.
struct Remedy {
    const char* name;     ///< name of the test
    std::string scene;    ///< the scene file that provokes the message
    std::string command;  ///< the command line; SCENE stands for the file, DIR for its folder
    std::string says;     ///< the advice, as the message words it
    /// Each of them must work on its own.
    std::vector<std::vector<Edit>> remedies;
    std::string then = {};  ///< an allowed message of a command that still fails for another reason
};

inline void PrintTo(const Remedy& remedy, std::ostream* out) {
    *out << remedy.name;
}

/// The name of a test with such a parameter.
inline const auto kNameOfCase = [](const auto& param) { return std::string(param.param.name); };

/// Provokes the message, and expects every remedy to work.
void expect_to_work(const Remedy& remedy);

// Parts of scenes.

/// A short scene with small pictures, this body, and more text.
inline std::string scene_of(const std::string& body, const std::string& rest = "") {
    return "schema = 1\n" + body + "\n" + rest +
           "\n[world]\nduration = 0.1\n[video]\nsize = [64, 64]\nfps = 30\n";
}

inline std::string rope_scene(const std::string& keys, const std::string& rest = "") {
    return scene_of("[[rope]]\n" + keys, rest);
}

inline std::string net_scene(const std::string& keys, const std::string& rest = "") {
    return scene_of("[[net]]\n" + keys, rest);
}

inline std::string method_of(const char* name) {
    return std::string("[solver]\nmethod = \"") + name + "\"\n";
}

inline const std::string kHang = "hang = { links = 4, length = 1.0, angle_deg = 30.0 }\n";
inline const std::string kRing = "points = [[0, 0], [0.5, -0.4], [0.1, -1], [-0.5, -0.5]]\nclosed = true\n";
inline const std::string kGrid = "grid = { columns = 3, rows = 3, spacing = 0.2, diagonals = true }\n";
inline const std::string kSquare = "points = [[0, 0], [1, 0.1], [0.9, -1], [0, -1]]\n";
inline const std::string kSides = "bars = [[0, 1], [1, 2], [2, 3], [3, 0]]\n";

}  // namespace corda::test
