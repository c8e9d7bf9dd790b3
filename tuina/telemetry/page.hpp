// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/telemetry/plot/colours.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::telemetry {

/// A number worth a tile: {"scan error", "0.42", "mm", "RMS to the true surface"}.
struct KeyNumber {
  std::string label = {};
  std::string value = {};
  std::string unit = {};
  std::string remark = {};
};

/// A drawing with what stands below it.
struct Figure {
  std::string svg;
  std::string name = {};
  std::string caption = {};
};

/// One entry of a key of colours.
struct KeyEntry {
  Colour colour;
  std::string text;
  bool line = false;  ///< a dash instead of a dot
};

/// A stretch of a page. Words are plain text and are escaped here; drawings are elements already.
class Part {
 public:
  /// @{
  /// A paragraph, and one in small words.
  Part& text(std::string_view words) { return element("p", "", words); }
  Part& note(std::string_view words) { return element("p", "note", words); }
  /// @}
  /// A line about something that went well, and one about something that did not.
  Part& calm(std::string_view words) { return element("p", "calm", words); }
  /// Likewise: what did not go well.
  Part& alarm(std::string_view words) { return element("p", "stop", words); }
  /// @{
  /// A heading within the section, in a colour if there is one.
  Part& heading(std::string_view words) { return element("h3", "", words); }
  Part& heading(std::string_view words, Colour colour);
  /// @}
  /// A drawing with words below it; nothing where there is no drawing.
  Part& figure(const std::string& svg, const std::string& caption = "");
  /// Drawings beside each other, two or three in a row, or with 0 as many as there is room for.
  Part& figures(const std::vector<Figure>& figures, int in_a_row = 2);
  /// A table without its title and note.
  Part& table(const Table& table) { return html(to_html(table)); }
  /// A narrow table, its rows spread over so many beside each other, two or three.
  Part& columns(const Table& table, int in_a_row);
  /// A list with a dot before each item.
  Part& list(const std::vector<std::string>& items);
  /// Numbers in large print, each with its words.
  Part& tiles(const std::vector<KeyNumber>& numbers);
  /// What the colours of a drawing mean.
  Part& key(const std::vector<KeyEntry>& entries);
  /// Two parts side by side where the page is wide enough.
  Part& beside(const Part& wide, const Part& narrow);
  /// Hidden below its summary until it is opened.
  Part& folded(std::string_view summary, const Part& hidden);
  /// Markup as it is.
  Part& html(std::string_view markup);

  [[nodiscard]] const std::string& str() const { return html_; }  ///< markup so far

 private:
  Part& element(std::string_view name, std::string_view kind, std::string_view words);

  std::string html_;
};

/// What stands at the top and at the end of a page.
struct PageHead {
  std::string title;                     ///< words in the tab of the browser
  std::string language = "en";           ///< of the words, as BCP 47 names it
  std::string over = {};                 ///< a small line above the heading
  std::vector<std::string> badges = {};  ///< words beside that line
  std::vector<std::string> alarms = {};  ///< badges in red
  std::string heading = {};
  std::string meta = {};  ///< a small line below the heading
  std::string lead = {};
  std::string footer = {};
};

/// One self-contained HTML page in the one style of tuina: no script, no file beside it, for
/// desktop, phone and paper.
class Page {
 public:
  /// A page without sections.
  explicit Page(PageHead head) : head_(std::move(head)) {}

  /// Between the heading and the first section.
  Part& opening() { return opening_; }
  /// A section that is filled afterwards. A long one may be broken in print.
  Part& section(std::string_view title, std::string_view about = "", bool is_long = true);

  /// The whole page as one HTML file, with styles and drawings in it.
  [[nodiscard]] std::string str() const;

 private:
  struct Section {
    bool is_long;
    Part part;
  };
  PageHead head_;
  Part opening_;
  std::deque<Section> sections_;  // a part stays where it is while others are added
};

}  // namespace tuina::telemetry
