#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "corda/core/text.hpp"
#include "corda/scene/document.hpp"

namespace corda::scene {
namespace {

constexpr std::size_t kMaxLabel = 80;
constexpr std::string_view kWhitespace = " \t\r\n";

std::string label_of(const std::string& place, const Setting& setting) {
    return (place.empty() ? "--set " : place + " ") + excerpt(setting, kMaxLabel);
}

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(kWhitespace);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kWhitespace) - begin + 1);
}

bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

/// Takes "name" from the front of `rest`.
std::optional<KeyStep> take_name(std::string_view& rest) {
    std::size_t length = 0;
    while (length < rest.size() && is_name_character(rest[length])) ++length;
    if (length == 0) return std::nullopt;
    KeyStep step{std::string(rest.substr(0, length))};
    rest.remove_prefix(length);
    return step;
}

/// Takes "[3]" from the front of `rest`.
std::optional<KeyStep> take_index(std::string_view& rest) {
    KeyStep step;
    const char* end = rest.data() + rest.size();
    const auto [stop, status] = std::from_chars(rest.data() + 1, end, step.index);
    if (status != std::errc{} || stop == end || *stop != ']') return std::nullopt;
    rest.remove_prefix(static_cast<std::size_t>(stop - rest.data()) + 1);
    return step;
}

/// A table {value = ...} made from a setting's text; text that is not one TOML value is taken as a string.
toml::table parse_value(std::string_view text, const std::string& label) {
    const std::string line = fmt::format("value = {}", text);
    if (find_deep_key(line) == std::string_view::npos) {
        try {
            toml::table parsed = toml::parse(line, std::string_view(label));
            if (parsed.size() == 1) return parsed;
        } catch (const toml::parse_error&) {
            // A bare word such as `relaxation`, a colour, or "30000/1001": a string, below.
        }
    }
    // Parsed once more, because only the parser can give a node its source.
    toml::table parsed = toml::parse("value = ''", std::string_view(label));
    parsed.get("value")->as_string()->get() = text;
    return parsed;
}

/// Walks down a document along the key of one setting.
class SettingWriter {
  public:
    SettingWriter(toml::table& document, std::string label) : node_(&document), label_(std::move(label)) {}

    void write(const std::vector<KeyStep>& steps, std::string_view text) {
        for (std::size_t i = 0; i + 1 < steps.size(); ++i) descend(steps[i], steps[i + 1].is_index());
        if (text.empty()) return remove(steps.back());
        toml::table parsed = parse_value(text, label_);
        put(steps.back(), *parsed.get("value"));
    }

  private:
    void descend(const KeyStep& step, bool index_follows) {
        if (step.is_index()) {
            node_ = element(step);
        } else {
            toml::table& table = as_table();
            if (!table.contains(step.name)) {
                if (index_follows)
                    fail(fmt::format("the scene gives no list \"{}\"", step.name),
                         fmt::format("add {} to it first", step.name));
                toml::table made = toml::parse("value = {}", std::string_view(label_));
                toml::node& node = *made.get("value");
                table.insert_or_assign(toml::key(step.name, toml::source_region(node.source())),
                                       std::move(node));
            }
            node_ = table.get(step.name);
        }
        extend_path(step);
    }

    void put(const KeyStep& step, toml::node& value) {
        if (step.is_index()) {
            static_cast<void>(element(step));
            toml::array& list = *node_->as_array();
            list.replace(list.cbegin() + static_cast<std::ptrdiff_t>(step.index), std::move(value));
        } else {
            // A region of the same setting, because a message about an unknown key names the key's place.
            const toml::key key(step.name, toml::source_region(value.source()));
            as_table().insert_or_assign(key, std::move(value));
        }
    }

    void remove(const KeyStep& step) {
        if (step.is_index()) {
            static_cast<void>(element(step));
            node_->as_array()->erase(node_->as_array()->cbegin() + static_cast<std::ptrdiff_t>(step.index));
        } else if (as_table().erase(step.name) == 0) {
            extend_path(step);
            fail("the scene does not give this key, so there is nothing to remove", "give a value");
        }
    }

    toml::node* element(const KeyStep& step) {
        toml::array* list = node_->as_array();
        if (list == nullptr) fail(described(*node_) + ", not a list", "leave out the index");
        if (step.index >= list->size()) {
            fail(fmt::format("index {} is out of range; the list has {}", step.index, list->size()),
                 list->size() > 1 ? fmt::format("give 0 .. {}", list->size() - 1)
                 : list->empty()  ? ""
                                  : "give 0");
        }
        return list->get(step.index);
    }

    toml::table& as_table() {
        if (node_->is_array_of_tables()) {
            fail("this is a list of tables", fmt::format("give an index: {}[0]", path_));
        }
        if (!node_->is_table())
            fail(described(*node_) + ", not a table", fmt::format("end the key at {}", path_));
        return *node_->as_table();
    }

    void extend_path(const KeyStep& step) {
        if (step.is_index()) {
            path_ += fmt::format("[{}]", step.index);
        } else {
            path_ += path_.empty() ? step.name : "." + step.name;
        }
    }

    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
        throw Error(ExitCode::kInvalidScene, Problem{{.source = label_, .key = path_}, what, remedy});
    }

    toml::node* node_;
    std::string label_;
    std::string path_;
};

}  // namespace

std::optional<std::vector<KeyStep>> parse_key(std::string_view key) {
    std::vector<KeyStep> steps;
    std::string_view rest = trimmed(key);
    while (true) {
        const auto name = take_name(rest);
        if (!name) return std::nullopt;
        steps.push_back(*name);
        while (rest.starts_with('[')) {
            const auto index = take_index(rest);
            if (!index) return std::nullopt;
            steps.push_back(*index);
        }
        if (rest.empty()) return steps;
        if (rest.front() != '.') return std::nullopt;
        rest.remove_prefix(1);
    }
}

void apply_setting(toml::table& document, const Setting& setting, Problems& problems,
                   const std::string& place) {
    const std::string label = label_of(place, setting);
    const auto refuse = [&](const std::string& problem) {
        const char* const advice =
            place.empty() ? "give --set key=value, e.g. --set video.fps=30 or --set rope[0].mass=2" : "";
        throw Error(ExitCode::kUsage, Problem{{.source = label, .key = {}}, problem, advice});
    };
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) refuse("there is no '='");
    const std::string_view key = trimmed(std::string_view(setting).substr(0, equals));
    if (key.empty()) refuse("the key is empty");
    const auto steps = parse_key(key);
    if (!steps) return refuse(fmt::format("\"{}\" is not a key", excerpt(key)));
    if (steps->size() > static_cast<std::size_t>(kKeyParts)) refuse("the key has too many parts");
    try {
        SettingWriter(document, label).write(*steps, trimmed(std::string_view(setting).substr(equals + 1)));
    } catch (const Error& error) {
        problems.add_to_setting(error.problems().front());
    }
}

std::string misfit_of(toml::table& document, std::string_view key) {
    const auto steps = parse_key(key);
    if (!steps) return fmt::format("\"{}\" is not a key; give one such as rope[0].mass", excerpt(key));
    try {
        SettingWriter(document, "").write(*steps, "0");
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace corda::scene
