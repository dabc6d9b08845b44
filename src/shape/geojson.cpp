/// GeoJSON (RFC 7946) as footprints and heights.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.hpp"
#include "core/units.hpp"
#include "shape/data_file.hpp"

namespace brisance::shape {

namespace {

using nlohmann::json;

constexpr std::size_t most_bytes = std::size_t{64} << 20U;  // as values they take many times as much

json parsed(DataFile const& file) {
  if (file.text.size() > most_bytes) {
    file.refuse(fmt::format("it has {} MiB; allowed: at most {} MiB of GeoJSON: cut out what lies in the domain",
                            file.text.size() >> 20U, most_bytes >> 20U));
  }
  try {
    json all = json::parse(file.text);
    if (all.is_object()) return all;
  } catch (json::exception const& problem) {
    // Its messages begin with a name in brackets and may quote what is not text.
    std::string message = problem.what();
    if (auto const at = message.find("] "); at != std::string::npos) message.erase(0, at + 2);
    if (auto const at = message.find("; last read"); at != std::string::npos) message.erase(at);
    for (char& c : message) {
      if (c < ' ' || c > '~') c = '?';
    }
    file.refuse(fmt::format("this is not valid JSON: {}", message.substr(0, 200)));
  }
  file.refuse("this is no GeoJSON: it must be one object, for example a FeatureCollection");
}

json const* member(json const& object, std::string const& name) {
  if (!object.is_object()) return nullptr;
  auto const found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

/// The text of a member; empty where it has none.
std::string text_of(json const& object, std::string const& name) {
  json const* const found = member(object, name);
  return found != nullptr && found->is_string() ? found->get<std::string>() : std::string();
}

/// A value for messages; of what holds further lists only the kind, as they may be nested without end.
std::string brief(json const& value) {
  bool const flat = std::all_of(value.begin(), value.end(), [](json const& one) { return one.is_primitive(); });
  if (value.is_object() || (value.is_array() && (!flat || value.size() > 4))) return value.type_name();
  return shown(value.dump(-1, ' ', true));
}

/// A feature, and how messages call it.
struct Feature {
  DataFile const& file;
  std::string where;
  long number = 0;
  json const* geometry = nullptr;
  json const* properties = nullptr;

  [[noreturn]] void refuse(std::string const& message) const { file.refuse(where + ": " + message); }
};

Feature feature_of(DataFile const& file, json const& object, long number) {
  Feature feature{file, fmt::format("feature {}", number), number, member(object, "geometry"),
                  member(object, "properties")};
  std::string name = feature.properties != nullptr ? text_of(*feature.properties, "name") : std::string();
  if (json const* const id = member(object, "id"); name.empty() && id != nullptr)
    name = id->is_string() ? id->get<std::string>() : id->is_number() ? id->dump() : std::string();
  if (!name.empty()) feature.where += " (" + shown(name) + ")";
  if (text_of(object, "type") != "Feature") feature.refuse("it is no Feature; remove it");
  if (feature.geometry == nullptr || !feature.geometry->is_object())
    feature.refuse("it has no geometry; remove it or draw it");
  return feature;
}

/// A file that says that its coordinates are degrees.
void refuse_degrees(DataFile const& file, json const& all) {
  json const* const crs = member(all, "crs");
  json const* const properties = crs != nullptr ? member(*crs, "properties") : nullptr;
  std::string const name = properties != nullptr ? text_of(*properties, "name") : std::string();
  if (name.find("CRS84") == std::string::npos && !name.ends_with(":4326")) return;
  file.refuse(
      fmt::format("its coordinates are longitude and latitude in degrees (crs {}); project them to metres, for "
                  "example to a zone of UTM",
                  shown(name)));
}

std::vector<Feature> features_of(DataFile const& file, json const& all) {
  refuse_degrees(file, all);
  std::string const type = text_of(all, "type");
  std::vector<Feature> features;
  if (type == "FeatureCollection") {
    json const* const list = member(all, "features");
    if (list == nullptr || !list->is_array()) file.refuse("the FeatureCollection has no list \"features\"");
    long number = 0;
    for (json const& one : *list) features.push_back(feature_of(file, one, ++number));
  } else if (type == "Feature") {
    features.push_back(feature_of(file, all, 1));
  } else {
    file.refuse(fmt::format("its type is {}; it must be \"FeatureCollection\" or \"Feature\"", shown(type)));
  }
  if (features.empty()) file.refuse("it contains no features");
  return features;
}

json const& coordinates_of(Feature const& feature) {
  json const* const list = member(*feature.geometry, "coordinates");
  if (list == nullptr || !list->is_array() || list->empty()) feature.refuse("its geometry has no coordinates");
  return *list;
}

/// The first coordinates of a position.
std::vector<double> position_of(Feature const& feature, json const& list, std::size_t needed) {
  if (!list.is_array() || list.size() < needed) {
    feature.refuse(fmt::format("{} is no position of {} coordinates", brief(list), needed));
  }
  std::vector<double> x;
  for (std::size_t d = 0; d < needed; ++d) {
    if (!list[d].is_number() || !(std::abs(list[d].get<double>()) <= 1e12))
      feature.refuse(fmt::format("the coordinate {} is no number or far too large", brief(list[d])));
    x.push_back(list[d].get<double>());
  }
  return x;
}

/// A linear ring: its last position repeats the first. Positions that repeat the one before are left out.
Polygon ring_of(Feature const& feature, json const& list) {
  if (!list.is_array()) feature.refuse("a ring of its polygon is no list of positions");
  Polygon ring;
  for (json const& one : list) {
    auto const x = position_of(feature, one, 2);
    Corner const corner{x[0], x[1]};
    if (ring.empty() || ring.back() != corner) ring.push_back(corner);
  }
  if (ring.size() > 1 && ring.back() == ring.front()) ring.pop_back();
  return ring;
}

Region region_of(Feature const& feature, json const& rings) {
  if (!rings.is_array() || rings.empty()) feature.refuse("one of its polygons has no rings");
  Region region{ring_of(feature, rings.front()), {}};
  for (std::size_t n = 1; n < rings.size(); ++n) region.holes.push_back(ring_of(feature, rings[n]));
  return region;
}

/// A property that is a length: a number, or a text such as "12.5" or "40 ft". Nothing where it is absent, null or "".
std::optional<Length> length_of(Feature const& feature, std::string const& name) {
  json const* const value = feature.properties != nullptr ? member(*feature.properties, name) : nullptr;
  if (value == nullptr || value->is_null()) return std::nullopt;
  if (value->is_number() && std::abs(value->get<double>()) <= 1e12) return Length{value->get<double>(), false};
  if (value->is_string()) {
    auto const text = value->get<std::string>();
    if (text.empty()) return std::nullopt;
    if (auto const plain = number_of(text)) return Length{*plain, false};
    if (text.size() < 100) {
      auto const with_unit = units::parse(text, "m");
      if (with_unit.value && std::abs(*with_unit.value) <= 1e12) return Length{*with_unit.value, true};
    }
  }
  feature.refuse(fmt::format("the property {} is {}; it must be a number in metres or a text such as \"12 m\"",
                             shown(name), brief(*value)));
}

}  // namespace

std::vector<Footprint> geojson_footprints(DataFile const& file, std::string const& height, std::string const& base) {
  json const all = parsed(file);
  std::vector<Footprint> found;
  for (Feature const& feature : features_of(file, all)) {
    std::string const type = text_of(*feature.geometry, "type");
    if (type != "Polygon" && type != "MultiPolygon") {
      feature.refuse(
          fmt::format("its geometry is {}; a footprint is a \"Polygon\" or \"MultiPolygon\": remove the "
                      "feature",
                      shown(type)));
    }
    auto const tall = length_of(feature, height);
    auto const low = length_of(feature, base);
    json const& list = coordinates_of(feature);
    if (type == "Polygon") {
      found.push_back({feature.where, region_of(feature, list), tall, low});
      continue;
    }
    long part = 0;
    for (json const& one : list)
      found.push_back({fmt::format("{}, polygon {}", feature.where, ++part), region_of(feature, one), tall, low});
  }
  return found;
}

std::vector<HeightSample> geojson_heights(DataFile const& file) {
  json const all = parsed(file);
  std::vector<HeightSample> found;
  auto const add = [&](Feature const& feature, json const& one) {
    auto const x = position_of(feature, one, 3);
    found.push_back({x[0], x[1], x[2], feature.number});
  };
  for (Feature const& feature : features_of(file, all)) {
    std::string const type = text_of(*feature.geometry, "type");
    json const& list = coordinates_of(feature);
    if (type == "Point") {
      add(feature, list);
    } else if (type == "MultiPoint") {
      for (json const& one : list) add(feature, one);
    } else {
      feature.refuse(
          fmt::format("its geometry is {}; heights are those of a \"Point\" or \"MultiPoint\" with three "
                      "coordinates: remove the feature",
                      shown(type)));
    }
  }
  return found;
}

}  // namespace brisance::shape
