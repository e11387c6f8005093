#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace corda::test {

/// A wrong input, and what its message says.
struct Message {
    std::string input;  ///< the text of a scene, or a command
    std::string place;  ///< place and key in the scene, or the exit code of the command
    std::string text;   ///< stands in the message
    /// The input after each remedy that the message names; all of them are valid.
    std::vector<std::string> remedied;
};

/// Reads a table with a message per line: `edit | place | text`, or `edit | place | text | remedy ; remedy`.
/// The edit, in which \n is a line end and \\ a backslash, follows the base that the last line `@base` names,
/// one of scene_base(). A remedy is `was => is`, or several joined by ` & `, or `+ lines` behind the input.
/// Empty lines do not count.
[[nodiscard]] std::vector<Message> messages_of(std::string_view table);

/// The start of a scene: `file` none, `head` its first line, `shape` a [[rope]] and `net` a [[net]] without
/// keys, `rope` one of 3 particles, `square` one through 4 corners, `grid` a net of 3 x 2 particles, `graph`
/// a net of 4 particles without bars, `bodies` two ropes, a net and an entry of [[solver.bodies]], `scene` a
/// rope in the second line, and any other name a table of that name behind it.
[[nodiscard]] std::string scene_base(std::string_view name);

/// Expects of each scene of a table, named swing.toml, that reading or running it throws kInvalidScene with
/// "swing.toml:<place>: " before the text, or just the text if the place is "-", and that what its remedies
/// name runs.
void expect_scene_messages(std::string_view table);

}  // namespace corda::test
