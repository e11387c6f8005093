#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "corda/study/writers.hpp"

namespace corda::study {
namespace {

/// Plain text as Markdown: on one line, every character itself.
std::string escaped(std::string_view text) {
    constexpr std::string_view kSpecial = "\\`*_[]<>|~$&";
    constexpr std::string_view kBlockStarts = "#+-=";
    std::string result;
    for (const char c : text) {
        const bool starts_block = result.empty() && kBlockStarts.find(c) != std::string_view::npos;
        const bool is_list_mark = (c == '.' || c == ')') && !result.empty() &&
                                  result.find_first_not_of("0123456789") == std::string::npos;
        const bool is_control = static_cast<unsigned char>(c) < ' ';
        if (starts_block || is_list_mark || kSpecial.find(c) != std::string_view::npos) result += '\\';
        result += is_control ? ' ' : c;
    }
    return result;
}

/// Characters as code points: near enough to columns of a fixed-width font for what stands in a report.
std::size_t width(std::string_view text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string cell_text(const Cell& cell, bool is_failed) {
    std::string text;
    if (const auto* number = std::get_if<double>(&cell)) text = short_number(*number);
    if (const auto* words = std::get_if<std::string>(&cell)) text = escaped(*words);
    return is_failed && !text.empty() ? "~~" + text + "~~" : text;
}

/// The cells of a table as text, the titles first.
std::vector<std::vector<std::string>> cell_texts(const Table& table) {
    std::vector<std::vector<std::string>> rows(1);
    for (const Column& column : table.columns) rows[0].push_back(escaped(column.title));
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        auto& cells = rows.emplace_back();
        for (const Cell& cell : table.rows[r]) {
            // The reason of a failure stands; the figures beside it are what must not be believed.
            const bool is_figure = std::holds_alternative<double>(cell);
            cells.push_back(cell_text(cell, is_figure && is_failed(table, r)));
        }
    }
    return rows;
}

void add_padded(const std::string& cell, std::size_t to, bool right, std::string& text) {
    const std::string padding(to - width(cell), ' ');
    text += "| " + (right ? padding + cell : cell + padding) + " ";
}

void add_table(const Table& table, std::string& text) {
    text += fmt::format("**{}**\n\n", escaped(table.title));
    const auto rows = cell_texts(table);
    std::vector<std::size_t> widths(table.columns.size(), 3);
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width(row[i]));
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t i = 0; i < rows[r].size(); ++i) {
            add_padded(rows[r][i], widths[i], is_numeric(table, i), text);
        }
        text += "|\n";
        if (r > 0) continue;
        for (std::size_t i = 0; i < widths.size(); ++i) {
            text += "|" + std::string(widths[i] + 1, '-') + (is_numeric(table, i) ? ":" : "-");
        }
        text += "|\n";
    }
    text += '\n';
    if (!table.note.empty()) text += escaped(table.note) + "\n\n";
}

Table setting_table(const Report& report) {
    Table table{"setting", "Setting", {{"name", "What"}, {"value", "Value"}}, {}, ""};
    for (const auto& [name, value] : report.setting) table.rows.push_back({name, value});
    return table;
}

}  // namespace

std::string markdown_text(const Report& report) {
    std::string text = fmt::format("# {}\n\n", escaped(report.title));
    if (!report.setting.empty()) add_table(setting_table(report), text);
    for (const Chapter& chapter : report.chapters) {
        text += fmt::format("## {}\n\n", escaped(chapter.title));
        for (const std::string& paragraph : chapter.paragraphs) text += escaped(paragraph) + "\n\n";
        for (const Plot& plot : chapter.plots) {
            text += fmt::format("![{}]({}.svg)\n\n", escaped(plot.title), plot.id);
        }
        for (const Table& table : chapter.tables) add_table(table, text);
    }
    text.pop_back();  // one line end at the end
    return text;
}

}  // namespace corda::study
