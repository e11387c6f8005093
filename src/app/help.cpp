#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/scene/schema.hpp"
#include "manual.hpp"

namespace corda::app {
namespace {

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
    if (const CLI::App* const command = find_command(app, topic)) return help_of(*command);
    std::vector<std::string> topics = command_names(app);
    topics.emplace_back(kSceneTopic);
    topics.emplace_back(kManualTopic);
    throw Error(ExitCode::kUsage,
                fmt::format("there is no help on \"{}\"; {}", topic, advice(topic, topics)));
}

}  // namespace

void add_help(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("help", "explain a command, or the keys of a scene file");
    const auto topic = std::make_shared<std::string>();
    command->add_option("TOPIC", *topic, "a command; scene: the keys of a scene file; man: the manual page");
    command->callback([&app, &action, topic] {
        action = [&app, topic](const Console& console) {
            const std::string text = text_about(app, *topic);
            console.result(std::string_view(text).substr(0, text.size() - 1));  // adds the end of the line
            console.report({{"schema", 1}, {"help", text}});
            return ExitCode::kOk;
        };
    });
}

}  // namespace corda::app
