#include "corda/scene/document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "corda/core/image.hpp"
#include "corda/core/removed.hpp"
#include "corda/core/text.hpp"
#include "corda/scene/schema.hpp"
#include "corda/scene/table_reader.hpp"

namespace corda::scene {
namespace {

/// For a key that another table has, first one in the table of this section: "it is a key of video".
std::string other_home(std::string_view name, std::string_view section) {
    const auto& keys = all_keys();
    const std::string inner = dotted(section, "");
    auto key = std::ranges::find_if(
        keys, [&](const Key& one) { return one.name == name && one.section.starts_with(inner); });
    if (key == keys.end()) key = std::ranges::find(keys, name, &Key::name);
    if (key == keys.end()) return "";
    return fmt::format("it is a key of {}", key->section.empty() ? "the top level" : key->section);
}

/// Advice for keys that people try and that do not exist.
struct Wish {
    std::string_view names;  ///< words between spaces
    std::string_view instead;
    std::string_view section = {};  ///< the end of those it is tried in; empty: any but those of events
    std::string_view key = {};      ///< the one that is meant; empty: perhaps none of this table
};
constexpr Wish kWishes[] = {
    {" pins pinned particle particles index node ",
     "pin is the index of one pinned particle; give a table for each", ".moves", "pin"},
    {" pins pinned particle particles index node ",
     "pin is the index of one pinned particle; give a table for each", ".release", "pin"},
    {" to by target position at displacement distance ",
     "path moves it from key to key: path = [{ t = 0.0, by = [0.0, 0.0] }, { t = 1.0, by = [1.0, 0.0] }]",
     ".moves"},
    {" to at position target x y displacement distance ",
     "by is the displacement from the place in the scene, in m; t is the time in s", ".moves.path", "by"},
    {" links bar bars segment edge index ", "link is the index of one link; give a table for each", ".cut",
     "link"},
    {" at time when from s t_s ", "t is the time in s", ".release", "t"},
    {" at time when from s t_s ", "t is the time in s", ".cut", "t"},
    {" width height ", "video.size is [width, height] in pixels", "video"},
    {" frames length ", "world.duration in s and video.fps give the number of frames", "video"},
    {" time length ", "world.duration is the duration in s", "world"},
    {" floor ground wall walls obstacle obstacles collision collisions contact bounce ",
     "ropes pass through everything: there are no floors, walls or collisions"},
    {" drive driven motor actuator oscillate shake excitation ",
     "moves of a rope or net moves a pinned particle: moves = [{ pin = 0, waves = [{ amplitude = [0.1, 0.0], "
     "frequency = 1.0 }] }]"},
    {" damping friction viscosity air_resistance resistance air_drag ",
     "world.drag slows everything: velocities decay by exp(-drag t)"},
    {" breeze storm air ", "world.wind is the velocity of the air, which acts through world.drag"},
    {" stiffness spring spring_constant elasticity elastic young youngs_modulus ea modulus stretch ",
     "compliance is the strain per newton of tension, 1/(E A); 0: links do not stretch"},
    {" bending_stiffness flexural_rigidity rigidity ei ", "bending is the key for it, of a rope"},
    {" fixed fix fixed_ends anchor anchors anchored attached attach pin pins ",
     "pinned is the list of the particles that do not move: pinned = [0, -1]"},
    {" ball bob load end_mass tip_mass bob_mass ",
     "payload of a rope is the mass added to its last particle, in kg"},
    {" density mass_per_length linear_density total_mass ", "mass is that of one particle, in kg"},
    {" theta phi angle angles angle_rad angle0 initial_angle ",
     "hang.angle_deg of a rope is its angle from straight down, in degrees, hang.angles_deg those of its "
     "links"},
    {" omega angular_velocity initial_velocity v0 ",
     "velocity of a rope or net is that of its particles at the start, in m/s; hang.rates_deg_s of a rope of "
     "arms is that of its links"},
    {" thickness diameter radius line_width linewidth width ",
     "width_px of a rope or net is its width in pixels"},
    {" particle_count segments nodes n_links num_links link_count n ",
     "hang.links and line.particles of a rope count its parts"},
    {" end until stop t_to to_s ", "to is the time in s at which the text goes", ".texts", "to"},
    {" time t start begin when from_s ", "from is the time in s at which the text appears", ".texts", "from"},
    {" tolerance threshold ",
     "max, mean and share are its limits: max is the largest difference of a pixel, 0 .. 255", "golden"},
    {" color colour colors colours ",
     "palette is the list of the colours of ropes and nets; color of a rope or net is its own", "style",
     "palette"},
    {" bg background_color bg_color ", "style.background is the background"},
    {" end to ",
     "hang gives a length and an angle, line a step from particle to particle; points = [[0, 0], [1, -1]] "
     "any shape"},
    {" name id ", "label of a rope or net is its name"},
    {" resolution dimensions ", "video.size is [width, height] in pixels"},
    {" frame_rate framerate frames_per_second rate ", "video.fps is the frames per second"},
    {" t_end tmax t_max end_time sim_time total_time ", "world.duration is the duration in s"},
    {" dt timestep time_step substeps ",
     "methods choose their step by themselves; [solver] step sets that of rattle and relaxation"},
    {" slowmo slowmotion slow_motion slow playback_speed ", "video.speed = \"1/4\" is slow motion"},
    {" motion_blur blur ", "video.shutter, 0 .. 1, blurs motion"},
    {" zoom scale view viewport bounds ",
     "camera.height is the height of the picture in m, camera.center its middle"},
    {" bitrate quality ", "video.crf sets the quality of the encoder; 1 is the best"},
    {" output file filename format ", "the command line names the output: corda render SCENE -o FILE"},
    {" seed random noise samples ", "a sweep file varies a scene at random: see python3 -m corda sweep"},
    {" include import extends ",
     "a scene is one file; --set key=value changes it, and a sweep file varies it"},
    {" gravity_y g ", "world.gravity is the gravity downwards in m/s2, or [gx, gy]"},
    {" trail trails trace ", "style.trail_s is the time in s for which the path of a particle stays"},
};

const Wish* wish_of(std::string_view name, std::string_view section) {
    const std::string word = fmt::format(" {} ", lower(name));
    const bool is_of_events = section.find(".moves") != std::string_view::npos ||
                              section.ends_with(".release") || section.ends_with(".cut");
    const auto* const found = std::ranges::find_if(kWishes, [&](const Wish& wish) {
        return wish.names.find(word) != std::string_view::npos &&
               (wish.section.empty() ? !is_of_events : section.ends_with(wish.section));
    });
    return found == std::end(kWishes) ? nullptr : found;
}

/// "1,5" as "1.5"; empty for a text that is no number with a comma, or with a sign that is not ASCII.
std::string number_meant(std::string text) {
    constexpr std::string_view kMinus = "\xe2\x88\x92";
    if (text.starts_with(kMinus)) text.replace(0, kMinus.size(), "-");
    if (text.find_first_not_of("0123456789+-.,eE") != std::string::npos) return "";
    if (std::ranges::count(text, ',') == 1) text[text.find(',')] = '.';
    try {
        const toml::table table = toml::parse("value = " + text);
        return table.get("value")->is_number() ? text : "";
    } catch (const toml::parse_error&) {
        return "";
    }
}

/// Checks a value of one key.
class ValueChecker {
  public:
    ValueChecker(const Key& key, Problems& problems) : key_(&key), problems_(&problems) {}

