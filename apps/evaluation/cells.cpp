// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/cells.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "apps/cli/say.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina::app {
namespace {

/// The same on every machine, which std::hash is not ([fowler1991], FNV-1a).
std::uint64_t hash_of(const std::string& name) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char letter : name)
    hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
  return hash;
}

std::vector<std::string> words_of_this_process() {
  std::vector<std::string> words;
  std::ifstream line("/proc/self/cmdline", std::ios::binary);
  for (std::string word; std::getline(line, word, '\0');) words.push_back(word);
  if (!words.empty()) words.erase(words.begin());
  return words;
}

Result<void> append(const std::string& file, const Cells::Json& line) {
  std::ofstream out(file, std::ios::app | std::ios::binary);
  out << line.dump() + "\n" << std::flush;
  if (!out) return fail(Fault::file, "{}: cannot be written", file);
  return {};
}

}  // namespace

std::vector<std::string> campaign_words(const std::vector<std::string>& words) {
  const std::vector<std::string> with_value = {"--shard", "--out", "--merged", "--keep"};
  const std::vector<std::string> alone = {"--json", "--quiet"};
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string name = words[i].substr(0, words[i].find('='));
    if (std::count(alone.begin(), alone.end(), name) > 0) continue;
    if (std::count(with_value.begin(), with_value.end(), name) == 0) {
      kept.push_back(words[i]);
    } else if (name == words[i]) {
      ++i;
    }
  }
  return kept;
}

Result<Cells::Json> read_header(const std::string& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  auto header = Cells::Json::parse(text->substr(0, text->find('\n')), nullptr, false);
  if (!header.is_object() || !header.contains("cells_of") || !header.contains("words"))
    return fail(Fault::bad_input, "{}:1: is no file of `evaluate ... --shard`", file);
  return header;
}

void Cells::describe(Options& options, std::string* out) {
  const auto is_shard = [](const std::string& word) {
    const std::size_t slash = word.find('/');
    const auto part = to_number<std::uint64_t>(word.substr(0, slash));
    const auto parts = slash == std::string::npos
                           ? std::nullopt
                           : to_number<std::uint64_t>(word.substr(slash + 1));
    const bool good = part && parts && *part >= 1 && *part <= *parts && *parts <= 1'000'000;
    return good ? "" : fmt::format("{}: is not K/N with K from 1 to N", word);
  };
  const auto shard = options
                         .add("--shard", shard_,
                              "only the K-th of N parts, into the file --out; `evaluate merge` "
                              "makes the tables")
                         .check(is_shard, "K/N");
  if (out == nullptr) {
    options.add("--out", own_out_, "file of a shard; goes on where it ended").needs(shard);
  } else {
    out_ = out;
  }
  options.add("--merged", merged_, "a file of a shard, as `evaluate merge` hands it over")
      .one_word_each()
      .excludes(shard);
}

Result<void> Cells::open(const CommonOptions&, const session::Config& config) {
  if (sharded()) {
    if (out_->empty()) return fail(Fault::usage, "--shard: --out names the file for its cells");
    const std::size_t slash = shard_.find('/');
    part_ = *to_number<std::uint64_t>(shard_.substr(0, slash));
    parts_ = *to_number<std::uint64_t>(shard_.substr(slash + 1));
    file_ = *out_;
  }
  if (sharded() && words_) return fail(Fault::usage, "--shard and --keep: one of them");
  const Json header = {{"cells_of", TUINA_VERSION},
                       {"words", words_ ? *words_ : campaign_words(words_of_this_process())},
                       {"config", session::to_toml(config)}};
  for (const std::string& file : merged_) {
    if (auto known = read_file_of(file, header); !known) return known;
  }
  if (file_.empty()) return {};
  if (std::filesystem::exists(file_)) return read_file_of(file_, header);
  return append(file_, header);
}

Result<void> Cells::read_file_of(const std::string& file, const Json& header) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const auto first = read_header(file);
  if (!first) return tl::unexpected(first.error());
  for (const char* key : {"cells_of", "words", "config"}) {
    if (first->at(key) == header.at(key)) continue;
    const char* what = key == std::string("cells_of") ? "version of tuina"
                       : key == std::string("words")  ? "command line"
                                                      : "configuration";
    return fail(Fault::bad_input, "{}:1: holds cells of another {}; they do not belong together",
                file, what);
  }
  std::istringstream lines(*text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (number == 1) continue;
    const auto entry = Json::parse(line, nullptr, false);
    // A run that was killed leaves half a line at the end; that cell counts as not done.
    if (entry.is_discarded() && lines.peek() == std::char_traits<char>::eof() &&
        text->back() != '\n') {
      if (file == file_) std::filesystem::resize_file(file, text->size() - line.size());
      break;
    }
    if (!entry.is_object() || !entry.contains("cell") || !entry["cell"].is_string() ||
        !entry.contains("result")) {
      return fail(Fault::bad_input, "{}:{}: is no cell of an evaluation", file, number);
    }
    const auto name = entry["cell"].get<std::string>();
    if (!known_.try_emplace(name, entry["result"]).second) repeated_.push_back(name);
  }
  return {};
}

const Cells::Json* Cells::find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  ++asked_;
  const auto found = known_.find(name);
  if (found == known_.end()) return nullptr;
  ++done_;
  return &found->second;
}

bool Cells::mine(const std::string& name) {
  if (!merged_.empty()) {
    const std::lock_guard lock(mutex_);
    lost_.push_back(name);
    return false;
  }
  return hash_of(name) % parts_ == part_ - 1;
}

Result<void> Cells::add(const std::string& name, const Json& line) {
  const std::lock_guard lock(mutex_);
  ++done_;
  if (file_.empty()) return {};
  return append(file_, {{"cell", name}, {"result", line}});
}

Result<Answer> Cells::answer(const std::function<Result<Answer>()>& tables) const {
  if (sharded()) {
    const Json json = {{"shard", shard_}, {"cells", done_}, {"of", asked_}, {"file", file_}};
    return Answer{.json = json.dump(2),
                  .text = fmt::format("{} of {} cells are in {}", done_, asked_, file_)};
  }
  if (!lost_.empty()) {
    constexpr std::size_t max_named = 8;
    std::vector<std::string> lost = lost_;
    std::sort(lost.begin(), lost.end());
    const std::size_t all = lost.size();
    lost.resize(std::min(all, max_named));
    return fail(Fault::bad_input,
                "{} of {} cells are in none of the files: {}{}; do their shard again", all, asked_,
                fmt::join(lost, ", "), all > max_named ? ", ..." : "");
  }
  // One that was done twice has one result, but for computing times; the first is taken.
  if (!repeated_.empty())
    say(fmt::format("done more than once, counted once: {}\n", fmt::join(repeated_, ", ")));
  return tables();
}

}  // namespace tuina::app
