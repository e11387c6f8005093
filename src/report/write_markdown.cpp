#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "corda/core/text.hpp"
#include "corda/report/writers.hpp"

namespace corda::report {
namespace {

/// Plain text as Markdown inside a line, with every special character escaped.
std::string markdown_text(std::string_view text) {
    constexpr std::string_view kSpecial = "\\`*_[]<>|~$&";
    std::string result;
    for (const char c : printable(text)) {
        if (kSpecial.find(c) != std::string_view::npos) result += '\\';
        result += c;
    }
    return result;
}

/// The same for a text at the start of a line, which "#", "-" or "1." would make a heading or a list.
std::string paragraph_text(std::string_view text) {
    std::string result = markdown_text(text);
    const std::size_t mark = std::min(result.find_first_not_of("0123456789"), result.size());
    constexpr std::string_view kBlockStarts = "#+-=";
    constexpr std::string_view kListMarks = ".)";
    const std::string_view special = mark == 0 ? kBlockStarts : kListMarks;
    if (mark < result.size() && special.find(result[mark]) != std::string_view::npos) {
        result.insert(mark, 1, '\\');
    }
    return result + "\n\n";
}

/// The number of code points, which is near enough to that of columns in a fixed-width font.
std::size_t width(std::string_view text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string markdown_cell(const Cell& cell) {
    if (const auto* number = std::get_if<double>(&cell)) return short_number(*number);
    if (const auto* text = std::get_if<std::string>(&cell)) return markdown_text(*text);
    return {};
}

/// The titles of the shown columns, then the rows, as text.
std::vector<std::vector<std::string>> markdown_cells(const Table& table,
                                                     const std::vector<std::size_t>& shown) {
    std::vector<std::vector<std::string>> rows(1);
    for (const std::size_t i : shown) rows[0].push_back(markdown_text(table.columns[i].title));
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        auto& cells = rows.emplace_back();
        for (const std::size_t i : shown) {
            cells.push_back(markdown_cell(table.rows[r][i]));
            if (table.columns[i].key == kFailureKey && is_failed(table, r)) {
                cells.back().insert(0, "**failed:** ");
            }
        }
    }
    return rows;
}

void add_padded(const std::string& cell, std::size_t to, bool right, std::string& text) {
    const std::string padding(to - width(cell), ' ');
    text += "| " + (right ? padding + cell : cell + padding) + " ";
}

void add_table(const Table& table, std::string& text) {
    text += fmt::format("**{}**\n\n", markdown_text(table.title));
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (is_for_people(table, i)) shown.push_back(i);
    }
    const auto rows = markdown_cells(table, shown);
    std::vector<std::size_t> widths(shown.size(), 3);
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width(row[i]));
    }
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t i = 0; i < shown.size(); ++i) {
            add_padded(rows[r][i], widths[i], is_numeric(table, shown[i]), text);
        }
        text += "|\n";
        if (r > 0) continue;
        for (std::size_t i = 0; i < shown.size(); ++i) {
            text += "|" + std::string(widths[i] + 1, '-') + (is_numeric(table, shown[i]) ? ":" : "-");
        }
        text += "|\n";
    }
    text += '\n';
    if (!table.note.empty()) text += paragraph_text(table.note);
}

void add_figure(const Report& report, const std::string& id, const std::string& title,
                const std::string& caption, std::string& text) {
    const auto width_mm = report.widths_mm.empty() ? std::nullopt : std::optional(report.widths_mm.back());
    text += fmt::format("![{}]({}.svg)\n\n", markdown_text(title), file_stem(id, width_mm));
    if (!caption.empty()) text += paragraph_text(caption);
}

Table setting_table(const Report& report) {
    Table table{"setting", "Setting", {{"name", "What"}, {"value", "Value"}}, {}, ""};
    for (const auto& [name, value] : report.setting) table.rows.push_back({name, value});
    return table;
}

}  // namespace

std::string markdown_text(const Report& report) {
    std::string text = fmt::format("# {}\n\n", markdown_text(report.title));
    for (const Chapter& chapter : report.chapters) {
        if (!chapter.summary.empty()) text += paragraph_text(chapter.summary);
    }
    if (!report.setting.empty()) add_table(setting_table(report), text);
    for (const Chapter& chapter : report.chapters) {
        text += fmt::format("## {}\n\n", markdown_text(chapter.title));
        for (const std::string& paragraph : chapter.paragraphs) text += paragraph_text(paragraph);
        for (const Picture& picture : chapter.pictures)
            add_figure(report, picture.id, picture.title, picture.caption, text);
        for (const Plot& plot : chapter.plots) add_figure(report, plot.id, plot.title, plot.caption, text);
        for (const Table& table : chapter.tables) add_table(table, text);
    }
    text.pop_back();  // one newline at the end, not two
    return text;
}

}  // namespace corda::report