    /// Whether the value is one that the key may have; adds a problem if not.
    bool check(const toml::node& node, const std::string& path) const {
        const toml::array* const list = node.as_array();
        if (!key_->type.names.empty() && node.is_string())
            return check_word(key_->type.names, node.as_string()->get(), node, path);
        if (list == nullptr && takes(kOne)) return check_one(node, path);
        if (list == nullptr && is_one_choice(node)) return fail_for_one(node, path);
        if (list == nullptr) return fail_type(node, path, takes(kList | kPairs) ? "a list" : key_->type.pair);
        if (key_->type.forms == kOne) return fail_type(node, path, one_words());
        const bool is_nested = !list->empty() && list->get(0)->is_array();
        if (takes(kPair) && !(is_nested && takes(kPairs))) return check_pair(node, path);
        return check_list(*list, path);
    }

  private:
    [[nodiscard]] bool takes(unsigned forms) const { return (key_->type.forms & forms) != 0; }

    [[nodiscard]] bool is_one_choice(const toml::node& node) const {
        const auto& choices = key_->type.choices;
        return node.is_string() && takes(kList) &&
               std::ranges::find(choices, node.as_string()->get()) != choices.end();
    }

    bool fail_for_one(const toml::node& node, const std::string& path) const {
        const std::string& word = node.as_string()->get();
        problems_->add(node, path, fmt::format("\"{}\" is a string, not a list", word),
                       fmt::format("write [\"{}\"]", word));
        return false;
    }

