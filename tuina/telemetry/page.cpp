// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/page.hpp"

#include <fmt/format.h>

#include "tuina/telemetry/page_style.hpp"
#include "tuina/telemetry/plot/svg_parts.hpp"

namespace tuina::telemetry {

Part& Part::html(std::string_view markup) {
  html_ += markup;
  return *this;
}

Part& Part::element(std::string_view name, std::string_view kind, std::string_view words) {
  if (words.empty()) return *this;
  return html(kind.empty()
                  ? fmt::format("<{0}>{1}</{0}>", name, escaped(words))
                  : fmt::format("<{0} class=\"{1}\">{2}</{0}>", name, kind, escaped(words)));
}

Part& Part::heading(std::string_view words, Colour colour) {
  return html(fmt::format("<h3 style=\"color:{}\">{}</h3>", css(colour), escaped(words)));
}

Part& Part::figure(const std::string& svg, const std::string& caption) {
  if (svg.empty()) return *this;
  return html("<div class=\"wide\">" + svg + "</div>").note(caption);
}

Part& Part::figures(const std::vector<Figure>& figures, int in_a_row) {
  html(in_a_row == 2   ? "<div class=\"even\">"
       : in_a_row == 3 ? "<div class=\"three\">"
                       : "<div class=\"strip\">");
  for (const Figure& one : figures) {
    if (one.svg.empty()) continue;
    html("<figure>" + one.svg);
    if (!one.name.empty() || !one.caption.empty())
      html(fmt::format("<figcaption><b>{}</b>{}</figcaption>", escaped(one.name),
                       escaped(one.caption)));
    html("</figure>");
  }
  return html("</div>");
}

Part& Part::columns(const Table& table, int in_a_row) {
  html(in_a_row == 2 ? "<div class=\"even\">" : "<div class=\"three\">");
  const auto columns = static_cast<std::size_t>(in_a_row);
  const std::size_t each = (table.rows.size() + columns - 1) / columns;
  Table some = table;
  for (std::size_t from = 0; from < table.rows.size(); from += each) {
    const std::size_t to = std::min(from + each, table.rows.size());
    some.rows.assign(table.rows.begin() + static_cast<std::ptrdiff_t>(from),
                     table.rows.begin() + static_cast<std::ptrdiff_t>(to));
    html("<div>" + to_html(some) + "</div>");
  }
  return html("</div>");
}

Part& Part::list(const std::vector<std::string>& items) {
  html("<ul>");
  for (const std::string& item : items) element("li", "", item);
  return html("</ul>");
}

Part& Part::tiles(const std::vector<KeyNumber>& numbers) {
  // More than one row holds are spread over rows of equal length.
  html(numbers.size() > 7 ? "<div class=\"tiles rows\">" : "<div class=\"tiles\">");
  for (const KeyNumber& number : numbers) {
    html(fmt::format(
        "<div class=\"tile\"><span class=\"label\">{}</span><b>{}<small>{}</small></b><i>{}</i>"
        "</div>",
        escaped(number.label), escaped(number.value), escaped(number.unit),
        escaped(number.remark)));
  }
  return html("</div>");
}

Part& Part::key(const std::vector<KeyEntry>& entries) {
  html("<ul class=\"key\">");
  for (const KeyEntry& entry : entries) {
    html(fmt::format("<li><i{} style=\"background:{}\"></i>{}</li>",
                     entry.line ? " class=\"flat\"" : "", css(entry.colour), escaped(entry.text)));
  }
  return html("</ul>");
}

Part& Part::beside(const Part& wide, const Part& narrow) {
  return html("<div class=\"two\"><div>" + wide.str() + "</div><div>" + narrow.str() +
              "</div></div>");
}

Part& Part::folded(std::string_view summary, const Part& hidden) {
  return html(
      fmt::format("<details><summary>{}</summary>{}</details>", escaped(summary), hidden.str()));
}

Part& Page::section(std::string_view title, std::string_view about, bool is_long) {
  sections_.push_back({is_long, {}});
  return sections_.back().part.html("<h2>" + escaped(title) + "</h2>").text(about);
}

std::string Page::str() const {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>{}</title>\n<style>{}</style></head>"
      "<body><main>\n<header><div class=\"over\"><span>{}</span>",
      escaped(head_.language), escaped(head_.title), page_style, escaped(head_.over));
  for (const std::string& badge : head_.badges)
    html += "<span class=\"badge\">" + escaped(badge) + "</span>";
  for (const std::string& alarm : head_.alarms)
    html += "<span class=\"badge bad\">" + escaped(alarm) + "</span>";
  html += "</div><h1>" + escaped(head_.heading.empty() ? head_.title : head_.heading) + "</h1>";
  if (!head_.meta.empty()) html += "<p class=\"meta\">" + escaped(head_.meta) + "</p>";
  if (!head_.lead.empty()) html += "<p class=\"lead\">" + escaped(head_.lead) + "</p>";
  html += "</header>\n" + opening_.str();
  for (const Section& section : sections_)
    html += (section.is_long ? "<section class=\"long\">" : "<section>") + section.part.str() +
            "</section>\n";
  if (!head_.footer.empty()) html += "<footer>" + escaped(head_.footer) + "</footer>";
  return html + "</main></body></html>\n";
}

}  // namespace tuina::telemetry
