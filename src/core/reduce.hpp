/// Sums and largest values over blocks (or other numbered pieces of work): the parts are found in parallel and joined
/// in the order of their numbers, so that the bits do not depend on the threads.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/parallel.hpp"

namespace brisance {

/// Calls part(index) for every index in [0, count) in parallel, by the rules of `parallel_for`, and then
/// join(result, its value) one after the other, beginning with `start`. An exception from a part is rethrown.
template <class Result, class Part, class Join>
[[nodiscard]] Result reduce(int count, Result start, Part&& part, Join&& join) {
  using Value = std::remove_cvref_t<std::invoke_result_t<Part&, int>>;
  static_assert(!std::is_same_v<Value, bool>, "the bools of a vector share bytes: return a char");
  std::vector<Value> parts(static_cast<std::size_t>(std::max(count, 0)));
  parallel_for(count, [&](int index, int) { parts[static_cast<std::size_t>(index)] = part(index); });
  for (Value& value : parts) join(start, std::move(value));
  return start;
}

/// Sum of part(index) over [0, count), by `+=` onto a value-initialised one.
template <class Part>
[[nodiscard]] auto sum_over(int count, Part&& part) {
  using Value = std::remove_cvref_t<std::invoke_result_t<Part&, int>>;
  return reduce(count, Value{}, part, [](Value& sum, Value const& value) { sum += value; });
}

/// The largest of `least` and of part(index) over [0, count); NaN is passed over.
template <class Part>
[[nodiscard]] double largest_over(int count, double least, Part&& part) {
  return reduce(count, least, part, [](double& most, double value) { most = std::max(most, value); });
}

/// Both without threads, for parts that are at hand.
template <class Part>
[[nodiscard]] auto sum_at_hand(int count, Part&& part) {
  std::remove_cvref_t<std::invoke_result_t<Part&, int>> sum{};
  for (int index = 0; index < count; ++index) sum += part(index);
  return sum;
}
template <class Part>
[[nodiscard]] double largest_at_hand(int count, double least, Part&& part) {
  for (int index = 0; index < count; ++index) least = std::max(least, static_cast<double>(part(index)));
  return least;
}

}  // namespace brisance
