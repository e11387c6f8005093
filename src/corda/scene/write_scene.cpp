#include "corda/scene/write_scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <typeindex>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/text.hpp"
#include "corda/scene/document.hpp"
#include "corda/scene/field.hpp"
#include "corda/scene/readers.hpp"

namespace corda {

using namespace scene;  // the schema

namespace {

[[noreturn]] void fail_unwritable(const std::string& problem) {
    throw_usage("a scene file cannot give this scene: {}", problem);
}

/// A definition that fills a part of a table.
struct Part {
    std::type_index type;
    const void* def;
};

template <class Def>
Part part(const Def& def) {
    return {typeid(Def), &def};
}

/// One table of a scene file.
struct Table {
    std::string section;  ///< as in the schema, "rope"
    std::string path;     ///< as in messages, "rope[0]"
    std::vector<Table> inlined;
    std::vector<std::pair<std::string, std::string>> values;  ///< keys and their TOML
};

/// The keys of a section that are bound to one of `parts`, except `skipped`.
Table table_of(std::string section, std::string path, std::initializer_list<Part> parts,
               std::initializer_list<std::string_view> skipped = {}) {
    Table table{std::move(section), std::move(path), {}, {}};
    for (const Key& key : keys_of(table.section)) {
        if (std::ranges::find(skipped, key.name) != skipped.end()) continue;
        for (const Field& field : key.binding.fields) {
            const auto part = std::ranges::find(parts, field.def, &Part::type);
            if (part == parts.end()) continue;
            if (std::string toml = field.toml(key, part->def); !toml.empty())
                table.values.emplace_back(key.name, std::move(toml));
        }
    }
    return table;
}

bool are_same(Vec2 a, Vec2 b) {
    return a == b && std::signbit(a.x) == std::signbit(b.x) && std::signbit(a.y) == std::signbit(b.y);
}

/// True if `shape` gives the particles, and the bars, of `body`.
template <class Shape, class Body>
bool gives(const Shape& shape, const Body& body) {
    Body made;
    place(shape, made);
    if constexpr (std::is_same_v<Body, NetDef>) {
        if (made.bars != body.bars) return false;
    }
    return are_same(made.origin_m, body.origin_m) &&
           std::ranges::equal(made.points_m, body.points_m, are_same);
}

/// The line on which the particles of a rope may lie.
std::optional<LineDef> line_of(const RopeDef& rope) {
    if (rope.points_m.size() < 2) return std::nullopt;
    return LineDef{static_cast<int>(rope.points_m.size()), rope.origin_m, rope.points_m[1]};
}

/// The grid that a net may be. Its first row ends where y changes.
std::optional<GridDef> grid_of(const NetDef& net) {
    const std::size_t count = net.points_m.size();
    std::size_t columns = 0;
    while (columns < count && net.points_m[columns].y == net.points_m.front().y) ++columns;
    if (columns == 0 || count % columns != 0 || count < 2) return std::nullopt;
    const std::size_t rows = count / columns;
    const Vec2 spacing_m{columns > 1 ? net.points_m[1].x : 1.0,
                         rows > 1 ? 0.0 - net.points_m[columns].y : 1.0};
    return GridDef{static_cast<int>(columns), static_cast<int>(rows), net.origin_m, spacing_m,
                   !net.bars.empty() && !net.bars.back().is_real};
}

/// Its lists of tables.
template <class Body>
void add_lists(const Body& body, Table& table) {
    if (!body.moves.empty()) table.values.emplace_back("moves", toml_text(body.moves));
    if (!body.releases.empty()) table.values.emplace_back("release", toml_text(body.releases));
    if (!body.cuts.empty()) table.values.emplace_back("cut", toml_text(body.cuts));
}

Table rope_table(const RopeDef& rope, const BodyStyleDef& style, const ShapeDef& shape, std::size_t i) {
    const std::string path = fmt::format("rope[{}]", i);
    const auto with = [&](const char* name, const auto& def) {
        Table table = table_of("rope", path, {part(rope), part(style)}, {"points", "origin"});
        add_lists(rope, table);
        table.inlined.push_back(
            table_of(fmt::format("rope.{}", name), fmt::format("{}.{}", path, name), {part(def)}));
        return table;
    };
    if (!rope.closed) {
        if (const auto* hang = std::get_if<HangDef>(&shape); hang != nullptr && gives(*hang, rope))
            return with("hang", *hang);
        if (const auto* arms = std::get_if<ArmsDef>(&shape); arms != nullptr && gives(*arms, rope))
            return with("hang", *arms);
        if (const auto line = line_of(rope); line && gives(*line, rope)) return with("line", *line);
    }
    Table table = table_of("rope", path, {part(rope), part(style)});
    add_lists(rope, table);
    return table;
}

Table net_table(const NetDef& net, const BodyStyleDef& style, const ShapeDef& shape, std::size_t i) {
    const std::string path = fmt::format("net[{}]", i);
    const auto* given = std::get_if<GridDef>(&shape);
    std::optional<GridDef> grid;
    if (given != nullptr && gives(*given, net))
        grid = *given;
    else if (grid = grid_of(net); grid && !gives(*grid, net))
        grid.reset();
    Table table = grid ? table_of("net", path, {part(net), part(style)}, {"points", "origin", "bars"})
                       : table_of("net", path, {part(net), part(style)});
    add_lists(net, table);
    if (!grid) return table;
    table.inlined.push_back(table_of("net.grid", path + ".grid", {part(*grid)}));
    return table;
}

/// A table of [solver] or [[solver.bodies]].
Table solver_table(std::string section, std::string path, const SolverDef& solver, SolverTable keys) {
    const bool relaxes = std::holds_alternative<RelaxationDef>(solver);
    const auto is_default = [](int reach) { return reach == 1; };
    if (!relaxes && std::ranges::all_of(keys.reach, is_default)) keys.reach.clear();
    keys.method = solver_name(solver);
    Table table = std::visit(
        [&](const auto& def) {
            return table_of(std::move(section), std::move(path), {part(keys), part(def)});
        },
        solver);
    // A part of the motion that no key gives.
    if (const auto* rattle = std::get_if<RattleDef>(&solver);
        rattle != nullptr && rattle->guard != RattleDef{}.guard)
        table.values.emplace_back("guard", toml_text(rattle->guard));
    return table;
}

std::vector<Table> solver_tables(const Scene& scene) {
    std::vector<bool> is_named(scene.ropes.size());
    std::vector<Table> bodies;
    for (const BodySolverDef& group : scene.body_solvers) {
        SolverTable keys{{}, {}, group.ropes, group.nets};
        for (const std::uint32_t rope : group.ropes) {
            if (rope >= scene.ropes.size()) continue;  // parse_scene() refuses it
            is_named[rope] = true;
            keys.reach.push_back(scene.ropes[rope].reach);
        }
        bodies.push_back(solver_table("solver.bodies", fmt::format("solver.bodies[{}]", bodies.size()),
                                      solver_of(group.method), std::move(keys)));
    }
    SolverTable keys;
    for (std::size_t i = 0; i < scene.ropes.size(); ++i)
        if (!is_named[i]) keys.reach.push_back(scene.ropes[i].reach);
    bodies.insert(bodies.begin(), solver_table("solver", "solver", scene.solver, std::move(keys)));
    return bodies;
}

std::vector<Table> camera_tables(const CameraDef& camera) {
    std::vector<Table> tables{table_of("camera", "camera", {part(camera)})};
    for (std::size_t i = 0; i < camera.path.size(); ++i)
        tables.push_back(table_of("camera.path", fmt::format("camera.path[{}]", i), {part(camera.path[i])}));
    return tables;
}

/// The tables of one definition each. A scene's name and its jobs change no byte of a video.
std::vector<Table> plain_tables(const Scene& scene) {
    std::vector<Table> tables{table_of("world", "world", {part(scene.world)}),
                              table_of("video", "video", {part(scene.video)}, {"jobs"}),
                              table_of("style", "style", {part(scene.style)}),
                              table_of("overlay", "overlay", {part(scene.overlay)})};
    if (Table ranges = table_of("overlay.plot_range", "overlay.plot_range", {part(scene.overlay.plot_range)});
        !ranges.values.empty())
        tables.push_back(std::move(ranges));
    if (scene.world.gusts != WaveDef{})
        tables.push_back(table_of("world.gusts", "world.gusts", {part(scene.world.gusts)}));
    for (std::size_t i = 0; i < scene.overlay.texts.size(); ++i)
        tables.push_back(
            table_of("overlay.texts", fmt::format("overlay.texts[{}]", i), {part(scene.overlay.texts[i])}));
    for (Table& table : camera_tables(scene.camera)) tables.push_back(std::move(table));
    return tables;
}

std::vector<Table> body_tables(const Scene& scene) {
    const auto at = [](const auto& list, std::size_t i) {
        return i < list.size() ? list[i] : typename std::decay_t<decltype(list)>::value_type{};
    };
    std::vector<Table> tables;
    for (const RopeDef& rope : scene.ropes) {
        const std::size_t i = tables.size();
        tables.push_back(rope_table(rope, at(scene.body_styles, i), at(scene.shapes, i), i));
    }
    for (const NetDef& net : scene.nets) {
        const std::size_t i = tables.size();
        tables.push_back(
            net_table(net, at(scene.body_styles, i), at(scene.shapes, i), i - scene.ropes.size()));
    }
    return tables;
}

/// All tables of a scene file.
struct Tables {
    explicit Tables(const Scene& scene)
        : solver(solver_tables(scene)), plain(plain_tables(scene)), bodies(body_tables(scene)) {}

