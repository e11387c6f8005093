#include <memory>

#include "commands.hpp"
#include "figure_options.hpp"

namespace corda::app {
namespace {

struct SheetOptions : FigureOptions {
    int columns = 0;
};

ExitCode write_sheet(const Console& console, SheetOptions options) {
    options.take_origin(console, "sheet");
    if (options.columns == 0) options.columns = options.columns_of_origin;
    Scene scene = options.load(console);
    const std::vector<RequestedTime> shots = options.shots.list(scene);
    std::vector<double> times_s;
    for (const RequestedTime& shot : shots) times_s.push_back(shot.time_s);
    const FigureDef def = contact_sheet(scene, times_s, options.columns);
    return options.write_one(console, scene, shots, def);
}

}  // namespace

void add_sheet(CLI::App& app, Action& action) {
    auto options = std::make_shared<SheetOptions>();
    CLI::App* command = app.add_subcommand("sheet", "draw a contact sheet: a picture of cells, one per time");
    options->add_to(*command, "picture: .png, .svg or .pdf; --size and --width-mm are those of all of it");
    command
        ->add_option("--columns", options->columns,
                     "cells side by side; default: what fills the picture best")
        ->check(within(1.0, 1000.0));
    command->callback([options, &action] {
        options->require();
        action = [options](const Console& console) { return write_sheet(console, *options); };
    });
}

}  // namespace corda::app
