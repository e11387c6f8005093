#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/basics.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "embedded_examples.hpp"

namespace corda::app {
namespace {

/// The example that `init` writes if no other is named.
constexpr std::string_view kStart = "start";

const Example* find_example(std::string_view name) {
    const auto* const found = std::find_if(std::begin(kExamples), std::end(kExamples),
                                           [name](const Example& one) { return one.name == name; });
    return found == std::end(kExamples) ? nullptr : found;
}

/// The first sentence of the comment at the top.
std::string summary(std::string_view text) {
    std::string comment;
    while (text.starts_with("#")) {
        const std::size_t end = text.find('\n');
        comment += text.substr(1, end - 1);
        text.remove_prefix(end + 1);
    }
    comment += ' ';
    return comment.substr(1, comment.find(". ") - 1);
}

/// The example whose name differs from `name` by one or two letters; std::nullopt if there is none.
std::optional<std::string_view> misspelt_example(std::string_view name) {
    std::vector<std::string_view> names;
    for (const Example& one : kExamples) names.push_back(one.name);
    const auto meant = nearest(name, names);
    constexpr std::size_t kMaxEdits = 2;
    return meant && edit_distance(name, *meant) <= kMaxEdits ? meant : std::nullopt;
}

/// The file of the scene that a sweep file varies; empty for a scene.
std::string scene_in(std::string_view text) {
    constexpr std::string_view kKey = "\nscene = \"";
    const std::size_t key = text.find(kKey);
    if (key == std::string_view::npos) return "";
    text.remove_prefix(key + kKey.size());
    return std::string(text.substr(0, text.find('"')));
}

struct InitOptions {
    std::string name = "scene";
    bool force = false;
};

ExitCode write_scene(const Console& console, const InitOptions& options) {
    const bool is_toml = std::filesystem::path(options.name).extension() == ".toml";
    const std::string path = options.name + (is_toml ? "" : ".toml");
    const std::string name = std::filesystem::path(path).stem().string();
    const Example* const named = find_example(name);
    // A name with a folder or an ending is that of a file; another one may be a misspelt example.
    const bool is_file = options.name == "scene" || is_toml || options.name != name;
    if (const auto meant = misspelt_example(name); named == nullptr && !is_file && meant)
        throw_usage(
            "there is no example {0}; for the example {1}: corda init {1}; for a scene of this name: corda "
            "init {2}",
            name, *meant, path);
    const Example& example = named != nullptr ? *named : *find_example(kStart);
    std::vector<std::pair<std::string, std::string_view>> files{{path, example.text}};
    const std::string scene = scene_in(example.text);
    if (!scene.empty())
        files.emplace_back((std::filesystem::path(path).parent_path() / scene).string(),
                           find_example(std::filesystem::path(scene).stem().string())->text);
    for (const auto& [file_path, text] : files) check_output(file_path, {}, options.force);
    for (const auto& [file_path, text] : files) save_file(file_path, text, {.force = options.force});
    if (named == nullptr && !is_file)
        console.info(fmt::format(
            "there is no example {}, and {} is the scene to start from; corda examples lists them", name,
            path));
    const std::string stem = path.substr(0, path.size() - std::string_view(".toml").size());
    console.info(
        scene.empty()
            ? fmt::format("example {}; draw it with: corda render {} -o {}.mp4", example.name, path, stem)
            : fmt::format("example {}; make its samples with: python3 -m corda sweep {} -o {}", example.name,
                          path, stem));
    nlohmann::json outputs = nlohmann::json::array();
    for (const auto& [file_path, text] : files) {
        console.result(file_path);
        outputs.push_back({{"path", file_path}});
    }
    console.report({{"schema", 1}, {"output", path}, {"outputs", outputs}, {"example", example.name}});
    return ExitCode::kOk;
}

ExitCode list_examples(const Console& console) {
    nlohmann::json list = nlohmann::json::array();
    std::size_t width = 0;
    for (const Example& example : kExamples) width = std::max(width, example.name.size());
    for (const Example& example : kExamples) {
        const std::string text = summary(example.text);
        console.result(fmt::format("{:<{}}  {}", example.name, width, text));
        list.push_back({{"name", example.name}, {"summary", text}});
    }
    console.report({{"schema", 1}, {"examples", list}});
    return ExitCode::kOk;
}

}  // namespace

void add_init(CLI::App& app, Action& action) {
    auto [command, options] = add_command(
        app, action, "init", "write a commented scene to start from, or an example of a scene or a sweep",
        write_scene);
    command.add_option("NAME", options.name,
                       "an example, or any other name for the scene to start from; scene if left out");
    command.add_flag("--force", options.force, "replace an existing file");
}

void add_examples(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("examples", "list the scenes and sweeps that init can write");
    command->callback([&action] { action = list_examples; });
}

}  // namespace corda::app
