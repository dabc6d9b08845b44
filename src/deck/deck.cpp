/// Decks from files and from memory.
#include "deck/deck.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "core/error.hpp"
#include "deck/draft.hpp"
#include "deck/parameters.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

/// The materials of the case that was built, and the deck's others.
std::vector<MaterialNumbers> materials_of(Draft const& draft) {
  run::Case const& built = draft.out;
  std::vector<MaterialNumbers> out;
  auto const add = [&](auto const* material, std::string_view table, bool used) {
    if (material == nullptr) return;
    for (auto const& known : out) {
      if (known.name == material->name) return;
    }
    MaterialNumbers one;
    one.name = material->name;
    one.used = used;
    one.numbers = numbers_of(*material);
    auto const* all = draft.deck.sections(table);
    for (std::size_t n = 0; all != nullptr && n < all->size(); ++n) {
      if ((*all)[n].name != material->name) continue;
      one.from_library = false;
      note_origin(one.numbers, (*all)[n]);
    }
    if (one.from_library) one.note = library().note(one.name);
    out.push_back(std::move(one));
  };
  if (draft.has_gas) {
    add(draft.materials.fluid(built.ambient.fluid.name), "fluids", true);
    for (auto const& fluid : built.other_fluids) {
      if (!built.charges.empty()) break;  // they are these fluids
      add(draft.materials.fluid(fluid.name), "fluids", true);
      add(draft.materials.explosive(fluid.name), "explosives", true);
    }
    for (auto const& charge : built.charges) add(draft.materials.explosive(charge.explosive.name), "explosives", true);
  }
  for (auto const& body : built.particles.bodies) {
    add(draft.materials.solid(body.solid.name), "solids", true);
    add(draft.materials.explosive(body.solid.name), "explosives", true);
    add(draft.materials.fluid(body.solid.name), "fluids", true);
  }
  for (auto const& own : draft.materials.explosives) add(&own, "explosives", false);
  for (auto const& own : draft.materials.fluids) add(&own, "fluids", false);
  for (auto const& own : draft.materials.solids) add(&own, "solids", false);
  return out;
}

}  // namespace

Result read_text(std::string_view text, std::string_view name) {
  Result result;
  Report report{std::string(name)};
  auto const deck = read(text, deck_schema(), report);
  if (deck) {
    Draft draft = build_case(*deck, report);
    if (!report.failed()) {
      run::Case& built = draft.out;
      result.materials = materials_of(draft);
      built.deck_path = name;
      built.deck_text = text;
      result.case_ = std::move(built);
    }
  }
  result.errors = report.errors();
  if (!report.failed()) result.warnings = report.warnings();
  return result;
}

std::string text_of(std::string const& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  std::array<char, 65536> part{};
  while (text.size() <= largest_deck && (file.read(part.data(), part.size()), file.gcount() > 0)) {
    text.append(part.data(), static_cast<std::size_t>(file.gcount()));
  }
  // A folder opens, but does not read.
  if (!file.is_open() || file.bad()) throw IoError(fmt::format("cannot read the deck \"{}\"", path));
  return text;
}

Result read_file(std::string const& path) {
  Result too_large;
  std::error_code unknown;  // of a pipe: the reading ends at the limit
  auto const size = std::filesystem::file_size(path, unknown);
  if (!unknown && size > largest_deck) {
    too_large.errors.push_back({path, 1, 1, "", size_problem(fmt::format("{}", size))});
    return too_large;
  }
  std::string const text = text_of(path);
  if (text.size() > largest_deck) {
    too_large.errors.push_back({path, 1, 1, "", size_problem(fmt::format("more than {}", largest_deck))});
    return too_large;
  }
  return read_text(text, path);
}

}  // namespace brisance::deck
