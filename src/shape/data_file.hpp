/// Files of points, footprints and heights: CSV and GeoJSON as plain values. Private to this folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shape/outline.hpp"

namespace brisance::shape {

/// A file whose contents have been read, and the errors about it.
struct DataFile {
  std::filesystem::path path;
  std::string text;

  /// Throws InputError where the file is none, cannot be read, or has more than 256 MiB.
  explicit DataFile(std::filesystem::path file);

  /// ".csv", in small letters.
  [[nodiscard]] std::string kind() const;
  /// Throws InputError with the file's name in front of the message.
  [[noreturn]] void refuse(std::string const& message) const;
  [[noreturn]] void refuse(long line, std::string const& message) const;
};

/// A number, or nothing where the text is something else, not finite or beyond 1e12.
[[nodiscard]] std::optional<double> number_of(std::string_view text);

/// At most 40 bytes for a message, in double quotes.
[[nodiscard]] std::string shown(std::string_view text);

/// A row of a CSV file: the texts of the columns that were asked for, in this order. Those that the file does not have
/// are empty.
struct CsvRow {
  DataFile const& file;
  std::vector<std::string> const& columns;
  long line = 0;  ///< where it begins
  std::vector<std::string_view> texts;

  /// Throws InputError where the column holds no number.
  [[nodiscard]] double number(std::size_t column) const;
  /// The same; nothing where it is empty.
  [[nodiscard]] std::optional<double> number_if_given(std::size_t column) const;
};

/// Reads a CSV file (RFC 4180; separated by commas, semicolons or tabs) whose first line names the columns; lines that
/// begin with # are comments. The first `needed` of the columns must be there; others of the file are ignored. Throws
/// InputError with file, line and value.
void read_csv(DataFile const& file, std::vector<std::string> const& columns, std::size_t needed,
              std::function<void(CsvRow const&)> const& use);

/// A length that a file gives: in its own unit, which a scale makes metres, or with a unit, in metres.
struct Length {
  double value = 0.0;
  bool in_metres = false;

  /// In the unit of the file.
  [[nodiscard]] double in_file(double scale) const { return in_metres ? value / scale : value; }
};

/// A building as a file gives it.
struct Footprint {
  std::string where;  ///< for messages: `feature 3 ("Town hall")`
  Region region;      ///< in the coordinates of the file
  std::optional<Length> height;
  std::optional<Length> base;
};

/// Polygons and MultiPolygons of a GeoJSON file, with two of their properties. Throws InputError with file, feature and
/// value.
[[nodiscard]] std::vector<Footprint> geojson_footprints(DataFile const& file, std::string const& height,
                                                        std::string const& base);

/// A height at a point, and where the file has it.
struct HeightSample {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  long place = 0;  ///< line or feature
};

/// Points and MultiPoints of a GeoJSON file with three coordinates each.
[[nodiscard]] std::vector<HeightSample> geojson_heights(DataFile const& file);

}  // namespace brisance::shape
