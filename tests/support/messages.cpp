#include "support/messages.hpp"

#include <gmock/gmock.h>

#include "corda/film/film.hpp"
#include "support/failure.hpp"

namespace corda::test {
namespace {

std::vector<std::string> split(std::string_view text, std::string_view separator) {
    std::vector<std::string> parts;
    for (std::size_t end = 0; end != std::string_view::npos;) {
        end = text.find(separator);
        parts.emplace_back(text.substr(0, end));
        if (end != std::string_view::npos) text.remove_prefix(end + separator.size());
    }
    return parts;
}

std::string unescaped(std::string_view text) {
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool is_escape =
            text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'n' || text[i + 1] == '\\');
        if (is_escape) ++i;
        plain.push_back(is_escape && text[i] == 'n' ? '\n' : text[i]);
    }
    return plain;
}

std::string remedied(std::string text, const std::string& remedy) {
    for (const std::string& edit : split(remedy, " & ")) {
        if (edit.starts_with("+ ")) {
            text += "\n" + unescaped(edit.substr(2));
            continue;
        }
        const auto sides = split(edit, " =>");
        if (sides.size() != 2) throw std::runtime_error("no remedy: " + edit);
        const std::string was = unescaped(sides[0]);
        const std::size_t at = text.find(was);
        if (at == std::string::npos) throw std::runtime_error(edit + " is nowhere in " + text);
        text.replace(at, was.size(), sides[1].empty() ? "" : unescaped(sides[1].substr(1)));
    }
    return text;
}

/// Reads a scene, and plans it with a short motion and small pictures unless it says how long and how large
/// they are.
void read_and_run(const std::string& toml) {
    static_cast<void>(parse_scene(toml, "swing.toml"));
    std::vector<Setting> settings;
    if (toml.find("duration") == std::string::npos) settings.emplace_back("world.duration=0.1");
    if (toml.find("size") == std::string::npos) settings.emplace_back("video.size=[64, 64]");
    Film film(parse_scene(toml, "swing.toml", settings));
    static_cast<void>(film.state(film.last_frame()));
}

}  // namespace

std::vector<Message> messages_of(std::string_view table) {
    std::vector<Message> messages;
    std::string base;
    for (const std::string& line : split(table, "\n")) {
        if (line.starts_with("@")) base = scene_base(line.substr(1));
        if (line.empty() || line.starts_with("@")) continue;
        const auto cells = split((line.starts_with("| ") ? " " : "") + line, " | ");
        if (cells.size() < 3 || cells.size() > 4) throw std::runtime_error("no row of messages: " + line);
        Message& message = messages.emplace_back(Message{base + unescaped(cells[0]), cells[1], cells[2], {}});
        if (cells.size() < 4) continue;
        for (const std::string& remedy : split(cells[3], " ; "))
            message.remedied.push_back(remedied(message.input, remedy));
    }
    return messages;
}

std::string scene_base(std::string_view name) {
    const std::string head = "schema = 1\n";
    const std::string rope = "[[rope]]\nline = { particles = 3, step = [0, -1] }\n";
    const std::string grid = "[[net]]\ngrid = { columns = 3, rows = 2, spacing = 0.5 }\n";
    const std::string corners = "points = [[0, 0], [1, 0], [1, 1], [0, 1]]\n";
    const std::string scene = head + "rope = [{ hang = { links = 3, length = 3.0 } }]\n";
    if (name == "file" || name == "command") return "";
    if (name == "head") return head;
    if (name == "shape") return head + "[[rope]]\n";
    if (name == "net") return head + "[[net]]\n";
    if (name == "rope") return head + rope;
    if (name == "square") return head + "[[rope]]\n" + corners;
    if (name == "grid") return head + grid;
    if (name == "graph") return head + "[[net]]\n" + corners;
    if (name == "bodies") return head + rope + rope + grid + "[[solver.bodies]]\n";
    if (name == "scene") return scene;
    return scene + "[" + std::string(name) + "]\n";
}

void expect_scene_messages(std::string_view table) {
    for (const Message& message : messages_of(table)) {
        SCOPED_TRACE(message.input);
        const Failure failure = failure_of([&] { read_and_run(message.input); });
        EXPECT_EQ(failure.code, ExitCode::kInvalidScene);
        const std::size_t space = message.place.find(' ');
        if (message.place != "-") {
            EXPECT_THAT(failure.message, testing::StartsWith("swing.toml:" + message.place.substr(0, space) +
                                                             ": " + message.place.substr(space + 1) + ": "));
        }
        EXPECT_THAT(failure.message, testing::HasSubstr(message.text));
        for (const std::string& toml : message.remedied) {
            const Failure left = failure_of([&] { read_and_run(toml); });
            EXPECT_EQ(left.code, ExitCode::kOk) << toml << '\n' << left.message;
        }
    }
}

}  // namespace corda::test
