#include "corda/scene/rows.hpp"

namespace corda::scene {
namespace {

/// One number is the gravity downwards.
Binding gravity() {
    return custom_field<WorldDef>(
        [](const Value& value, WorldDef& def) {
            // 0 - g and not -g: no gravity is +0.
            def.gravity_m_s2 = value.is_list() ? value.as<Vec2>() : Vec2{0.0, 0.0 - value.as<double>()};
        },
        [](const WorldDef& def) {
            const Vec2 g = def.gravity_m_s2;
            const bool is_down = toml_text(g.x) == "0" && toml_text(g.y) != "-0.0";
            return is_down ? toml_text(0.0 - g.y) : toml_text(g);
        });
}

/// The keys of a wave with amplitudes in `unit`.
std::vector<Key> wave_keys(std::string_view section, std::string_view unit) {
    constexpr Range kFrequency{.low = 0.0, .high = WaveDef::kMaxFrequencyHz, .low_open = true};
    return {
        {section, "amplitude", pair("[x, y]", kCoordinate), unit, required(field(&WaveDef::amplitude)),
         "the amplitude"},
        {section, "frequency", number(kFrequency), "Hz", required(field(&WaveDef::frequency_hz)),
         "the frequency"},
        {section, "phase_deg", number(), "degrees", field(&WaveDef::phase_deg), "the phase at the start"},
    };
}

std::vector<Key> world_keys() {
    return {
        {"world", "gravity", or_pair(number(), "[gx, gy]"), "m/s2", gravity(), "the gravity, downwards"},
        {"world", "duration", number(kAbove0), "s", field(&WorldDef::duration_s), "the duration",
         "a video has the frames that start before it"},
        {"world", "drag", number(kFrom0), "1/s", field(&WorldDef::drag_1_s), "the drag",
         "in still air, velocities decay by exp(-drag t)"},
        {"world", "wind", pair("[vx, vy]", kCoordinate), "m/s", field(&WorldDef::wind_m_s),
         "the velocity of the air", "acceleration -drag (v - wind)"},
        {"world", "gusts", of(Kind::kTable), "", none(),
         "gusts = { amplitude = [2.0, 0.0], frequency = 0.4 }",
         "added to the wind: amplitude sin(2 pi frequency t + phase)"},
    };
}

/// One colour, or a list of colours of the links.
Binding body_color() {
    return body_field<BodyStyleDef>([](const BodyStyleDef& def) -> std::string {
        if (!def.link_colors.empty()) return toml_text(def.link_colors);
        return def.color ? toml_text(*def.color) : "";
    });
}

/// One width, or those of the first link and the last.
Binding body_width() {
    return custom_field<BodyStyleDef>(
        [](const Value& value, BodyStyleDef& def) {
            def.width_px = (value.is_list() ? value.at(0) : value).as<double>();
            if (value.is_list()) def.end_width_px = value.at(1).as<double>();
        },
        [](const BodyStyleDef& def) -> std::string {
            if (def.width_px && def.end_width_px) return toml_text(Vec2{*def.width_px, *def.end_width_px});
            return def.width_px ? toml_text(*def.width_px) : "";
        });
}

/// One value for all particles, or a list; `initial` if code has left it empty.
template <class Def, class T>
Binding all_of(std::vector<T> Def::*member, const T& initial) {
    return body_field<Def>([member, initial](const Def& def) {
        return (def.*member).empty() ? toml_text(initial) : toml_of_all(def.*member);
    });
}

/// `keys` and those that ropes and nets have in common.
template <class Def>
std::vector<Key> body_keys(std::string_view section, std::vector<Key> keys, std::string_view width) {
    const Type mass = or_list(number(kMass), "a list with one per particle");
    const Type velocity = or_list(pair("[vx, vy]", kAny), "a list with one such pair per particle");
    constexpr bool kIsNet = std::is_same_v<Def, NetDef>;
    Type color = or_list(of(Kind::kColor), "a list with one per link, in turn");
    color.min_entries = 1;
    const std::vector<Key> common{
        {section, "points", pairs(Kind::kNumber, "[x, y]", 2, kCoordinate), "m",
         body_field<Def>([](const Def& def) { return def.points_m.empty() ? "" : toml_text(def.points_m); }),
         "the positions of the particles"},
        {section, "origin", pair("[x, y]", kCoordinate), "m",
         otherwise("points are in the world",
                   body_field<Def>([](const Def& def) { return toml_text(def.origin_m); })),
         "the position that points are relative to", "only for points"},
        {section, "mass", mass, "kg", all_of(&Def::mass_kg, kDefaultMassKg), "the mass of a particle"},
        {section, "velocity", velocity, "m/s", all_of(&Def::velocity_m_s, Vec2{}),
         "the velocity of the particles at the start",
         "what bars of fixed length cannot follow is left out, with a warning"},
        {section, "compliance", number({.low = 0.0, .high = 1e6}), "1/N",
         field_at<Def>([](auto& def) -> auto& { return def.material.compliance_1_n; }),
         "the strain per newton of tension, 1/(E A)", "at 0 all lengths are kept"},
        {section, "moves", of(Kind::kTables), "", none(),
         "moves = [{ pin = 0, waves = [{ amplitude = [0.1, 0.0], frequency = 1.0 }] }]",
         "the sum of waves and a path moves a pinned particle"},
        {section, "release", of(Kind::kTables), "", none(), "release = [{ pin = -1, t = 2.0 }]",
         "pins that are let go: free from then on, with the velocity that they have"},
        {section, "cut", of(Kind::kTables), "", none(), "cut = [{ link = 12, t = 3.0 }]",
         "links that are gone from then on"},
        {section, "color", color, "", otherwise("the next of style.palette", body_color()), "the colour",
         "a list: of its links in turn, with style.color_by = \"link\""},
        {section, "width_px", kIsNet ? number(kWidthPx) : or_pair(number(kWidthPx), "[first, last]"), "px",
         otherwise(width, body_width()), "the width", kIsNet ? "" : "a pair: of its first link and its last"},
        {section, "merged", of(Kind::kBoolean), "", field(&BodyStyleDef::merged),
         "drawn in one layer with the body before",
         "without a gap between them, in a gradient of colours; no outlines of balls"},
        {section, "label", of(Kind::kText), "", field(&BodyStyleDef::label),
         "the name, drawn at its pin or its free end",
         "shortened to 0.3 of the width of the picture; in legends, tables and messages too"},
    };
    keys.insert(keys.end(), common.begin(), common.end());
    return keys;
}

/// The keys of the moves of ropes' or nets' pins.
std::vector<Key> move_keys(bool are_of_nets) {
    const std::string_view moves = are_of_nets ? "net.moves" : "rope.moves";
    const std::string_view waves = are_of_nets ? "net.moves.waves" : "rope.moves.waves";
    const std::string_view path = are_of_nets ? "net.moves.path" : "rope.moves.path";
    Type pin = of(Kind::kInteger);
    if (are_of_nets) pin = or_pair(pin, "[column, row]");
    std::vector<Key> keys{
        {moves, "pin", pin, "",
         required(body_field<MoveDef>([](const MoveDef& def) { return toml_text(def.pin); })),
         "the index of a pinned particle", "-1 is the last"},
        {moves, "waves", of(Kind::kTables), "", none(),
         "waves = [{ amplitude = [0.1, 0.0], frequency = 1.0, phase_deg = 90.0 }]",
         "amplitude (sin(2 pi frequency t + phase) - sin(phase))"},
        {moves, "path", of(Kind::kTables), "", none(),
         "path = [{ t = 0.0, by = [0.0, 0.0] }, { t = 1.0, by = [1.0, 0.0] }]",
         "the way of least jerk from key to key, at rest at each"},
    };
    for (Key& key : wave_keys(waves, "m")) keys.push_back(std::move(key));
    keys.push_back(
        {path, "t", number(kFrom0), "s", required(field(&PathKeyDef::time_s)), "the time of the key"});
    keys.push_back({path, "by", pair("[dx, dy]", kCoordinate), "m", required(field(&PathKeyDef::by_m)),
                    "the displacement from the place in the scene"});
    return keys;
}

/// The keys of the pins of ropes or nets that are let go, and of their links that are cut.
std::vector<Key> event_keys(bool are_of_nets) {
    const std::string_view release = are_of_nets ? "net.release" : "rope.release";
    const std::string_view cut = are_of_nets ? "net.cut" : "rope.cut";
    Type pin = of(Kind::kInteger);
    if (are_of_nets) pin = or_pair(pin, "[column, row]");
    return {
        {release, "pin", pin, "",
         required(body_field<ReleaseDef>([](const ReleaseDef& def) { return toml_text(def.pin); })),
         "the index of a pinned particle", "-1 is the last"},
        {release, "t", number(kFrom0), "s", required(field(&ReleaseDef::time_s)),
         "the time from which it is free"},
        {cut, "link", of(Kind::kInteger), "",
         required(body_field<CutDef>([](const CutDef& def) { return toml_text(def.link); })),
         "the index of a link, -1 is the last",
         are_of_nets ? "those of a grid go along the rows, then along the columns, from the upper left"
                     : "link k joins particles k and k + 1"},
        {cut, "t", number(kFrom0), "s", required(field(&CutDef::time_s)), "the time from which it is gone",
         are_of_nets ? "diagonals of its cells go with it" : ""},
    };
}

std::vector<Key> rope_shapes() {
    return {
        {"rope", "line", of(Kind::kTable), "", none(),
         "line = { particles = 40, from = [0.0, 0.0], step = [0.0, -1.0] }",
         "exactly one of line, hang and points"},
        {"rope", "hang", of(Kind::kTable), "", none(),
         "hang = { links = 20, length = 1.0, angle_deg = 45.0 }",
         "or one of arms: hang = { lengths = [1.0, 0.5], angles_deg = [90.0, 0.0], rates_deg_s = [0.0, "
         "360.0] }"},
    };
}

template <class Def>
Binding is_string() {
    return field_at<Def>([](auto& def) -> auto& { return def.material.is_string; });
}

std::vector<Key> rope_keys() {
    const Type boolean = of(Kind::kBoolean);
    return {
        {"rope", "label_at", one_of({"pin", "end"}), "",
         otherwise("pin, unless labels share it", field(&BodyStyleDef::label_at)), "where label is drawn",
         "end: next to the free end; a rope without one has its label at a pin"},
        {"rope", "payload", number({.low = 0.0, .high = kMass.high}), "kg", field(&RopeDef::payload_kg),
         "the mass added to the last particle"},
        {"rope", "pinned", list(Kind::kInteger, 0), "",
         body_field<RopeDef>([](const RopeDef& def) { return toml_text(def.pinned); }),
         "the indices of the particles that rest, or move by moves", "-1 is the last, [] a free rope"},
        {"rope", "closed", boolean, "", field(&RopeDef::closed), "the last point is tied to the first",
         "only for points, at least 3"},
        {"rope", "string", boolean, "", is_string<RopeDef>(), "links pull and never push",
         "without compliance they come taut plastically"},
        {"rope", "bending", number({.low = 0.0, .high = 1e12}), "N m2", field(&RopeDef::bending_n_m2),
         "the bending stiffness E I", "not for a string"},
        {"rope", "copies", of(Kind::kTable), "", none(), "copies = { count = 50, angle_deg = 0.001 }",
         "more ropes, each turned that much further about its first pin, and merged"},
        {"rope", "link_length", or_list(number(kLength), "a list with one per link"), "m",
         otherwise("the distance at the start",
                   body_field<RopeDef>([](const RopeDef& def) { return toml_of_all(def.rest_m); })),
         "the length of a link at rest",
         "needs compliance or string; a string that is too short for its points starts pulled in towards the "
         "pin"},
    };
}

/// Written as links.
Binding hang_particles() {
    return custom_field<HangDef>([](const Value& value, HangDef& def) { def.links = value.as<int>() - 1; },
                                 [](const HangDef&) { return std::string(); });
}

/// Written as velocities.
Binding arm_rates() {
    return custom_field<ArmsDef>(
        [](const Value& value, ArmsDef& def) { def.rates_deg_s = value.as<std::vector<double>>(); },
        [](const ArmsDef&) { return std::string(); });
}

std::vector<Key> rope_shape_keys() {
    const auto per_link = [](const Range& range) {
        Type type = list(Kind::kNumber, 1);
        type.range = range;
        type.list = "a list with one per link";
        return type;
    };
    const Type from = pair("[x, y]", kCoordinate);
    const std::string_view first = "the position of the first particle";
    return {
        {"rope.line", "particles", integer(2, kMaxParticles), "", required(field(&LineDef::particles)),
         "the number of particles"},
        {"rope.line", "from", from, "m", field(&LineDef::from_m), first},
        {"rope.line", "step", pair("[dx, dy]", kCoordinate), "m", required(field(&LineDef::step_m)),
         "the way from one particle to the next"},
        {"rope.copies", "count", integer(2, 10'000), "", required(field(&CopiesDef::count)),
         "the number of ropes, with this one"},
        {"rope.copies", "angle_deg", number(), "degrees", field(&CopiesDef::angle_deg),
         "the angle from one to the next", "positive to +x for what hangs"},
        {"rope.hang", "links", integer(1, kMaxParticles - 1), "",
         otherwise("particles - 1", field(&HangDef::links)), "the number of links"},
        {"rope.hang", "particles", integer(2, kMaxParticles), "", otherwise("links + 1", hang_particles()),
         "the number of particles", "exactly one of links and particles"},
        {"rope.hang", "length", number(kAbove0), "m",
         otherwise("the sum of lengths", field(&HangDef::length_m)), "the length of the whole rope"},
        {"rope.hang", "angle_deg", number(), "degrees", field(&HangDef::angle_deg),
         "the angle from straight down, positive to +x"},
        {"rope.hang", "lengths", per_link(kLength), "m",
         otherwise("length / links", field(&ArmsDef::lengths_m)), "the length of each link",
         "in place of links, particles, length and angle_deg"},
        {"rope.hang", "angles_deg", per_link(kAny), "degrees",
         otherwise("required with lengths", field(&ArmsDef::angles_deg)),
         "the angle of each link from straight down, positive to +x"},
        {"rope.hang", "rates_deg_s", per_link(kAny), "degrees/s", otherwise("at rest", arm_rates()),
         "the angular velocity of each link at the start", "with lengths, and in place of velocity"},
        {"rope.hang", "from", from, "m", either(field(&HangDef::from_m), field(&ArmsDef::from_m)), first},
    };
}

std::vector<Key> net_shapes() {
    return {
        {"net", "grid", of(Kind::kTable), "", none(), "grid = { columns = 40, rows = 30, spacing = 0.1 }",
         "exactly one of grid and points"},
    };
}

/// One number for both directions.
Binding spacing() {
    return custom_field<GridDef>(
        [](const Value& value, GridDef& def) {
            def.spacing_m = value.is_list() ? value.as<Vec2>() : Vec2{value.as<double>(), value.as<double>()};
        },
        [](const GridDef& def) {
            const Vec2 d = def.spacing_m;
            return d.x == d.y ? toml_text(d.x) : toml_text(d);
        });
}

std::vector<Key> net_keys() {
    Type pinned = list(Kind::kInteger, 0);
    pinned.forms |= kPairs;
    pinned.pair = "[column, row]";
    const Type boolean = of(Kind::kBoolean);
    return {
        {"net", "bars", pairs(Kind::kInteger, "[a, b]", 1), "",
         body_field<NetDef>([](const NetDef& def) { return def.bars.empty() ? "" : toml_text(def.bars); }),
         "the particles that each bar joins", "required with points; -1 is the last particle"},
        {"net", "pinned", pinned, "",
         otherwise("the upper corners of a grid, [0] of points",
                   body_field<NetDef>([](const NetDef& def) { return toml_text(def.pinned); })),
         "the indices of the particles that rest, or move by moves",
         "-1 is the last; a grid also takes [column, row]"},
        {"net", "string", boolean, "", is_string<NetDef>(), "bars pull and never push", "needs compliance"},
        {"net.grid", "columns", integer(1, kMaxParticles), "", required(field(&GridDef::columns)),
         "the number of particles in a row", "indices go row by row from the upper left"},
        {"net.grid", "rows", integer(1, kMaxParticles), "", required(field(&GridDef::rows)),
         "the number of rows"},
        {"net.grid", "from", pair("[x, y]", kCoordinate), "m", field(&GridDef::from_m),
         "the position of the upper left particle"},
        {"net.grid", "spacing", or_pair(number(kDistance), "[dx, dy]"), "m", required(spacing()),
         "the distance from one particle to the next"},
        {"net.grid", "diagonals", boolean, "", field(&GridDef::has_diagonals),
         "two imaginary bars cross in each cell",
         "they keep cells from shearing: a rigid net becomes a plate, and one that stretches a stiff sheet; "
         "without them it drapes, unless its pins hold a straight row of links"},
    };
}

/// The orders of `rattle`.
Words order_words() {
    static const std::vector<std::string> words = [] {
        std::vector<std::string> texts;
        for (const int order : RattleDef::kOrders) texts.push_back(std::to_string(order));
        return texts;
    }();
    return {words.begin(), words.end()};
}

/// One value if the ropes of the table have the same, as in every file.
Binding reach() {
    return custom_field<SolverTable>(
        [](const Value& value, SolverTable& table) { table.reach = {value.as<int>()}; },
        [](const SolverTable& table) { return table.reach.empty() ? "" : toml_of_all(table.reach); });
}

/// The keys of the methods that a scene names.
std::vector<Key> method_keys(std::string_view section) {
    constexpr Range kTolerance{.low = ExactDef::kMinTolerance, .high = ExactDef::kMaxTolerance};
    return {
        {section, "tolerance", number(kTolerance), "", field(&ExactDef::tolerance),
         "the position error relative to the length of the rope"},
        {section, "implicit", of(Kind::kBoolean), "", field(&ExactDef::implicit),
         "implicit steps, whose number hardly grows with that of the links at tolerances of 1e-5 and more",
         "for ropes that hang from pins"},
        {section, "order", one_of(order_words(), Kind::kInteger), "", field(&RattleDef::order), "the order"},
        {section, "step", number({.low = 1e-9}), "s",
         otherwise("one frame; rattle: a stable part of one",
                   either(field(&RattleDef::step_s), field(&RelaxationDef::step_s))),
         "the step"},
        {section,
         "reach",
         integer(1, kMaxParticles),
         "",
         with_default(toml_text(kDefaultReach), reach()),
         "the reach",
         "ropes have bars to the next 1..reach particles",
         {RelaxationDef::kName},
         ": bars to farther particles make a straight rope a rigid rod, and its equations singular"},
        {section, "sweeps", integer(1, 1e6), "", field(&RelaxationDef::sweeps),
         "the number of passes over all bars per step"},
        {section,
         "delta",
         number({.low = 0.0, .high = 1.0, .high_open = true}),
         "",
         field(&RelaxationDef::delta),
         "the share of the velocity lost per step",
         "",
         {},
         ", or give world.drag"},
        {section,
         "force",
         pair("[fx, fy]", kAny),
         "N",
         otherwise("the weight", field(&RelaxationDef::force_n)),
         "the force on every particle",
         "in place of gravity: a light particle accelerates more",
         {},
         ", or give world.gravity"},
    };
}

std::vector<Key> solver_keys() {
    const Words methods(kMethodNames.begin(), kMethodNames.end());
    std::vector<Key> keys{
        {"solver", "method", one_of(methods), "", field(&SolverTable::method), "the method"},
        {"solver", "tolerance_px", number(kAbove0), "px", field(&AutoDef::tolerance_px),
         "the limit of the error estimate of displayed positions"},
    };
    const std::vector<Key> named = method_keys("solver");
    keys.insert(keys.end(), named.begin(), named.end());
    keys.push_back({"solver", "bodies", of(Kind::kTables), "", none(), "bodies that another method moves",
                    "solver.method moves the rest"});
    return keys;
}

/// A list that is left out if it is empty.
Binding members(std::vector<std::uint32_t> SolverTable::*list) {
    return with_default("[]", body_field<SolverTable>([list](const SolverTable& table) {
                            return (table.*list).empty() ? "" : toml_text(table.*list);
                        }));
}

std::vector<Key> solver_bodies_keys() {
    const std::string_view section = "solver.bodies";
    const Type indices = list(Kind::kInteger, 0);
    const Words methods(kMethodNames.begin() + 1, kMethodNames.end());  // all but auto
    std::vector<Key> keys{
        {section, "ropes", indices, "", members(&SolverTable::ropes), "the indices of [[rope]] tables",
         "from 0; -1 is the last"},
        {section, "nets", indices, "", members(&SolverTable::nets), "the indices of [[net]] tables",
         "from 0; -1 is the last"},
        {section, "method", one_of(methods), "", required(field(&SolverTable::method)),
         "the method of these bodies"},
    };
    const std::vector<Key> named = method_keys(section);
    keys.insert(keys.end(), named.begin(), named.end());
    return keys;
}

}  // namespace

std::vector<Key> model_rows() {
    std::vector<Key> rows;
    for (const std::vector<Key>& part :
         {world_keys(), wave_keys("world.gusts", "m/s"),
          body_keys<RopeDef>("rope", rope_shapes(), "style.rope_width_px"), rope_keys(), rope_shape_keys(),
          move_keys(false), event_keys(false), body_keys<NetDef>("net", net_shapes(), "style.net_width_px"),
          net_keys(), move_keys(true), event_keys(true), solver_keys(), solver_bodies_keys()})
        rows.insert(rows.end(), part.begin(), part.end());
    return rows;
}

}  // namespace corda::scene
