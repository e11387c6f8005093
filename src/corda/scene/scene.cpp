#include "corda/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/scene/document.hpp"
#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"
#include "corda/view/font.hpp"

namespace corda {

using namespace scene;  // the readers

namespace {

Sections sections_of(const toml::table& document, Problems& problems) {
    const TableReader root(problems, document, "", "");
    return {root.table("world"),  root.table("solver"),  root.table("video"),
            root.table("style"),  root.table("overlay"), root.table("camera"),
            root.table("golden"), root.tables("rope"),   root.tables("net")};
}

/// Adds the problems of a definition as a whole at their keys.
template <class Def, class... More>
void check_section(const TableReader& table, const Def& def, const More&... more) {
    for (const DefProblem& problem : problems_of(def, more...)) {
        const auto value = table.find(problem.key);
        if (!value) continue;
        if (problem.entry)
            value->at(*problem.entry).add_problem(problem.what, problem.remedy);
        else
            value->add_problem(problem.what, problem.remedy);
    }
}

/// Reads a table whose keys are all that there is to its definition.
template <class Def, class... More>
void read_section(const TableReader& table, Def& def, const More&... more) {
    read_fields(table, def);
    check_section(table, def, more...);
}

/// Ropes and nets, with their styles.
void read_bodies(const Sections& sections, const SceneSize& size, const SolverSection& solver, Scene& scene) {
    // One problem with style.color_by is enough.
    const bool takes_link_colors =
        scene.style.color_by == ColorBy::kLink || !sections.style.is_sound("color_by");
    scene.shapes.resize(sections.ropes.size() + sections.nets.size());
    for (const TableReader& rope : sections.ropes) {
        const std::size_t body = scene.ropes.size();
        scene.ropes.push_back(
            read_rope(rope, size.bodies[body], solver.group_of(body).reach, scene.shapes[body]));
        scene.body_styles.push_back(read_body_style(rope, takes_link_colors));
    }
    for (const TableReader& net : sections.nets) {
        const std::size_t body = scene.body_styles.size();
        scene.nets.push_back(read_net(net, size.bodies[body], scene.shapes[body]));
        scene.body_styles.push_back(read_body_style(net, takes_link_colors));
    }
}

/// One problem for all texts that cannot be shown, at the font or else at the first of them.
void check_texts(const Sections& sections, const Scene& scene) {
    const auto problem = problem_of_texts(scene);
    if (!problem) return;
    auto place = sections.overlay.find("font");
    const auto look = [&](const TableReader& table, std::string_view key) {
        const auto text = place ? std::nullopt : table.find(key);
        if (text && view::missing_glyphs({text->as<std::string>()}, "", "")) place = text;
    };
    look(sections.overlay, "title");
    for (const TableReader& text : sections.overlay.tables("texts")) look(text, "text");
    for (const TableReader& rope : sections.ropes) look(rope, "label");
    for (const TableReader& net : sections.nets) look(net, "label");
    place->add_problem(problem->what, problem->remedy);
}

[[noreturn]] void fail_io(const std::string& path, int reason) {
    if (reason == EINTR)
        throw_error(ExitCode::kInterrupted, "{}: interrupted while waiting for the scene", path);
    const bool is_denied = reason == EACCES || reason == EPERM;
    throw Error(ExitCode::kIo, Problem{{.source = path, .key = {}},
                                       fmt::format("cannot read the scene file: {}",
                                                   std::generic_category().message(reason)),
                                       is_denied ? std::string(hint_for_errno(reason, FileUse::kRead))
                                                 : "give the path of a TOML file"});
}

}  // namespace

std::string scene::read_file(const std::string& path) {
    check_path(path);
    const std::string name = source_name(path);
    const FileHandle file = path == "-" ? open_standard_input() : FileHandle(std::fopen(path.c_str(), "rb"));
    if (!file) fail_io(name, errno);
    std::string text;
    std::array<char, 65536> block{};
    while (true) {
        errno = 0;
        const std::size_t count = std::fread(block.data(), 1, block.size(), file.get());
        if (std::ferror(file.get()) != 0) fail_io(name, errno);  // also after a part: a signal came
        if (count == 0) return text;
        text.append(block.data(), count);
        check_file_bytes(name, text.size());
    }
}

std::string scene::source_name(const std::string& path) {
    return path == "-" ? "stdin" : path;
}

Scene load_scene(const std::string& path, const std::vector<Setting>& settings) {
    return parse_scene(read_file(path), source_name(path), settings);
}

Scene parse_scene(std::string_view toml, const std::string& source_name, const std::vector<Setting>& settings,
                  const PlacedSettings& more) {
    toml::table document = parse_document(toml, source_name);
    Problems problems(source_name, document);
    for (const Setting& setting : settings) apply_setting(document, setting, problems);
    for (const Setting& setting : more.settings) apply_setting(document, setting, problems, more.place);
    check_document(document, problems);
    expand_copies(document, problems);
    check_cancelled();
    const Sections sections = sections_of(document, problems);

    Scene scene;
    scene.name = std::filesystem::path(source_name).stem().string();
    scene.source = source_name;
    scene.text = toml;
    scene.settings = settings;
    scene.settings.insert(scene.settings.end(), more.settings.begin(), more.settings.end());
    read_fields(sections.world, scene.world);
    scene.has_duration = sections.world.has("duration");
    read_fields(sections.world.table("gusts"), scene.world.gusts);
    const SolverSection solver = read_solver(sections, scene);
    read_section(sections.video, scene.video);
    read_fields(sections.style, scene.style);
    read_fields(sections.overlay, scene.overlay);
    const TableReader plot_range = sections.overlay.table("plot_range");
    read_fields(plot_range, scene.overlay.plot_range);
    for (const TableReader& text : sections.overlay.tables("texts"))
        read_section(text, scene.overlay.texts.emplace_back());
    for (const TableReader& key : sections.camera.tables("path"))
        read_fields(key, scene.camera.path.emplace_back());
    read_section(sections.camera, scene.camera, sections.ropes.size() + sections.nets.size());
    if (document.contains("golden")) read_section(sections.golden, scene.golden.emplace());
    const SceneSize size = count_bodies(sections, solver, scene);
    check_work(sections, solver, size, scene);
    check_tensions(sections, solver, scene);
    check_cancelled();
    if (size.fits) read_bodies(sections, size, solver, scene);
    problems.throw_if_any();
    check_cancelled();
    check_section(sections.overlay, scene.overlay, scene.ropes);
    check_section(plot_range, scene.overlay.plot_range, scene.overlay.plots);
    check_texts(sections, scene);
    check_section(sections.style, scene.style, scene.ropes, scene.nets);
    problems.throw_if_any();
    return scene;
}

std::string_view solver_name(const SolverDef& solver) {
    return kMethodNames[solver.index()];
}

SolverDef solver_of(const MethodDef& method) {
    return std::visit([](const auto& def) { return SolverDef(def); }, method);
}

std::vector<std::string> shown_texts(const Scene& scene) {
    std::vector<std::string> texts{scene.overlay.title};
    for (const OverlayTextDef& text : scene.overlay.texts) texts.push_back(text.text);
    for (const BodyStyleDef& body : scene.body_styles) texts.push_back(body.label);
    return texts;
}

std::string font_path(const Scene& scene) {
    const std::string& font = scene.overlay.font;
    return font.empty() ? "" : (std::filesystem::path(scene.source).parent_path() / font).string();
}

System system_of(const Scene& scene) {
    System system = build_system(scene.ropes, scene.nets);
    for (std::size_t i = 0; i < std::min(scene.body_styles.size(), system.bodies.size()); ++i)
        system.bodies[i].label = scene.body_styles[i].label;
    return system;
}

System named_in_files(const Scene& scene, System system) {
    std::string label;
    int count = 1;
    for (std::size_t b = 0; b < std::min(scene.body_styles.size(), system.bodies.size()); ++b) {
        const BodyStyleDef& style = scene.body_styles[b];
        if (!style.merged || !style.label.empty()) {
            label = style.label;
            count = 1;
        } else if (!label.empty()) {
            system.bodies[b].label = fmt::format("{} {}", label, ++count);
        }
    }
    return system;
}

std::vector<SolverDef> solvers_of(const Scene& scene) {
    std::vector<SolverDef> solvers(scene.ropes.size() + scene.nets.size(), scene.solver);
    std::vector<bool> is_named(solvers.size());
    for (std::size_t i = 0; i < scene.body_solvers.size(); ++i) {
        const BodySolverDef& group = scene.body_solvers[i];
        const auto fail = [&](const std::string& problem) {
            throw_error(ExitCode::kInvalidScene, "body_solvers[{}]: {}", i, problem);
        };
        const auto name = [&](std::uint32_t index, std::size_t first, std::size_t count, const char* what) {
            if (index >= count) fail(fmt::format("names {} {} of {}", what, index, count));
            if (is_named[first + index]) fail(fmt::format("names {} {}, which has a method", what, index));
            is_named[first + index] = true;
            solvers[first + index] = solver_of(group.method);
        };
        if (group.ropes.empty() && group.nets.empty()) fail("names neither a rope nor a net");
        for (const std::uint32_t index : group.ropes) name(index, 0, scene.ropes.size(), "rope");
        for (const std::uint32_t index : group.nets)
            name(index, scene.ropes.size(), scene.nets.size(), "net");
    }
    return solvers;
}

}  // namespace corda
