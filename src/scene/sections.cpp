#include <fmt/format.h>

#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

constexpr std::int64_t kSchema = 1;

/// Before anything else: in a file of another schema any key may be right.
void check_schema(const Source& source, const toml::table& document) {
    const toml::node* schema = document.get("schema");
    if (schema == nullptr) {
        source.fail(document.source(), "schema", "missing; begin the file with schema = 1");
    }
    const toml::value<std::int64_t>* number = schema->as_integer();
    if (number == nullptr) {
        source.fail(schema->source(), "schema",
                    fmt::format("{}, not an integer; give schema = 1", described(*schema)));
    }
    if (number->get() != kSchema) {
        source.fail(schema->source(), "schema",
                    fmt::format("{} is not a known version; this program reads schema = 1", number->get()));
    }
}

std::vector<TableReader> read_ropes(const Source& source, const toml::table& document) {
    constexpr std::string_view kRemedy = "give one or more [[rope]]";
    const toml::node* ropes = document.get("rope");
    if (ropes == nullptr) source.fail(document.source(), "rope", fmt::format("missing; {}", kRemedy));
    const toml::array* list = ropes->as_array();
    if (list == nullptr) {
        source.fail(ropes->source(), "rope", fmt::format("{}, not a list; {}", described(*ropes), kRemedy));
    }
    if (list->empty()) source.fail(ropes->source(), "rope", fmt::format("the list is empty; {}", kRemedy));
    std::vector<TableReader> readers;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const toml::node& rope = *list->get(i);
        const std::string path = fmt::format("rope[{}]", i);
        if (!rope.is_table()) {
            source.fail(rope.source(), path, fmt::format("{}, not a table; {}", described(rope), kRemedy));
        }
        readers.emplace_back(source, *rope.as_table(), "rope", path);
    }
    return readers;
}

}  // namespace

Sections read_sections(const Source& source, const toml::table& document) {
    check_schema(source, document);
    const TableReader root(source, document, "", "");
    return {root.table("world", "write [world]"),   root.table("solver", "write [solver]"),
            root.table("video", "write [video]"),   root.table("style", "write [style]"),
            root.table("camera", "write [camera]"), read_ropes(source, document)};
}

}  // namespace corda::scene
