#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.hpp"

namespace corda::app {
namespace {

/// An option as a shell completes it.
struct Completion {
    std::string name;  ///< "--size"
    std::string help;  ///< one line
    bool takes_value = false;
};

std::vector<Completion> options_of(const CLI::App& command) {
    std::vector<Completion> all;
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_lnames().empty()) continue;  // an argument
        all.push_back(
            {"--" + option->get_lnames().front(), option->get_description(), option->get_type_size() > 0});
    }
    return all;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

/// `text` within single quotes of a shell, without what `_arguments` of zsh reads as its own.
std::string quoted(const std::string& text, const std::map<char, std::string>& escapes) {
    std::string all = "'";
    for (const char c : text) {
        const auto escape = escapes.find(c);
        all += escape == escapes.end() ? std::string(1, c) : escape->second;
    }
    return all + "'";
}

std::string bash_script(const CLI::App& app) {
    std::string cases;
    for (const CLI::App* command : commands_of(app)) {
        std::vector<std::string> names;
        for (const Completion& option : options_of(*command)) names.push_back(option.name);
        cases += fmt::format("        {}) options='{}' ;;\n", command->get_name(), fmt::join(names, " "));
    }
    return fmt::format(R"(# bash completion of corda: source <(corda completion bash)
_corda() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} options=
    if [[ $COMP_CWORD -eq 1 ]]; then
        COMPREPLY=($(compgen -W '{}' -- "$word"))
        return
    fi
    case ${{COMP_WORDS[1]}} in
{}    esac
    if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
    else
        COMPREPLY=($(compgen -f -- "$word"))
    fi
}}
complete -o filenames -F _corda corda)",
                       fmt::join(command_names(app), " "), cases);
}

std::string zsh_script(const CLI::App& app) {
    const std::map<char, std::string> escapes{
        {'\'', "'\\''"}, {'[', "\\["}, {']', "\\]"}, {':', "\\:"}, {'\\', "\\\\"}};
    std::string commands;
    std::string cases;
    for (const CLI::App* command : commands_of(app)) {
        commands += "        " + quoted(command->get_name(), escapes);
        commands.pop_back();
        commands += ":" + quoted(command->get_description(), escapes).substr(1) + "\n";
        cases += fmt::format("        {}) _arguments", command->get_name());
        for (const Completion& option : options_of(*command)) {
            const std::string help = quoted(option.help, escapes);
            cases += fmt::format(" '{}[{}]{}'", option.name, help.substr(1, help.size() - 2),
                                 option.takes_value ? ":value:_files" : "");
        }
        cases += " '*:file:_files' ;;\n";
    }
    return fmt::format(R"(#compdef corda
# zsh completion of corda: save as _corda in a folder of $fpath
_corda() {{
    local -a commands=(
{}    )
    if (( CURRENT == 2 )); then
        _describe command commands
        return
    fi
    shift words
    (( CURRENT-- ))
    case $words[1] in
{}    esac
}}
if [[ $funcstack[1] == _corda ]]; then _corda "$@"; else compdef _corda corda; fi)",
                       commands, cases);
}

std::string fish_script(const CLI::App& app) {
    const std::map<char, std::string> escapes{{'\'', "\\'"}, {'\\', "\\\\"}};
    std::string text = "# fish completion of corda: corda completion fish | source";
    for (const CLI::App* command : commands_of(app)) {
        const std::string name = command->get_name();
        text += fmt::format("\ncomplete -c corda -n __fish_use_subcommand -f -a {} -d {}", name,
                            quoted(command->get_description(), escapes));
        for (const Completion& option : options_of(*command)) {
            text += fmt::format("\ncomplete -c corda -n '__fish_seen_subcommand_from {}' -l {}{} -d {}", name,
                                option.name.substr(2), option.takes_value ? " -r" : "",
                                quoted(option.help, escapes));
        }
    }
    return text;
}

}  // namespace

void add_completion(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("completion", "print what completes commands and options in a shell");
    const auto shell = std::make_shared<std::string>();
    command->add_option("SHELL", *shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    command->callback([&app, &action, shell] {
        action = [&app, shell](const Console& console) {
            const std::string script = *shell == "bash"  ? bash_script(app)
                                       : *shell == "zsh" ? zsh_script(app)
                                                         : fish_script(app);
            console.result(script);
            console.report({{"schema", 1}, {"shell", *shell}, {"script", script}});
            return ExitCode::kOk;
        };
    });
}

}  // namespace corda::app
