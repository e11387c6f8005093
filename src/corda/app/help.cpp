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
    std::string keys = scene::keys_text(topic);
    if (const CLI::App* const command = find_command(app, topic))
        return help_of(*command) + (keys.empty() ? "" : "\n" + keys);
    if (!keys.empty()) return keys;
    if (const auto replacement = replacement_of(topic); !replacement.empty())
        throw_usage("\"{}\" was removed; {}", topic, replacement);
    std::vector<std::string> topics = command_names(app);
    topics.emplace_back(kSceneTopic);
    topics.emplace_back(kManualTopic);
    throw_usage("there is no help on \"{}\"; {}", topic, advice(topic, topics));
}

}  // namespace

void add_help(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("help", "explain a command, or the keys of a scene file");
    const auto topic = std::make_shared<std::string>();
    command->add_option(
        "TOPIC", *topic,
        "a command; scene: the keys of a scene file; one of its tables, such as style or overlay.texts; "
        "man: the manual page");
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
