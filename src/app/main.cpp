#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.hpp"
#include "corda/core/error.hpp"
#include "corda/scene/nearest_key.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

std::string exit_code_table() {
    std::string text = "Exit codes:\n";
    for (const ExitCodeText& row : kExitCodes)
        text += fmt::format("  {:>3}  {}\n", static_cast<int>(row.code), row.meaning);
    return text;
}

void add_console_flags(CLI::App& app, ConsoleDef& def) {
    for (CLI::App* command : app.get_subcommands({})) {
        command->add_flag("--json", def.json, "print the result as JSON on standard output");
        command->add_flag("-q,--quiet", def.quiet, "say nothing but errors");
        command->add_flag("-v,--verbose", def.verbose, "say more");
    }
}

/// Why the first word is no command; nothing where it is one, or an option.
std::optional<std::string> unknown_command(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return std::nullopt;
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return std::nullopt;
    const std::vector<std::string_view> candidates(names.begin(), names.end());
    const auto nearest = scene::nearest_key(argv[1], candidates);
    return fmt::format("there is no command \"{}\"; {}", argv[1],
                       nearest ? fmt::format("did you mean {}?", *nearest)
                               : fmt::format("known are {}", fmt::join(names, ", ")));
}

int run(int argc, char** argv) {
    CLI::App app{
        "Corda turns a rope scene into a video, a still or a comparable picture on a machine without a "
        "screen."};
    app.set_version_flag("--version", "corda " CORDA_VERSION);
    app.require_subcommand(1);
    app.footer(exit_code_table());
    Action action;
    ConsoleDef console_def;
    add_render(app, action);
    add_still(app, action);
    add_simulate(app, action);
    add_compare(app, action);
    add_verify(app, action);
    add_doctor(app, action);
    add_plan(app, action);
    add_study(app, action);
    add_console_flags(app, console_def);
    if (const auto word = unknown_command(app, argc, argv)) {
        Console({}).error(*word);
        return static_cast<int>(ExitCode::kUsage);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const bool asked_for_text = app.exit(error) == 0;
        return static_cast<int>(asked_for_text ? ExitCode::kOk : ExitCode::kUsage);
    } catch (const Error& error) {
        Console({}).error(error.what());
        return static_cast<int>(error.code());
    }
    const Console console(console_def);
    try {
        install_signal_handlers();
        return static_cast<int>(action(console));
    } catch (const Error& error) {
        console.error(error.what());
        return static_cast<int>(error.code());
    } catch (const std::bad_alloc&) {
        console.error("out of memory; a smaller scene or picture may help");
        return static_cast<int>(ExitCode::kTemporary);
    } catch (const std::exception& error) {
        console.error(fmt::format("internal error, please report it: {}", error.what()));
        return static_cast<int>(ExitCode::kInternal);
    }
}

}  // namespace
}  // namespace corda::app

int main(int argc, char** argv) {
    try {
        corda::app::keep_standard_streams();
        return corda::app::run(argc, argv);
    } catch (...) {
        return static_cast<int>(corda::ExitCode::kInternal);
    }
}
