/// [[contact]]: bodies that touch, slide and part.
#include <fmt/format.h>

#include <algorithm>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/settings.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

namespace {

Settings<mpm::Contact> const& settings() {
  using C = mpm::Contact;
  static Settings<C> const all{
      typed(Type::names, "bodies").required().like("[\"rod\", \"plate\"]").means("Names of the two bodies"),
      {&C::friction, number("friction", "1", 0.0, 10.0).like("0.2").means("Coulomb friction coefficient")}};
  return all;
}

}  // namespace

Table const& contact_table() {
  static Table const table{
      "Two bodies that can touch, slide and separate. Bodies without a contact share the motion of the grid where they "
      "meet: they stick together.",
      settings().keys(),
      {},
      {}};
  return table;
}

void build_contacts(Draft& draft) {
  draft.each("contact", [&](Section const& section) {
    auto const* names = section.strings("bodies");
    mpm::Contact contact;
    if (!settings().read(section, contact) || names == nullptr) return;
    if (names->size() != 2 || (*names)[0] == (*names)[1]) {
      draft.error(section, "bodies",
                  fmt::format("{} does not name two bodies; write, for example, bodies = [\"rod\", \"plate\"]",
                              section.shown("bodies")));
      return;
    }
    auto const first = body_named(draft, section, "bodies", (*names)[0]);
    auto const second = body_named(draft, section, "bodies", (*names)[1]);
    if (!first || !second) return;
    if (is_rigid(draft, static_cast<std::size_t>(*first)) && is_rigid(draft, static_cast<std::size_t>(*second))) {
      draft.error(section, "bodies",
                  fmt::format("{} and {} are both rigid and keep their velocities, so their contact has no effect: "
                              "remove it, or make one of them deformable",
                              (*names)[0], (*names)[1]));
      return;
    }
    if (int const of_first = draft.body_regions[static_cast<std::size_t>(*first)],
        of_second = draft.body_regions[static_cast<std::size_t>(*second)];
        of_first != of_second) {
      draft.error(
          section, "bodies",
          fmt::format("{} is in {} and {} in {}, and bodies of different MPM regions never touch: put both into "
                      "one region, or remove the contact",
                      (*names)[0], draft.region_sections()[static_cast<std::size_t>(of_first)].path, (*names)[1],
                      draft.region_sections()[static_cast<std::size_t>(of_second)].path));
      return;
    }
    for (mpm::Contact const& other : draft.out.particles.contacts) {
      if (std::minmax(other.first, other.second) != std::minmax(*first, *second)) continue;
      draft.error(section, "bodies",
                  fmt::format("{} and {} already have a contact: remove one of the two", (*names)[0], (*names)[1]));
      return;
    }
    contact.first = *first;
    contact.second = *second;
    draft.out.particles.contacts.push_back(contact);
  });
}

}  // namespace brisance::deck