    bool check_list(const toml::array& list, const std::string& path) const {
        if (list.size() < key_->type.min_entries)
            return fail(list, path, list.empty() ? "the list is empty" : described(list));
        bool good = true;
        for (std::size_t i = 0; i < list.size(); ++i) {
            const toml::node& entry = *list.get(i);
            const std::string entry_path = fmt::format("{}[{}]", path, i);
            const bool is_pair = entry.is_array() ? takes(kPairs) : !takes(kList);
            good &= is_pair ? check_pair(entry, entry_path) : check_one(entry, entry_path);
        }
        return good;
    }

    bool check_pair(const toml::node& node, const std::string& path) const {
        const toml::array* const pair = node.as_array();
        if (pair == nullptr || pair->size() != 2) return fail_type(node, path, key_->type.pair);
        const bool first = check_one(*pair->get(0), path + "[0]");
        return check_one(*pair->get(1), path + "[1]") && first;
    }

    bool check_one(const toml::node& node, const std::string& path) const {
        switch (key_->type.kind) {
            case Kind::kBoolean:
                return node.is_boolean() || fail_type(node, path, one_words());
            case Kind::kInteger:
                return node.is_integer() ? check_number(node, path) : fail_type(node, path, one_words());
            case Kind::kNumber:
                return node.is_number() ? check_number(node, path) : fail_type(node, path, one_words());
            default:
                break;
        }
        if (key_->type.kind == Kind::kFraction && node.is_number()) return check_rate(node, path);
        if (!node.is_string()) return fail_type(node, path, one_words());
        const std::string& text = node.as_string()->get();
        if (key_->type.kind == Kind::kFraction) return check_rate(node, path);
        if (key_->type.kind == Kind::kText) return check_text(text, node, path);
        return key_->type.kind == Kind::kChoice ? check_choice(text, node, path)
                                                : check_color(text, node, path);
    }

    bool check_number(const toml::node& node, const std::string& path) const {
        const double value = number_of(node);
        const std::string text =
            node.is_integer() ? std::to_string(node.as_integer()->get()) : fmt::format("{}", value);
        if (!std::isfinite(value)) return fail(node, path, text + " is not a finite number");
        if (!key_->type.choices.empty()) return check_choice(text, node, path);
        const Range& range = key_->type.range;
        const auto outside = [&](std::string_view relation, double bound) {
            return fail(node, path, fmt::format("{} is not {} {}", text, relation, number_text(bound)));
        };
        if (range.low_open ? value <= range.low : value < range.low)
            return outside(range.low_open ? ">" : ">=", range.low);
        if (range.high_open ? value >= range.high : value > range.high)
            return outside(range.high_open ? "<" : "<=", range.high);
        return true;
    }

    bool check_rate(const toml::node& node, const std::string& path) const {
        const auto rate = read_rate(node);
        if (const auto* const problem = std::get_if<Problem>(&rate))
            return fail(node, path, problem->what, problem->remedy);
        const double value = std::get<Rational>(rate).value();
        const bool inside = value >= key_->type.range.low && value <= key_->type.range.high;
        return inside || fail(node, path, fmt::format("{} is out of range", std::get<Rational>(rate).text()));
    }

    bool check_choice(const std::string& text, const toml::node& node, const std::string& path) const {
        return check_word(key_->type.choices, text, node, path);
    }

    bool check_word(const std::vector<std::string_view>& words, const std::string& text,
                    const toml::node& node, const std::string& path) const {
        if (std::ranges::find(words, text) != words.end()) return true;
        if (node.is_number()) return fail(node, path, fmt::format("{} is not allowed", text));
        const auto meant = nearest(text, words);
        if (!meant) return fail(node, path, fmt::format("\"{}\" is unknown", excerpt(text)));
        problems_->add(node, path, fmt::format("\"{}\" is unknown", excerpt(text)),
                       fmt::format("did you mean \"{}\"?", *meant));
        return false;
    }

