#include <memory>

#include "commands.hpp"
#include "figure_options.hpp"

namespace corda::app {
namespace {

ExitCode write_strobe(const Console& console, FigureOptions options) {
    options.take_origin(console, "strobe");
    const Scene scene = options.load(console);
    const std::vector<RequestedTime> shots = options.shots.list(scene);
    FigureDef def;
    for (const RequestedTime& shot : shots) def.times_s.push_back(shot.time_s);
    return options.write_one(console, scene, shots, def);
}

}  // namespace

void add_strobe(CLI::App& app, Action& action) {
    auto options = std::make_shared<FigureOptions>();
    CLI::App* command =
        app.add_subcommand("strobe", "draw several poses in one picture, earlier ones fainter");
    options->add_to(*command, "picture: .png, .svg or .pdf");
    command->callback([options, &action] {
        options->require();
        action = [options](const Console& console) { return write_strobe(console, *options); };
    });
}

}  // namespace corda::app
