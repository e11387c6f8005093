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

/// The tables of [[rope]] or [[net]]; none where the file has no such key.
std::vector<TableReader> read_bodies(const Source& source, const toml::table& document,
                                     std::string_view section) {
    const toml::node* bodies = document.get(section);
    if (bodies == nullptr) return {};
    const std::string remedy = fmt::format("give one or more [[{}]]", section);
    const toml::array* list = bodies->as_array();
    if (list == nullptr) {
        source.fail(bodies->source(), section, fmt::format("{}, not a list; {}", described(*bodies), remedy));
    }
    if (list->empty()) source.fail(bodies->source(), section, fmt::format("the list is empty; {}", remedy));
    std::vector<TableReader> readers;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const toml::node& body = *list->get(i);
        const std::string path = fmt::format("{}[{}]", section, i);
        if (!body.is_table()) {
            source.fail(body.source(), path, fmt::format("{}, not a table; {}", described(body), remedy));
        }
        readers.emplace_back(source, *body.as_table(), section, path);
    }
    return readers;
}

}  // namespace

Sections read_sections(const Source& source, const toml::table& document) {
    check_schema(source, document);
    const TableReader root(source, document, "", "");
    Sections sections{root.table("world", "write [world]"),   root.table("solver", "write [solver]"),
                      root.table("video", "write [video]"),   root.table("style", "write [style]"),
                      root.table("camera", "write [camera]"), read_bodies(source, document, "rope"),
                      read_bodies(source, document, "net")};
    if (sections.ropes.empty() && sections.nets.empty()) {
        source.fail(document.source(), "rope", "missing; give one or more [[rope]] or [[net]]");
    }
    return sections;
}

}  // namespace corda::scene