    std::vector<Table> solver;
    std::vector<Table> plain;
    std::vector<Table> bodies;
};

/// "{ links = 30, length = 1 }".
std::string inline_text(const Table& table) {
    std::vector<std::string> values;
    for (const auto& [key, toml] : table.values) values.push_back(fmt::format("{} = {}", key, toml));
    return fmt::format("{{ {} }}", fmt::join(values, ", "));
}

std::string last_name(const std::string& section) {
    return section.substr(section.rfind('.') + 1);
}

std::string lines_of(const Table& table) {
    std::string lines;
    for (const Table& inner : table.inlined)
        lines += fmt::format("{} = {}\n", last_name(inner.section), inline_text(inner));
    for (const auto& [key, toml] : table.values) {
        if (find_key(table.section, key) == nullptr)
            fail_unwritable(fmt::format("there is no key {}.{}", table.path, key));
        if (key == "reach" && toml.starts_with('['))
            fail_unwritable("the ropes of one method differ in reach; give all of them one");
        lines += fmt::format("{} = {}\n", key, toml);
    }
    return lines;
}

std::string text_of(const Table& table) {
    const bool is_list = key_of_section(table.section)->type.kind == Kind::kTables;
    return (is_list ? fmt::format("\n[[{}]]\n", table.section) : fmt::format("\n[{}]\n", table.section)) +
           lines_of(table);
}

void add_to(std::map<std::string, std::string>& values, const Table& table) {
    for (const Table& inner : table.inlined) add_to(values, inner);
    for (const auto& [key, toml] : table.values) values.emplace(dotted(table.path, key), toml);
}

std::map<std::string, std::string> values_of(const Tables& tables) {
    std::map<std::string, std::string> values;
    for (const auto* const some : {&tables.solver, &tables.plain, &tables.bodies})
        for (const Table& table : *some) add_to(values, table);
    return values;
}

}  // namespace

std::string write_scene(const Scene& scene) {
    const Tables tables(scene);
    std::string toml = "schema = 1\n";
    for (const auto* const some : {&tables.solver, &tables.plain, &tables.bodies})
        for (const Table& table : *some) toml += text_of(table);
    std::vector<KeyChange> changes;
    try {
        changes = differences(values_of(tables), values_of(parse_scene(toml, scene.source)));
    } catch (const Error& error) {
        fail_unwritable(error.what());
    }
    if (!changes.empty()) fail_unwritable(changes_text(changes));
    return toml;
}

std::string write_solver_and_camera(const Scene& scene) {
    std::string toml;
    for (const Table& table : solver_tables(scene)) toml += text_of(table);
    for (const Table& table : camera_tables(scene.camera)) toml += text_of(table);
    return toml.substr(1);
}

std::map<std::string, std::string> values_of(const Scene& scene) {
    return values_of(Tables(scene));
}

std::vector<KeyChange> differences(const std::map<std::string, std::string>& now,
                                   const std::map<std::string, std::string>& before) {
    std::vector<KeyChange> changes;
    for (const auto& [key, value] : now) {
        const auto old = before.find(key);
        if (old == before.end())
            changes.push_back({key, value, {}});
        else if (old->second != value)
            changes.push_back({key, value, old->second});
    }
    for (const auto& [key, value] : before)
        if (!now.contains(key)) changes.push_back({key, {}, value});
    return changes;
}

std::string changes_text(const std::vector<KeyChange>& changes) {
    constexpr std::size_t kMaxNamed = 20;
    constexpr std::size_t kMaxValue = 64;
    std::string text;
    for (std::size_t i = 0; i < std::min(changes.size(), kMaxNamed); ++i) {
        const auto& [key, given, given_before, is_set] = changes[i];
        const std::string now = given.value_or("not given");
        const std::string before = given_before.value_or("not given");
        const bool is_long = std::max(now.size(), before.size()) > kMaxValue;
        text += (i > 0 ? ", " : "") + key +
                (is_long ? " has other values" : fmt::format(" is {} and was {}", now, before)) +
                (is_set ? " (by --set)" : "");
    }
    if (changes.size() > kMaxNamed) text += fmt::format(", and {} more", changes.size() - kMaxNamed);
    return text;
}

void check_definitions(const Scene& scene) {
    Problems problems(scene.source);
    const auto check = [&](const Table& table) {
        for (const auto& [name, toml] : table.values) {
            const Key* const key = find_key(table.section, name);
            // The reach is one of the ropes, which may differ here; any Color is valid.
            if (key != nullptr && name != "reach" && key->type.kind != Kind::kColor)
                check_value(*key, toml, dotted(table.path, name), problems);
        }
    };
    for (const Table& table : plain_tables(scene)) check(table);
    for (const Table& table : solver_tables(scene)) check(table);
    for (std::size_t i = 0; i < scene.body_styles.size(); ++i) {
        const bool is_rope = i < scene.ropes.size();
        check(table_of("rope",
                       is_rope ? fmt::format("rope[{}]", i) : fmt::format("net[{}]", i - scene.ropes.size()),
                       {part(scene.body_styles[i])}));
    }
    const auto check_all = [&](std::string_view section, const auto& def, const auto&... more) {
        for (const DefProblem& one : problems_of(def, more...))
            problems.add(toml::source_region{}, dotted(section, one.key), one.what, one.remedy);
    };
    check_all("video", scene.video);
    for (std::size_t i = 0; i < scene.overlay.texts.size(); ++i)
        check_all(fmt::format("overlay.texts[{}]", i), scene.overlay.texts[i]);
    check_all("overlay", scene.overlay, scene.ropes);
    check_all("overlay.plot_range", scene.overlay.plot_range, scene.overlay.plots);
    if (const auto problem = problem_of_texts(scene))
        problems.add(toml::source_region{}, "overlay.font", problem->what, problem->remedy);
    check_all("style", scene.style, scene.ropes, scene.nets);
    check_all("camera", scene.camera, scene.ropes.size() + scene.nets.size());
    if (scene.golden) {
        check(table_of("golden", "golden", {part(*scene.golden)}));
        check_all("golden", *scene.golden);
    }
    problems.throw_if_any();
}

}  // namespace corda