    bool check_text(const std::string& text, const toml::node& node, const std::string& path) const {
        if (text.size() > Limits::kTextBytes) {
            return fail(
                node, path,
                fmt::format("a text of {} bytes, over the limit of {}", text.size(), Limits::kTextBytes));
        }
        if (printable(text) != text) {
            return fail(node, path,
                        fmt::format("\"{}\" {}", excerpt(text),
                                    utf8(text) == text ? "has a control character" : "is not UTF-8"));
        }
        return true;
    }

    bool check_color(const std::string& text, const toml::node& node, const std::string& path) const {
        if (Color::parse(text)) return true;
        const auto meant = nearest(text, Color::names());
        return fail(node, path, fmt::format("\"{}\" is not a colour", excerpt(text)),
                    meant ? fmt::format("did you mean \"{}\"?", *meant) : "");
    }

    [[nodiscard]] std::string_view one_words() const {
        switch (key_->type.kind) {
            case Kind::kBoolean:
                return "true or false";
            case Kind::kInteger:
                return "an integer";
            case Kind::kNumber:
                return "a number";
            case Kind::kFraction:
                return "a number or text in quotes";
            default:
                return "text in quotes";
        }
    }

    bool fail_type(const toml::node& node, const std::string& path, std::string_view expected) const {
        const bool is_one = expected == "a number" || expected == "an integer";
        if (const std::string number = number_instead(node); is_one && !number.empty()) {
            const bool has_comma = node.is_string() && node.as_string()->get().find(',') != std::string::npos;
            return fail(node, path,
                        fmt::format("{}, not {}{}", described(node), expected,
                                    has_comma ? ": decimals need a point" : ""),
                        "write " + number);
        }
        return fail(node, path, fmt::format("{}, not {}", described(node), expected));
    }

    /// The number that a value of another type stands for; empty if there is none.
    [[nodiscard]] std::string number_instead(const toml::node& node) const {
        if (key_->type.kind != Kind::kNumber && key_->type.kind != Kind::kInteger) return "";
        if (!key_->type.choices.empty()) return "";
        if (node.is_string()) return number_meant(node.as_string()->get());
        return is_whole(node) ? fmt::format("{:.0f}", number_of(node)) : "";
    }

    /// `hint`: a remedy that comes before that of the key.
    bool fail(const toml::node& node, const std::string& path, std::string what,
              const std::string& hint = "") const {
        problems_->add(node, path, std::move(what), hint + (hint.empty() ? "" : "; ") + remedy(*key_));
        return false;
    }

    const Key* key_;
    Problems* problems_;
};

/// Checks tables, each with the tables in it.
class TableChecker {
  public:
    explicit TableChecker(Problems& problems) : problems_(&problems) {}

    /// Checks the table at `path`, which has the keys of `section`.
    void check(toml::table& table, std::string_view section, const std::string& path) const {
        refuse_unknown_keys(table, section, path);
        if (const Key* const method = find_key(section, "method")) refuse_foreign_keys(table, *method, path);
        for (const Key& key : keys_of(section)) {
            const std::string key_path = dotted(path, key.name);
            toml::node* const node = table.get(key.name);
            if (node != nullptr && !check_value(key, *node, dotted(section, key.name), key_path)) {
                table.erase(key.name);
            } else if (node == nullptr && key.binding.initial.required && problems_->is_sound(key_path)) {
                problems_->add(table.source(), key_path, "missing", remedy(key));
            }
        }
    }

  private:
    void refuse_unknown_keys(const toml::table& table, std::string_view section,
                             const std::string& path) const {
        for (const auto& [key, node] : table) {
            if (find_key(section, key.str()) != nullptr) continue;
            const std::string name = excerpt(key.str());
            if (const auto instead = replacement_of(dotted(section, key.str())); !instead.empty()) {
                problems_->add(key.source(), dotted(path, name), "was removed", std::string(instead));
                continue;
            }
            if (const Wish* const wish = wish_of(key.str(), section)) {
                if (!wish->key.empty()) problems_->add_misspelt(dotted(path, wish->key));
                problems_->add(key.source(), dotted(path, name), fmt::format("unknown key \"{}\"", name),
                               std::string(wish->instead));
                continue;
            }
            std::vector<std::string_view> known;
            for (const Key& one : keys_of(section)) known.push_back(one.name);
            const auto meant = nearest(key.str(), known);
            if (meant) problems_->add_misspelt(dotted(path, *meant));
            std::string hint =
                meant ? fmt::format("did you mean \"{}\"?", *meant) : other_home(key.str(), section);
            if (hint.empty()) hint = fmt::format("valid keys: {}", fmt::join(known, ", "));
            problems_->add(key.source(), dotted(path, name), fmt::format("unknown key \"{}\"", name),
                           std::move(hint));
        }
    }

