/// Tables as given in a deck, and reports.
#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "deck/reader.hpp"

namespace brisance::deck {

// --- Section

bool Section::broken(std::string_view key) const {
  auto const found = entries.find(key);
  return found != entries.end() && !found->second.valid;
}

Place Section::place_of(std::string_view key) const {
  auto const found = entries.find(key);
  return found == entries.end() ? place : found->second.place;
}

std::string Section::shown(std::string_view key) const {
  auto const found = entries.find(key);
  return found == entries.end() ? "" : found->second.shown;
}

std::string Section::path_of(std::string_view key) const {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

template <class T>
T const* Section::value(std::string_view key) const {
  auto const found = entries.find(key);
  return found == entries.end() || !found->second.valid ? nullptr : std::get_if<T>(&found->second.value);
}

template <class T>
std::optional<T> Section::value_or_default(std::string_view key) const {
  auto const found = entries.find(key);
  if (found != entries.end()) {
    T const* const v = value<T>(key);
    return v == nullptr ? std::nullopt : std::optional<T>(*v);
  }
  Key const* const declared = table->find(key);
  T const* const v = declared == nullptr ? nullptr : std::get_if<T>(&declared->fallback);
  return v == nullptr ? std::nullopt : std::optional<T>(*v);
}

std::optional<double> Section::number(std::string_view key) const { return value_or_default<double>(key); }
std::optional<long> Section::integer(std::string_view key) const { return value_or_default<long>(key); }
std::optional<bool> Section::boolean(std::string_view key) const { return value_or_default<bool>(key); }
std::optional<std::string> Section::text(std::string_view key) const { return value_or_default<std::string>(key); }
std::vector<double> const* Section::numbers(std::string_view key) const { return value<std::vector<double>>(key); }
std::vector<std::string> const* Section::strings(std::string_view key) const {
  return value<std::vector<std::string>>(key);
}
std::vector<Section> const* Section::sections(std::string_view key) const { return value<std::vector<Section>>(key); }
Section const* Section::section(std::string_view key) const {
  auto const* all = sections(key);
  return all == nullptr || all->empty() ? nullptr : all->data();
}

// --- Report

std::string format(Diagnostic const& d) {
  return d.key.empty() ? fmt::format("{}:{}:{}: error: {}", d.file, d.line, d.column, d.message)
                       : fmt::format("{}:{}:{}: error: {}: {}", d.file, d.line, d.column, d.key, d.message);
}

void Report::error(Place place, std::string key, std::string message) {
  errors_.push_back({file_, place.line, place.column, std::move(key), std::move(message)});
}

void Report::warning(Place place, std::string const& key, std::string const& message) {
  warnings_.push_back(fmt::format("{}:{}:{}: warning: {}: {}", file_, place.line, place.column, key, message));
}

std::vector<Diagnostic> Report::errors() const {
  auto sorted = errors_;
  std::stable_sort(sorted.begin(), sorted.end(), [](Diagnostic const& a, Diagnostic const& b) {
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  return sorted;
}

}  // namespace brisance::deck
