#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/scene/schema.hpp"

namespace corda::app {

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
