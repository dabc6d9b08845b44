/// Numbers as people read them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace brisance {

/// Value with the SI prefix that keeps it short: quantity(12345.0, "Pa") is "12.35 kPa". No prefix for "kg" and pure
/// numbers.
[[nodiscard]] std::string quantity(double value, std::string_view unit, int digits = 4);

/// A duration on the clock: "4.2 s", "3 min 12 s", "5 h 07 min".
[[nodiscard]] std::string wall_time(double seconds);

/// A span of time that somebody has chosen: "20 ms", and from a minute on as `wall_time`.
[[nodiscard]] std::string clock_time(double seconds);

/// A memory or file size: "1.23 GB" (powers of 1000).
[[nodiscard]] std::string bytes(double count);

/// A large count: "1.23 million".
[[nodiscard]] std::string large_count(double count);

/// Messages of which people read no more than these.
inline constexpr std::size_t most_messages = 50;

/// The first messages, each on a line of its own, and how many more there are.
[[nodiscard]] std::string listed(std::vector<std::string> const& messages);

}  // namespace brisance
