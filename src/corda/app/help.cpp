#include <cctype>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/removed.hpp"
#include "corda/core/text.hpp"
#include "corda/scene/schema.hpp"

namespace corda::app {
namespace {

/// `text` as man's own words would not be read.
std::string roff(std::string_view text) {
    std::string all;
    for (const char c : text) {
        if (c == '\\')
            all += "\\e";
        else if (c == '-')
            all += "\\-";
        else
            all += c;
    }
    const bool is_request = !all.empty() && (all.front() == '.' || all.front() == '\'');
    return is_request ? "\\&" + all : all;
}

/// "-o, --output TEXT", in bold, and what it takes in italics.
std::string option_text(const CLI::Option& option) {
    std::string names;
    for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
    for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
    if (names.empty()) return fmt::format("\\fI{}\\fR", roff(option.get_name(true)));
    const std::string value = option.get_type_size() > 0 ? option.get_type_name() : "";
    return fmt::format("\\fB{}\\fR{}", roff(names),
                       value.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(value)));
}

std::string command_text(const CLI::App& command) {
    std::string text =
        fmt::format(".SS corda {}\n{}.\n", roff(command.get_name()), roff(command.get_description()));
    for (const CLI::Option* option : command.get_options()) {
        const bool is_help = option->get_lnames() == std::vector<std::string>{"help"};
        if (is_help) continue;
        text += fmt::format(".TP\n{}\n{}\n", option_text(*option), roff(option->get_description()));
    }
    return text;
}

/// The manual page, corda(1), for man: from the commands and options that the program knows.
std::string manual_page(const CLI::App& app) {
    std::string text = fmt::format(
        ".TH CORDA 1 \"\" \"Corda {0}\" \"User Commands\"\n"
        ".SH NAME\ncorda \\- rope pendulums as exact frames and video, without a screen\n"
        ".SH SYNOPSIS\n.B corda\n.I COMMAND\n[\\fIOPTIONS\\fR] [\\fIARGUMENTS\\fR]\n"
        ".SH DESCRIPTION\n{1}\n"
        ".PP\nThe keys of scene files are listed by \\fBcorda help scene\\fR.\n"
        "Results go to standard output, everything else to standard error.\n"
        "As an input, \\(dq\\-\\(dq is standard input; as an output, standard output.\n"
        ".SH COMMANDS\n",
        CORDA_VERSION, roff(app.get_description()));
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        text += command_text(*command);
    text += ".SH EXIT STATUS\n";
    for (const ExitCodeText& row : kExitCodes)
        text += fmt::format(".TP\n.B {}\n{}\n", static_cast<int>(row.code), roff(row.meaning));
    text +=
        ".SH ENVIRONMENT\n"
        ".TP\n.B CORDA_BACKEND\nhow to reach OpenGL, as \\-\\-backend\n"
        ".TP\n.B NO_COLOR\nif it is set and not empty, messages have no colours\n";
    text +=
        ".SH EXAMPLES\n.EX\ncorda init\ncorda render scene.toml \\-o scene.mp4\n"
        "corda still scene.toml \\-\\-at 0,0.5,1 \\-o stills\n.EE";
    return text;
}

constexpr std::string_view kSceneTopic = "scene";
constexpr std::string_view kManualTopic = "man";
constexpr std::string_view kCodesTopic = "codes";

std::string exit_code_table() {
    std::string text = "Exit codes:\n";
    for (const ExitCodeText& row : kExitCodes)
        text += fmt::format("  {:>3}  {}\n", static_cast<int>(row.code), row.meaning);
    return text;
}

/// Whether a text has these words as a whole.
bool has_words(const std::string& text, const std::string& words) {
    const auto is_part = [&](std::size_t i) {
        return i < text.size() && std::isalnum(static_cast<unsigned char>(text[i])) != 0;
    };
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
        if (!(at > 0 && is_part(at - 1)) && !is_part(at + words.size())) return true;
    return false;
}

/// The lines of the keys whose path, unit or description have a word, each with its table; empty if there are
/// none.
std::string keys_about(const std::string& word) {
    std::string text;
    for (const scene::Key& key : scene::all_keys()) {
        const std::string words = lower(fmt::format("{} {} {}", scene::path_of(key), key.meaning, key.note));
        if (!has_words(words, lower(word))) continue;
        const std::string range = scene::range_text(key);
        text += fmt::format("{}: {}{}; {}\n", scene::path_of(key), scene::type_text(key),
                            key.unit.empty() ? "" : fmt::format(", {}", key.unit), key.meaning);
        if (!range.empty()) text.insert(text.size() - 1, ", " + range);
        if (!key.note.empty()) text.insert(text.size() - 1, fmt::format(" ({})", key.note));
    }
    return text;
}

/// The same of the options of all commands.
std::string options_about(const CLI::App& app, const std::string& word) {
    std::string text;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        for (const CLI::Option* option : command->get_options())
            if (option->check_lname(lower(word)))
                text += fmt::format("corda {} --{}: {}\n", command->get_name(), lower(word),
                                    option->get_description());
    return text;
}

/// The text of `--help`. CLI::App::help would give that of the command that is running.
std::string help_of(const CLI::App& app) {
    const CLI::App* const parent = app.get_parent();
    const std::string name = parent == nullptr ? app.get_name() : parent->get_name() + " " + app.get_name();
    return app.get_formatter()->make_help(&app, name, CLI::AppFormatMode::Normal);
}

std::string text_about(const CLI::App& app, const std::string& topic) {
    if (topic.empty()) return help_of(app);
    if (topic == kSceneTopic) return scene::keys_text();
    if (topic == kManualTopic) return manual_page(app) + "\n";
    if (topic == kCodesTopic) return exit_code_table();
    std::string keys = scene::keys_text(topic);
    if (const CLI::App* const command = find_command(app, topic))
        return help_of(*command) + (keys.empty() ? "" : "\n" + keys);
    if (!keys.empty()) return keys;
    if (const auto replacement = replacement_of(topic); !replacement.empty())
        throw_usage("\"{}\" was removed; {}", topic, replacement);
    if (std::string found = options_about(app, topic) + keys_about(topic); !found.empty()) return found;
    std::vector<std::string> topics = command_names(app);
    topics.emplace_back(kSceneTopic);
    topics.emplace_back(kCodesTopic);
    topics.emplace_back(kManualTopic);
    throw_usage("there is no help on \"{}\"; {}", topic, advice(topic, topics));
}

}  // namespace

void add_help(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("help", "explain a command, or the keys of a scene file");
    const auto topic = std::make_shared<std::string>();
    command->add_option(
        "TOPIC", *topic,
        "a command; scene: the keys of a scene file; one of its tables, such as style or overlay.texts; any "
        "other word: keys and options about it; codes: the exit codes; man: the manual page");
    command->callback([&app, &action, topic] {
        action = [&app, topic](const Console& console) {
            const std::string text = text_about(app, *topic);
            console.result(std::string_view(text).substr(0, text.size() - 1));  // adds the end of the line
            console.report({{"schema", 1}, {"help", text}});
            return ExitCode::kOk;
        };
    });
}

void add_schema(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand(
        "schema", "print the JSON Schema of scene files, by which TOML editors check and complete them");
    command->callback([&action] {
        action = [](const Console& console) {
            const std::string schema = scene::json_schema();
            console.result(schema);
            console.report(nlohmann::json::parse(schema));
            return ExitCode::kOk;
        };
    });
}

}  // namespace corda::app
