#include "corda/scene/table_reader.hpp"

#include <fmt/format.h>

#include <cassert>

namespace corda::scene {

std::optional<Value> TableReader::find(std::string_view key) const {
    assert(find_key(section_, key) != nullptr);
    const toml::node* const node = table_->get(key);
    if (node == nullptr) return std::nullopt;
    return Value(*problems_, *node, path_of(key));
}

TableReader TableReader::table(std::string_view key) const {
    static const toml::table empty;
    const toml::node* const node = table_->get(key);
    return {*problems_, node == nullptr ? empty : *node->as_table(), dotted(section_, key), path_of(key)};
}

std::vector<TableReader> TableReader::tables(std::string_view key) const {
    std::vector<TableReader> readers;
    const toml::array* const list = (*table_)[key].as_array();
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        if (const toml::table* const table = list->get(i)->as_table())
            readers.emplace_back(*problems_, *table, dotted(section_, key),
                                 fmt::format("{}[{}]", path_of(key), i));
    }
    return readers;
}

void TableReader::add_missing(std::string_view key) const {
    if (is_sound(key))
        problems_->add(table_->source(), path_of(key),
                       fmt::format("missing; {}", remedy(*find_key(section_, key))));
}

std::string TableReader::path_of(std::string_view key) const {
    return dotted(path_, key);
}

}  // namespace corda::scene
