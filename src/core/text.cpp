#include "core/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace brisance {

std::string quantity(double value, std::string_view unit, int digits) {
  struct Prefix {
    double factor;
    char const* text;
  };
  constexpr std::array prefixes{Prefix{1e9, "G"}, Prefix{1e6, "M"},  Prefix{1e3, "k"},
                                Prefix{1.0, ""},  Prefix{1e-3, "m"}, Prefix{1e-6, "u"}};
  if (unit == "1" || unit.empty()) return fmt::format("{:.{}g}", value, digits);
  if (unit == "kg" || value == 0.0 || !std::isfinite(value)) return fmt::format("{:.{}g} {}", value, digits, unit);
  // What rounds up to the next prefix takes it: 999.96 Pa is 1 kPa.
  double const size = std::abs(value) * (1.0 + 0.5 * std::pow(10.0, -digits));
  for (Prefix const& p : prefixes) {
    if (size >= p.factor) return fmt::format("{:.{}g} {}{}", value / p.factor, digits, p.text, unit);
  }
  return fmt::format("{:.{}g} n{}", value * 1e9, digits, unit);
}

std::string wall_time(double seconds) {
  if (!std::isfinite(seconds)) return "unknown";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  auto const whole = static_cast<long>(std::lround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string clock_time(double seconds) { return seconds < 60.0 ? quantity(seconds, "s") : wall_time(seconds); }

std::string bytes(double count) {
  if (count < 999.5) return fmt::format("{:.0f} B", count);
  if (count < 999.5e3) return fmt::format("{:.3g} kB", count / 1e3);
  if (count < 999.5e6) return fmt::format("{:.3g} MB", count / 1e6);
  if (count < 999.5e9) return fmt::format("{:.3g} GB", count / 1e9);
  return fmt::format("{:.4g} TB", count / 1e12);
}

std::string large_count(double count) {
  if (count < 999.5e3) return fmt::format("{:.0f}", count);
  if (count < 999.5e6) return fmt::format("{:.3g} million", count / 1e6);
  return fmt::format("{:.4g} billion", count / 1e9);
}

std::string listed(std::vector<std::string> const& messages) {
  std::string out;
  for (std::size_t n = 0; n < std::min(messages.size(), most_messages); ++n) out += messages[n] + "\n";
  if (messages.size() > most_messages) out += fmt::format("and {} more\n", messages.size() - most_messages);
  return out;
}

}  // namespace brisance
