/// Units as texts, read by UDUNITS. Private to this folder.
#pragma once

#include <udunits2.h>

#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace brisance::units {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using UnitPointer = std::unique_ptr<ut_unit, FreeUnit>;
using ConverterPointer = std::unique_ptr<cv_converter, FreeConverter>;

/// UDUNITS keeps its status and its scanner in globals, so all calls stand behind this lock.
std::mutex& lock();

/// The unit table, read once; null when UDUNITS is not properly installed.
ut_system* unit_system();

/// A text in quotes, shortened where it is long.
[[nodiscard]] std::string shown(std::string_view text);

/// A unit as UDUNITS reads it, or what is wrong with it.
struct Reading {
  UnitPointer unit;
  int angle = 0;  ///< power of the angle, a pure number to UDUNITS
  std::string problem;
};

/// Reads a unit as a product of powers of the units of decks: `kg m2/s^2`, `J/(kg K)`, `s-1`, `1/s`, or `1`.
[[nodiscard]] Reading read_unit(std::string_view text);

}  // namespace brisance::units
