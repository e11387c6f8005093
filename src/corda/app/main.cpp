#include <algorithm>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/problem_json.hpp"
#include "corda/core/removed.hpp"
#include "corda/gl/driver.hpp"
#include "corda/scene/schema.hpp"
#include "interrupt.hpp"

namespace corda::app {
namespace {

void add_console_flags(CLI::App& app, ConsoleDef& def) {
    for (CLI::App* command : app.get_subcommands({})) {
        command->add_flag("--json", def.json, "print the result as JSON on standard output");
        command->add_flag("-q,--quiet", def.quiet, "print only results and errors");
        command->add_flag("-v,--verbose", def.verbose, "print more details");
    }
}

/// Refuses empty values: they come from variables of a script that are not set, and must not count as options
/// that were left out.
void refuse_empty_values(CLI::App& app) {
    const auto check = [](const std::string& value) {
        return value.empty() ? std::string("the value is empty; give one, or leave it out") : std::string();
    };
    for (CLI::App* command : app.get_subcommands({})) {
        for (CLI::Option* option : command->get_options())
            if (option->get_items_expected_max() > 0) option->check(check);
    }
}

/// The last value of a repeated option counts, so that a script's can be overridden; lists take all values.
void take_last_values(CLI::App& app) {
    for (CLI::App* command : app.get_subcommands({})) {
        for (CLI::Option* option : command->get_options()) {
            const bool is_one = option->get_expected_min() == 1 && option->get_items_expected_max() == 1;
            if (is_one && option->get_multi_option_policy() == CLI::MultiOptionPolicy::Throw)
                option->take_last();
        }
    }
}

/// Why the first word is no command; std::nullopt if it is one, or an option.
std::optional<std::string> unknown_command(const CLI::App& app, int argc, char** argv) {
    if (argc < 2) return std::nullopt;
    if (argv[1][0] == '-') {
        for (int i = 2; i < argc; ++i)
            if (find_command(app, argv[i]) != nullptr)
                return fmt::format("options stand behind the command; begin with corda {}", argv[i]);
        return std::nullopt;
    }
    if (find_command(app, argv[1]) != nullptr) return std::nullopt;
    if (const auto replacement = replacement_of(argv[1]); !replacement.empty())
        return fmt::format("the command \"{}\" was removed; {}", argv[1], replacement);
    return fmt::format("there is no command \"{}\"; {}", argv[1], advice(argv[1], command_names(app)));
}

/// Advice for an option that has the name of a key, such as "--hold"; std::nullopt for others.
std::optional<std::string> setting_for(std::string_view option) {
    std::string name(option.substr(2));
    std::ranges::replace(name, '-', '_');
    std::optional<std::string> of_ropes;
    for (const scene::Key& key : scene::all_keys()) {
        if (key.name != name || key.type.kind == scene::Kind::kTable || key.type.kind == scene::Kind::kTables)
            continue;
        const std::string path = scene::path_of(key);
        const std::size_t list = path.find("[]");
        if (list == std::string::npos) return fmt::format("it is a key of the scene: --set {}=...", path);
        if (!of_ropes)
            of_ropes = fmt::format("it is a key of the scene: --set {}[0{}=...", path.substr(0, list),
                                   path.substr(list + 1));
    }
    return of_ropes;
}

/// The first argument of a command that looks like an option and is none; std::nullopt if all are.
std::optional<std::string> unknown_option(const CLI::App& app, int argc, char** argv) {
    const CLI::App* const command = argc < 2 ? nullptr : find_command(app, argv[1]);
    if (command == nullptr) return std::nullopt;
    std::vector<std::string> names;
    for (const CLI::Option* option : command->get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    for (int i = 2; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (argument == "--") return std::nullopt;
        const std::string word(argument.substr(0, argument.find('=')));
        if (!word.starts_with("--") || std::ranges::find(names, word) != names.end()) continue;
        if (const auto replacement = replacement_of(word); !replacement.empty())
            return fmt::format("the option {} was removed; {}", word, replacement);
        const bool takes_settings = std::ranges::find(names, "--set") != names.end();
        const auto setting = takes_settings ? setting_for(word) : std::nullopt;
        return fmt::format("unknown option {}; {}", word, setting ? *setting : advice(word, names));
    }
    return std::nullopt;
}

/// The first word that belongs to no option of a command, and what may be meant; std::nullopt if there is
/// none.
std::optional<std::string> unexpected_word(const CLI::App& app, int argc, char** argv) {
    const CLI::App* const command = argc < 2 ? nullptr : find_command(app, argv[1]);
    const std::vector<std::string> left = app.remaining(true);
    for (int i = 2; i < argc && command != nullptr; ++i) {
        const std::string word = argv[i];
        if (word.starts_with('-') || std::ranges::find(left, word) == left.end()) continue;
        const std::string before = argv[i - 1];
        std::string remedy = "see --help";
        const CLI::Option* const output = command->get_option_no_throw("--output");
        if (word.starts_with('=') || before == "=" || before.ends_with('='))
            remedy = "a setting has no spaces: --set world.duration=2";
        else if (word.find_first_not_of("0123456789.:") == std::string::npos)
            remedy = "lists have commas and no spaces: --at 0,0.5";
        else if (output != nullptr && output->count() == 0)
            remedy = fmt::format("the output is named by -o {}", word);
        return fmt::format("\"{}\" was not expected; {}", word, remedy);
    }
    return std::nullopt;
}

/// Reports an error, with --json on standard output too.
int fail(const Console& console, const Error& error) {
    const int code = static_cast<int>(error.code());
    const std::string message = printable_lines(error.what());
    console.error(message);
    try {
        console.report(
            {{"schema", 1},
             {"error",
              {{"code", code}, {"message", message}, {"problems", problems_json(error.problems())}}}});
    } catch (const Error&) {
        // Standard output takes no more; the exit code still tells.
    }
    return code;
}

/// Runs the action of a command line, and turns exceptions into exit codes.
int act(const Console& console, const Action& action, const std::string& asked) {
    try {
        install_signal_handlers();
        const CancelScope stopping(stop_if_asked);
        return static_cast<int>(action(console));
    } catch (const ReaderLeft&) {
        return static_cast<int>(ExitCode::kOk);
    } catch (const Error& error) {
        // A read or a write that the signal broke off fails like any other.
        const bool is_broken_off = error.code() == ExitCode::kInterrupted || error.code() == ExitCode::kIo;
        const bool is_asked = interruption() != ExitCode::kOk;
        return fail(console, {is_asked && is_broken_off ? interruption() : error.code(), error.problems()});
    } catch (const std::bad_alloc&) {
        return fail(console,
                    {ExitCode::kTemporary,
                     fmt::format("out of memory for {}; a smaller scene or picture may help", asked)});
    } catch (const std::system_error& error) {
        if (error.code() != std::errc::resource_unavailable_try_again &&
            error.code() != std::errc::not_enough_memory)
            return fail(console, {ExitCode::kInternal,
                                  fmt::format("internal error, please report it: {}", error.what())});
        return fail(console,
                    {ExitCode::kTemporary,
                     fmt::format("the system starts no further thread: {}; run fewer processes, or raise the "
                                 "limit (ulimit -u)",
                                 error.what())});
    } catch (const std::exception& error) {
        return fail(console,
                    {ExitCode::kInternal, fmt::format("internal error, please report it: {}", error.what())});
    }
}

int run(int argc, char** argv) {
    CLI::App app{
        "Corda turns a rope scene into a video, a still or a comparable picture on a machine without a "
        "screen."};
    app.set_version_flag("--version", "corda " CORDA_VERSION);
    app.require_subcommand(1);
    app.footer("More: corda help codes (exit codes), corda help scene (keys of scenes), corda help WORD");
    Action action;
    ConsoleDef console_def;
    for (AddCommand* const add : kCommands) add(app, action);
    add_console_flags(app, console_def);
    refuse_empty_values(app);
    take_last_values(app);
    // What the options say is not known until they are parsed, and that may fail.
    const Console early({.json = std::find(argv, argv + argc, std::string_view("--json")) != argv + argc});
    if (const auto word = unknown_command(app, argc, argv)) return fail(early, {ExitCode::kUsage, *word});
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        auto problem = unknown_option(app, argc, argv);
        const auto is = [&error](CLI::ExitCodes code) {
            return error.get_exit_code() == static_cast<int>(code);
        };
        if (!problem && (is(CLI::ExitCodes::ExtrasError) || is(CLI::ExitCodes::RequiredError)))
            problem = unexpected_word(app, argc, argv);
        return fail(early, {ExitCode::kUsage, problem.value_or(fmt::format("{}; see --help", error.what()))});
    } catch (const Error& error) {
        return fail(early, error);
    }
    return act(Console(console_def), action, fmt::format("'{}'", fmt::join(argv + 1, argv + argc, " ")));
}

/// Settings of libraries, where the user has none: SVT-AV1 prints nothing, and Mesa stores compiled shaders
/// for the next run, which is safe because the program does not fork.
void set_up_libraries() {
    setenv("SVT_LOG", "1", 0);
    setenv(gl::kNoShaderCache, "false", 0);
}

}  // namespace
}  // namespace corda::app

int main(int argc, char** argv) {
    try {
        corda::keep_memory();
        corda::app::set_up_libraries();
        corda::app::keep_standard_streams();
        return corda::app::run(argc, argv);
    } catch (const std::bad_alloc&) {
        return static_cast<int>(corda::ExitCode::kTemporary);
    } catch (...) {
        return static_cast<int>(corda::ExitCode::kInternal);
    }
}
