#include "corda/serve/watch.hpp"
#include "commands.hpp"
#include "corda/core/text.hpp"
#include "corda/serve/file_watch.hpp"
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
    if (!file.warning().empty()) console.warning(file.warning());
    serve::WatchDef def = options.watch;
    def.path = options.scene.path;
    def.settings = options.scene.settings;
    // The page shows them too, but a user who has misspelt the path looks at the terminal.
    def.on_problems = [&console](const std::vector<Problem>& problems) {
        for (const Problem& problem : problems) console.error(problem.text());
        if (problems.empty()) console.info("the scene is shown again");
    };
    serve::Watch watch(std::move(def));
    const serve::Server server(options.server,
                               [&watch](const serve::Request& request) { return watch.answer(request); });
    tell_address(console, server);
    console.report(
        {{"schema", 1}, {"address", server.address()}, {"other_addresses", server.other_addresses()}});
    console.info("open this address in a browser; Ctrl-C ends the program");
    while (interruption() == ExitCode::kOk)
        if (file.wait(kWaitMs)) watch.reload();
    watch.end();  // the server waits for its requests, and they for this
    console.info("ended");
    return interruption();
}

}  // namespace

void add_watch(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "watch", "show a scene on a page in a browser, new with every save of its file", watch);
    add_scene(command, options.scene);
    add_gl(command, options.watch.film);
    add_server(command, options.server);
    command
        .add_option("--side", options.watch.longest_side_px,
                    "longest side of the pictures in pixels; default: as the page has room")
        ->check(within(160, kMaxSidePx));
}

}  // namespace corda::app
