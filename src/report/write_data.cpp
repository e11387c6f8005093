#include <nlohmann/json.hpp>

#include "corda/core/csv.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {
namespace {

// Keeps the order in which a reader wants the keys.
using Json = nlohmann::ordered_json;

Json to_json(const Cell& cell) {
    if (const auto* number = std::get_if<double>(&cell)) return *number;
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    return nullptr;
}

Json to_json(const Table& table) {
    Json columns = Json::array();
    for (const Column& column : table.columns)
        columns.push_back({{"key", column.key}, {"title", column.title}});
    Json rows = Json::array();
    for (const auto& row : table.rows) {
        Json object = Json::object();
        for (std::size_t i = 0; i < row.size(); ++i) object[table.columns[i].key] = to_json(row[i]);
        rows.push_back(std::move(object));
    }
    return {
        {"id", table.id}, {"title", table.title}, {"note", table.note}, {"columns", columns}, {"rows", rows}};
}

Json to_json(const Plot& plot) {
    Json series = Json::array();
    for (const Series& one : plot.series) {
        Json points = Json::array();
        for (const auto& [x, y] : one.points) points.push_back(Json::array({x, y}));
        series.push_back({{"name", one.name}, {"points", points}});
    }
    return {{"id", plot.id},           {"title", plot.title}, {"x_title", plot.x_title},
            {"y_title", plot.y_title}, {"log_x", plot.log_x}, {"log_y", plot.log_y},
            {"caption", plot.caption}, {"series", series}};
}

Json to_json(const Chapter& chapter) {
    Json tables = Json::array();
    for (const Table& table : chapter.tables) tables.push_back(to_json(table));
    Json pictures = Json::array();
    for (const Picture& picture : chapter.pictures)
        pictures.push_back({{"id", picture.id}, {"title", picture.title}, {"caption", picture.caption}});
    Json plots = Json::array();
    for (const Plot& plot : chapter.plots) plots.push_back(to_json(plot));
    return {{"title", chapter.title}, {"summary", chapter.summary}, {"paragraphs", chapter.paragraphs},
            {"tables", tables},       {"pictures", pictures},       {"plots", plots}};
}

}  // namespace

std::string csv_text(const Table& table) {
    CsvLine line;
    for (const Column& column : table.columns) line.add(column.key);
    std::string text(line.end());
    for (const auto& row : table.rows) {
        for (const Cell& cell : row) {
            if (const auto* number = std::get_if<double>(&cell))
                line.add(*number);
            else if (const auto* words = std::get_if<std::string>(&cell))
                line.add(*words);
            else
                line.add(std::string_view());
        }
        text += line.end();
    }
    return text;
}

std::string json_text(const Report& report) {
    Json setting = Json::array();
    for (const auto& [name, value] : report.setting) setting.push_back({{"name", name}, {"value", value}});
    Json chapters = Json::array();
    for (const Chapter& chapter : report.chapters) chapters.push_back(to_json(chapter));
    Json json = {{"schema", 1}, {"title", report.title}, {"setting", setting}, {"chapters", chapters}};
    make_utf8(json);
    return json.dump(2) + "\n";
}

}  // namespace corda::report
