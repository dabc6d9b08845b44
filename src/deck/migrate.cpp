#include "deck/migrate.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>

#include "core/error.hpp"
#include "deck/values.hpp"

namespace brisance::deck {

namespace {

struct OldKey {
  std::string_view table;
  std::string_view was;
  std::string_view now;
};

/// "Region" alone means the MPM region.
constexpr std::array old_keys{
    OldKey{"", "region", "initial_state"},
    OldKey{"constraint", "region", "within"},
    OldKey{"constraint", "held", "components"},
    OldKey{"surface_pressure", "region", "within"},
};

/// Where a line of a text begins, in bytes.
std::vector<std::size_t> line_starts(std::string_view text) {
  std::vector<std::size_t> starts{0};
  for (std::size_t n = 0; n < text.size(); ++n) {
    if (text[n] == '\n') starts.push_back(n + 1);
  }
  return starts;
}

/// Finds the old keys of a parsed deck in its text.
class Finder {
 public:
  Finder(std::string_view text, std::string_view name) : text_(text), name_(name), lines_(line_starts(text)) {}

  void search(toml::table const& table, std::string const& path) {
    for (auto const& [key, node] : table) {
      auto const now = present_name(path, key.str());
      if (now) rename(table, path, key, node, *now);
      // What the old key held is known by its new name from here on.
      std::string const name(now ? *now : key.str());
      search_within(node, path.empty() ? name : fmt::format("{}.{}", path, name));
    }
  }

  struct Place {
    std::size_t offset = 0;  ///< of the key's old name in the text [bytes]
    std::size_t length = 0;
    std::string_view now;
    Renaming renaming;
    bool operator<(Place const& other) const { return offset < other.offset; }
  };
  [[nodiscard]] std::vector<Place> places() const {
    std::vector<Place> sorted = places_;
    std::sort(sorted.begin(), sorted.end());
    auto const same = [](Place const& a, Place const& b) { return a.offset == b.offset; };
    sorted.erase(std::unique(sorted.begin(), sorted.end(), same), sorted.end());
    return sorted;
  }

 private:
  void search_within(toml::node const& node, std::string const& path) {
    if (auto const* table = node.as_table()) search(*table, path);
    if (auto const* array = node.as_array()) {
      for (auto const& element : *array) search_within(element, path);
    }
  }

  void rename(toml::table const& table, std::string const& path, toml::key const& key, toml::node const& node,
              std::string_view now) {
    if (table.contains(now)) {
      throw InputError(fmt::format("{}:{}: {} contains both \"{}\" and its current name \"{}\": remove one", name_,
                                   key.source().begin.line, path.empty() ? "the deck" : path, key.str(), now));
    }
    add(key.source().begin, path, key.str(), now);
    // Each header [[NAME]] of an array of tables is a place of its own.
    auto const* array = node.as_array();
    if (array == nullptr) return;
    for (auto const& element : *array) {
      toml::source_position const begin = element.source().begin;
      if (element.is_table() && offset_of(begin) < text_.size() && text_[offset_of(begin)] == '[')
        add(begin, path, key.str(), now);
    }
  }

  /// A column counts code points.
  [[nodiscard]] std::size_t offset_of(toml::source_position const& place) const {
    if (place.line == 0 || place.line > lines_.size()) return text_.size();
    std::size_t at = lines_[place.line - 1];
    for (toml::source_index column = 1; column < place.column && at < text_.size(); ++column) {
      ++at;
      while (at < text_.size() && (static_cast<unsigned char>(text_[at]) & 0xC0U) == 0x80U) ++at;
    }
    return at;
  }

  /// The name is the first thing in its line from `begin` on but for brackets, blanks and quotation marks.
  void add(toml::source_position const& begin, std::string const& path, std::string_view was, std::string_view now) {
    std::size_t const from = offset_of(begin);
    std::size_t const at = std::min(text_.find_first_not_of("[ \t\"'", from), text_.size());
    if (text_.substr(at, was.size()) != was) return;  // written with escapes: what is left over is reported
    std::string const prefix = path.empty() ? "" : path + ".";
    places_.push_back(
        {at, was.size(), now, {static_cast<int>(begin.line), prefix + std::string(was), prefix + std::string(now)}});
  }

  std::string_view text_;
  std::string_view name_;
  std::vector<std::size_t> lines_;
  std::vector<Place> places_;
};

toml::table parsed(std::string_view text, std::string_view name) {
  Report report{std::string(name)};
  auto table = parse(text, report);
  if (!table) throw InputError(format(report.errors().front()));
  return *std::move(table);
}

}  // namespace

std::optional<std::string_view> present_name(std::string_view table, std::string_view key) {
  for (OldKey const& old : old_keys) {
    if (old.table == table && old.was == key) return old.now;
  }
  return std::nullopt;
}

Migration migrate(std::string_view text, std::string_view name) {
  Finder finder(text, name);
  finder.search(parsed(text, name), "");
  Migration out;
  std::size_t done = 0;
  for (Finder::Place const& place : finder.places()) {
    out.text += text.substr(done, place.offset - done);
    out.text += place.now;
    done = place.offset + place.length;
    out.renamings.push_back(place.renaming);
  }
  out.text += text.substr(done);
  // Names that are written in a way that was not found above would be left.
  Finder rest(out.text, name);
  rest.search(parsed(out.text, name), "");
  if (auto const left = rest.places(); !left.empty()) {
    throw InputError(fmt::format("{}:{}: cannot rename \"{}\"; write \"{}\" by hand", name, left.front().renaming.line,
                                 left.front().renaming.was, left.front().renaming.now));
  }
  return out;
}

}  // namespace brisance::deck
