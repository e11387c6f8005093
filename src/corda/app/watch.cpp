

#include "corda/serve/watch.hpp"
#include "commands.hpp"
#include "corda/core/text.hpp"
#include "corda/serve/file_watch.hpp"
#include "corda/serve/server.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

struct WatchOptions {
    SceneOptions scene;
    serve::ServerDef server;
    int side_px = 640;
    GlOptions gl;
};

ExitCode watch(const Console& console, const WatchOptions& options) {
    if (options.scene.path == "-")
        throw Error(ExitCode::kUsage, "a scene on standard input does not change; give the path of a file");
    constexpr int kWaitMs = 200;
    serve::FileWatch file(options.scene.path);
    serve::WatchDef def{.path = options.scene.path,
                        .settings = options.scene.settings,
                        .longest_side_px = options.side_px,
                        .film = {}};
    options.gl.apply_to(def.film);
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
    options.scene.add_to(command);
    options.gl.add_to(command);
    command.add_option("--port", options.server.port, "port at 127.0.0.1; 0: any that is free")
        ->check(within(0, 65535));
    command
        .add_option(
            "--host", options.server.hosts,
            "a name other than localhost by which a proxy, such as that of Jupyter, reaches this page")
        ->type_name("NAME");
    command.add_option("--side", options.side_px, "longest side of the pictures in pixels")
        ->check(within(160, kMaxSidePx));
}

}  // namespace corda::app
