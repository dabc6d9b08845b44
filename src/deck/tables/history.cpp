#include "deck/tables/history.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/error.hpp"
#include "core/units.hpp"
#include "deck/keys.hpp"
#include "deck/values.hpp"

namespace brisance::deck {

namespace {

constexpr std::size_t most_rows = 100000;   ///< of a file
constexpr std::size_t longest_line = 4096;  ///< [bytes]

/// The first two numbers of a line, separated by comma, semicolon or space; nothing where they are none.
std::optional<std::array<double, 2>> two_numbers(std::string_view line) {
  std::array<double, 2> out{};
  constexpr std::string_view between = " \t,;\r";
  for (double& value : out) {
    std::size_t const begin = line.find_first_not_of(between);
    if (begin == std::string_view::npos) return std::nullopt;
    line.remove_prefix(begin);
    if (line.front() == '+') line.remove_prefix(1);
    auto const [end, problem] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (problem != std::errc{} || !std::isfinite(value)) return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    if (!line.empty() && between.find(line.front()) == std::string_view::npos) return std::nullopt;
  }
  return out;
}

bool is_comment(std::string_view line) {
  std::size_t const begin = line.find_first_not_of(" \t\r");
  return begin == std::string_view::npos || line[begin] == '#';
}

/// Rows of a file, with factors to SI units. Throws InputError with line and remedy.
History read_file(std::filesystem::path const& path, double per_time, double per_value) {
  std::ifstream in(path);
  if (!in || std::filesystem::is_directory(path))
    throw InputError(fmt::format("the file \"{}\" cannot be opened; paths are relative to the deck", path.string()));
  History out;
  std::string line;
  bool headed = false;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (line.size() > longest_line) {
      throw InputError(fmt::format("line {} of \"{}\" has {} bytes; allowed: at most {}", number, path.string(),
                                   line.size(), longest_line));
    }
    if (is_comment(line)) continue;
    auto const row = two_numbers(line);
    if (!row && out.times.empty() && !headed) {
      headed = true;  // one line of titles
      continue;
    }
    if (!row) {
      throw InputError(
          fmt::format("line {} of \"{}\" is \"{}\"; expected two numbers, a time and a value, separated "
                      "by a comma",
                      number, path.string(), shortened(line)));
    }
    if (out.times.size() == most_rows)
      throw InputError(fmt::format("\"{}\" has more than {} rows: leave out some", path.string(), most_rows));
    double const time = (*row)[0] * per_time;
    if (!out.times.empty() && !(time > out.times.back())) {
      throw InputError(fmt::format("in line {} of \"{}\" {:g} s follows {:g} s: the times must increase", number,
                                   path.string(), time, out.times.back()));
    }
    out.times.push_back(time);
    out.values.push_back((*row)[1] * per_value);
  }
  if (out.times.size() < 2)
    throw InputError(
        fmt::format("\"{}\" has {} rows of numbers; expected at least two", path.string(), out.times.size()));
  return out;
}

/// What the numbers of the two columns are multiplied with; nothing after an error.
std::optional<std::array<double, 2>> factors(Draft const& draft, Section const& history, Key const& values) {
  std::array<double, 2> out{1.0, 1.0};
  if (!history.given("units")) return out;
  auto const* given = history.strings("units");
  if (given == nullptr) return std::nullopt;
  if (given->size() != 2) {
    draft.error(history, "units",
                fmt::format("{} has {} elements; expected two, of the time and of the values", history.shown("units"),
                            given->size()));
    return std::nullopt;
  }
  std::array<std::string, 2> const wanted{"s", values.unit};
  for (std::size_t n = 0; n < 2; ++n) {
    auto const read = units::parse("1 " + (*given)[n], wanted[n]);
    if (!read.value) {
      draft.error(history, "units", fmt::format("{}; write, for example, [\"ms\", \"{}\"]", read.problem, wanted[1]));
      return std::nullopt;
    }
    out[n] = *read.value;
  }
  return out;
}

/// The history of a file; nothing after an error.
std::optional<History> from_file(Draft const& draft, Section const& history, Key const& values) {
  auto const file = history.text("file");
  auto const factor = factors(draft, history, values);
  if (!file || !factor) return std::nullopt;
  for (std::string_view const key : {std::string_view("times"), std::string_view(values.name)}) {
    if (!history.given(key)) continue;
    draft.error(history, key, "is given together with file: remove one of the two");
    return std::nullopt;
  }
  try {
    History out =
        read_file(std::filesystem::path(draft.report.file()).parent_path() / *file, (*factor)[0], (*factor)[1]);
    if (out.times.front() < 0.0 || out.times.back() > longest) {
      draft.error(history, "file",
                  fmt::format("its times go from {:g} to {:g} s; allowed: 0 to {:g} s", out.times.front(),
                              out.times.back(), longest));
      return std::nullopt;
    }
    for (double const value : out.values) {
      if (value >= values.minimum && value <= values.maximum) continue;
      draft.error(history, "file",
                  fmt::format("it has a value of {:g} {}; allowed: {}", value, values.unit, range_text(values)));
      return std::nullopt;
    }
    return out;
  } catch (InputError const& problem) {
    draft.error(history, "file", problem.what());
    return std::nullopt;
  }
}

}  // namespace

std::vector<Key> history_file_keys(std::string const& values) {
  return {typed(Type::text, "file")
              .note("none")
              .like("\"record.csv\"")
              .means("CSV file in place of `times` and `" + values +
                     "`, with a path relative to the deck: time and value in the first two columns, in SI units or in "
                     "`units`; lines that begin with # are comments, and the first line may hold titles"),
          typed(Type::names, "units").note("SI").like("[\"ms\", \"kPa\"]").means("Units of the two columns of `file`")};
}

std::optional<History> build_history(Draft const& draft, Section const& history, std::string_view values) {
  Key const& key = *history.table->find(values);
  if (history.given("file")) return from_file(draft, history, key);
  if (history.given("units")) {
    draft.error(history, "units", "belongs to file: remove it, and write units behind the numbers");
    return std::nullopt;
  }
  for (std::string_view const needed : {std::string_view("times"), values}) {
    if (history.given(needed)) continue;
    draft.report.error(history.place, history.path_of(needed),
                       fmt::format("the key \"{}\" is missing; write, for example, {} = {}, or file = \"record.csv\"",
                                   needed, needed, history.table->find(needed)->sample));
    return std::nullopt;
  }
  auto const* times = history.numbers("times");
  auto const* given = history.numbers(values);
  if (times == nullptr || given == nullptr) return std::nullopt;
  if (times->size() != given->size() || times->size() < 2) {
    draft.error(history, values,
                fmt::format("there are {} times and {} {}; expected equal numbers, at least two", times->size(),
                            given->size(), values));
    return std::nullopt;
  }
  for (std::size_t i = 1; i < times->size(); ++i) {
    if ((*times)[i] > (*times)[i - 1]) continue;
    draft.error(history, "times",
                fmt::format("{:g} s follows {:g} s: the times must increase", (*times)[i], (*times)[i - 1]));
    return std::nullopt;
  }
  return History{*times, *given};
}

}  // namespace brisance::deck