    /// Refuses keys of other methods, whatever their values. Without a valid method no key is foreign.
    void refuse_foreign_keys(toml::table& solver, const Key& method_key, const std::string& path) const {
        const auto has = [](const std::vector<std::string_view>& words, std::string_view word) {
            return std::ranges::find(words, word) != words.end();
        };
        const bool is_default = !solver.contains("method") && !method_key.binding.initial.required;
        const std::string method =
            is_default ? std::string(solver_name(SolverDef{})) : solver["method"].value_or(std::string());
        if (!has(method_key.type.choices, method) || !problems_->is_sound(dotted(path, "method"))) return;
        for (const Key& key : keys_of(method_key.section)) {
            const toml::node* const node = solver.get(key.name);
            if (node == nullptr || key.methods.empty() || has(key.methods, method)) continue;
            const std::string named =
                is_default ? fmt::format(", or give method = \"{}\"", key.methods.front()) : "";
            problems_->add(
                *node, dotted(path, key.name),
                fmt::format("method \"{}\" does not use it, only {}", method, fmt::join(key.methods, ", ")),
                fmt::format("remove it{}{}", key.instead, named));
            solver.erase(key.name);
        }
    }

    bool check_value(const Key& key, toml::node& node, const std::string& section,
                     const std::string& path) const {
        if (key.type.kind == Kind::kTables) return check_tables(key, node, section, path);
        if (key.type.kind != Kind::kTable) return ValueChecker(key, *problems_).check(node, path);
        if (!node.is_table()) return fail(key, node, path, "a table");
        check(*node.as_table(), section, path);
        return true;
    }

    bool check_tables(const Key& key, toml::node& node, const std::string& section,
                      const std::string& path) const {
        toml::array* const list = node.as_array();
        if (list == nullptr) return fail(key, node, path, "a list");
        if (list->empty() && section.find('.') == std::string::npos) {  // a scene has bodies
            problems_->add(node, path, "the list is empty", remedy(key));
            return false;
        }
        for (std::size_t i = 0; i < list->size(); ++i) {
            toml::node& entry = *list->get(i);
            const std::string entry_path = fmt::format("{}[{}]", path, i);
            if (entry.is_table()) {
                check(*entry.as_table(), section, entry_path);
            } else {
                fail(key, entry, entry_path, "a table");
            }
        }
        return true;
    }

    bool fail(const Key& key, const toml::node& node, const std::string& path,
              std::string_view expected) const {
        problems_->add(node, path, fmt::format("{}, not {}", described(node), expected), remedy(key));
        return false;
    }

    Problems* problems_;
};

/// A sweep file would have a problem per key.
void refuse_sweep(const toml::table& document, Problems& problems) {
    if (!document.contains("scene") || document.contains("rope") || document.contains("net")) return;
    if (!document.contains("vary") && !document.contains("samples")) return;
    problems.add(
        document.source(), "", "this is a sweep file, not a scene",
        "make its samples with: python3 -m corda sweep FILE -o FOLDER; or give the scene that it names");
    problems.throw_if_any();
}

/// In a file of another schema any key may be right.
void check_schema(const toml::table& document, Problems& problems) {
    const toml::value<std::int64_t>* const schema = document["schema"].as_integer();
    if (schema == nullptr || std::to_string(schema->get()) == find_key("", "schema")->type.choices.front())
        return;
    problems.add(*schema, "schema", fmt::format("{} is not a known version", schema->get()),
                 "this program reads schema = 1");
    problems.throw_if_any();
}

}  // namespace

void check_document(toml::table& document, Problems& problems) {
    check_schema(document, problems);
    refuse_sweep(document, problems);
    TableChecker(problems).check(document, "", "");
    const bool has_bodies = document.contains("rope") || document.contains("net");
    if (!has_bodies && problems.is_sound("rope") && problems.is_sound("net"))
        problems.add(document.source(), "rope", "missing", "give one or more [[rope]] or [[net]]");
}

void check_value(const Key& key, const std::string& toml, const std::string& path, Problems& problems) {
    const toml::table table = toml::parse("value = " + toml);
    static_cast<void>(ValueChecker(key, problems).check(*table.get("value"), path));
}

}  // namespace corda::scene
