#include <algorithm>

#include <fmt/format.h>

#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"
#include "corda/report/writers.hpp"
#include "corda/view/words.hpp"

namespace corda::report {
namespace {

/// A cell with more bytes than this may be broken into lines.
constexpr std::size_t kLongText = 40;

/// Whether a column has numbers and no texts.
bool is_numeric(const Table& table, std::size_t column) {
    const auto holds = [&table, column](auto predicate) {
        return std::ranges::any_of(table.rows, [&](const auto& row) { return predicate(row[column]); });
    };
    return holds([](const Cell& cell) { return std::holds_alternative<double>(cell); }) &&
           !holds([](const Cell& cell) { return std::holds_alternative<std::string>(cell); });
}

/// Whether people are shown a column: the failure column only if a row failed.
bool is_for_people(const Table& table, std::size_t column) {
    if (table.columns[column].key != kFailureKey) return true;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        if (is_failed(table, row)) return true;
    }
    return false;
}

/// "1.23e-5" as 1.23 · 10 to the -5.
std::string number_html(double value, Language language) {
    std::string text = view::localized(short_number(value), language);
    const std::size_t e = text.find('e');
    if (e == std::string::npos) return text;
    const bool is_negative = text[e + 1] == '-';
    return fmt::format("{}·10<sup>{}{}</sup>", text.substr(0, e), is_negative ? "−" : "", text.substr(e + 2));
}

std::string cell_html(const Cell& cell, Language language) {
    if (const auto* number = std::get_if<double>(&cell)) {
        return fmt::format("<td class=\"number\" title=\"{}\">{}</td>",
                           view::localized(fmt::format("{:.17g}", *number), language),
                           number_html(*number, language));
    }
    if (const auto* text = std::get_if<std::string>(&cell); text != nullptr && !text->empty()) {
        return fmt::format("<td class=\"{}\">{}</td>", text->size() > kLongText ? "long" : "text",
                           markup_text(*text));
    }
    return "<td class=\"missing\">–</td>";
}

std::string table_html(const Table& table) {
    std::string text =
        fmt::format("<details>\n<summary>{}</summary>\n<div class=\"scroll\">\n<table id=\"table-{}\">\n",
                    markup_text(table.title), table.id);
    text += "<thead><tr>";
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (!is_for_people(table, i)) continue;
        text += fmt::format("<th scope=\"col\"{}>{}</th>", is_numeric(table, i) ? " class=\"number\"" : "",
                            markup_text(table.columns[i].title));
    }
    text += "</tr></thead>\n<tbody>\n";
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
        text += is_failed(table, r) ? "<tr class=\"failed\">" : "<tr>";
        for (std::size_t i = 0; i < table.columns.size(); ++i) {
            if (is_for_people(table, i)) text += cell_html(table.rows[r][i], table.language);
        }
        text += "</tr>\n";
    }
    text += "</tbody>\n</table>\n</div>\n";
    if (!table.note.empty()) text += fmt::format("<p class=\"note\">{}</p>\n", markup_text(table.note));
    return text + "</details>\n";
}

/// Where the files of a figure are.
std::string files_html(const Report& report, const std::string& id, const std::string& data) {
    std::string text;
    for (const int width_mm : report.widths_mm) {
        text += fmt::format("{}{} mm: ", text.empty() ? "" : " · ", width_mm);
        for (const auto& [ending, name] : {std::pair{"svg", "SVG"}, {"pdf", "PDF"}, {"png", "PNG"}})
            text += fmt::format("<a href=\"{}.{}\">{}</a> ", file_stem(id, width_mm, report.widths_mm),
                                ending, name);
        text.pop_back();
    }
    if (!data.empty()) text += fmt::format(" · numbers: <a href=\"{}\">CSV</a>", data);
    return "<span class=\"files\">" + text + "</span>";
}

/// Figures of a report as elements of its page. Those with a caption are numbered.
class Figures {
  public:
    Figures(const Report& report, const SvgOf& svg_of) : report_(report), svg_of_(svg_of) {}

    [[nodiscard]] std::string html(const std::string& id, const std::string& title,
                                   const std::string& caption, const std::string& data, bool is_on_white) {
        std::string text = fmt::format(
            "<figure id=\"figure-{}\"{}>\n<img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\"/>\n", id,
            is_on_white ? " class=\"white\"" : "", markup_text(title), base64(svg_of_(id)));
        if (!caption.empty())
            text += fmt::format("<figcaption><b>Figure {}.</b> {}{}</figcaption>\n", ++count_,
                                markup_text(caption), files_html(report_, id, data));
        return text + "</figure>\n";
    }

  private:
    const Report& report_;
    const SvgOf& svg_of_;
    int count_ = 0;
};

std::string setting_html(const Report& report) {
    if (report.setting.empty()) return {};
    std::string text = fmt::format(
        "<div class=\"scroll\">\n<table class=\"setting\" "
        "id=\"setting\">\n<caption>{}</caption>\n<tbody>\n",
        markup_text(report.setting_title));
    for (const auto& [name, value] : report.setting) {
        text += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", markup_text(name),
                            markup_text(value));
    }
    return text + "</tbody>\n</table>\n</div>\n";
}

std::string contents_html(const Report& report) {
    if (report.chapters.empty()) return {};
    std::string text = "<nav aria-label=\"Chapters\">\n<ol>\n";
    for (std::size_t i = 0; i < report.chapters.size(); ++i) {
        text += fmt::format("<li><a href=\"#chapter-{}\">{}</a></li>\n", i + 1,
                            markup_text(report.chapters[i].title));
    }
    return text + "</ol>\n</nav>\n";
}

std::string pictures_html(const Chapter& chapter, Figures& figures) {
    std::string text;
    bool is_in_row = false;
    for (const Picture& picture : chapter.pictures) {
        if (picture.is_small != is_in_row) text += is_in_row ? "</div>\n" : "<div class=\"small\">\n";
        is_in_row = picture.is_small;
        text += figures.html(picture.id, picture.title, picture.caption, "", picture.is_on_white);
    }
    return text + (is_in_row ? "</div>\n" : "");
}

std::string chapter_html(const Chapter& chapter, std::size_t number, Figures& figures) {
    std::string text =
        fmt::format("<section id=\"chapter-{0}\">\n<h2><a href=\"#chapter-{0}\">{0}. {1}</a></h2>\n", number,
                    markup_text(chapter.title));
    for (const std::string& paragraph : chapter.paragraphs) {
        text += fmt::format("<p>{}</p>\n", markup_text(paragraph));
    }
    text += pictures_html(chapter, figures);
    for (const Plot& plot : chapter.plots)
        text += figures.html(plot.id, plot.title, plot.caption, plot.data, true);
    for (const Table& table : chapter.tables) text += table_html(table);
    return text + "</section>\n";
}

}  // namespace

std::string html_text(const Report& report, const SvgOf& svg_of) {
    std::string text = fmt::format(
        "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n"
        "<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, "
        "initial-scale=1\"/>\n"
        "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
        markup_text(report.title), kPageStyle);
    for (const Chapter& chapter : report.chapters) {
        if (!chapter.summary.empty())
            text += fmt::format("<p class=\"summary\">{}</p>\n", markup_text(chapter.summary));
    }
    text += contents_html(report) + setting_html(report);
    Figures figures(report, svg_of);
    for (std::size_t i = 0; i < report.chapters.size(); ++i)
        text += chapter_html(report.chapters[i], i + 1, figures);
    return text + "</body>\n</html>\n";
}

}  // namespace corda::report
