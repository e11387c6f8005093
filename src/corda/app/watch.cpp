#include "corda/serve/watch.hpp"
#include "commands.hpp"
#include "corda/core/text.hpp"
#include "corda/serve/server.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct WatchOptions {
    SceneOptions scene;
    serve::WatchDef watch;
    serve::ServerDef server;
};

ExitCode watch(const Console& console, const WatchOptions& options) {
    if (options.scene.path == "-")
        throw Error(ExitCode::kUsage, "a scene on standard input does not change; give the path of a file");
    constexpr int kWaitMs = 200;
    serve::FileWatch file(options.scene.path);
    serve::WatchDef def = options.watch;
    def.path = options.scene.path;
    def.settings = options.scene.settings;
    // The page shows them too, but a user who has misspelt the path looks at the terminal.
    def.on_problems = [&console](const std::vector<Problem>& problems) {
        for (const Problem& problem : problems) console.error(problem.text());
    };
    serve::Watch watch(std::move(def));
    const serve::Server server(options.server,
                               [&watch](const serve::Request& request) { return watch.answer(request); });
    console.result(server.address());
    console.report({{"schema", 1}, {"address", server.address()}});
    console.info("open this address in a browser; Ctrl-C ends the program");
    set_interruption_message(kSomethingWritten);
    try {
        while (true) {
            check_cancelled();
            if (file.wait(kWaitMs)) watch.reload();
        }
    } catch (...) {
        watch.end();  // the server waits for its requests, and they for this
        throw;
    }
}

}  // namespace

void add_watch(CLI::App& app, Action& action) {
    auto [command, options] =
        add_command(app, action, "watch",
                    "show a scene on a page of this machine, new with every save of its file", watch);
    add_scene(command, options.scene);
    add_gl(command, options.watch.film);
    command.add_option("--port", options.server.port, "port at 127.0.0.1; 0: any that is free")
        ->check(within(0, 65535));
    command
        .add_option(
            "--host", options.server.hosts,
            "a name other than localhost by which a proxy, such as that of Jupyter, reaches this page")
        ->type_name("NAME");
    command.add_option("--side", options.watch.longest_side_px, "longest side of the pictures in pixels")
        ->check(within(160, kMaxSidePx));
}

}  // namespace corda::app
