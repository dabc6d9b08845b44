#include "mpm/grid_fields.hpp"

#include <algorithm>
#include <utility>

#include "core/error.hpp"

namespace brisance::mpm {

namespace {

/// Can the material pull at a wall? Gases and explosives cannot, nor can liquids that have no tension.
bool pulls(material::Material const& solid) {
  if (solid.has_deviator()) return true;
  return !solid.mixes() && !solid.burns() && !solid.is_gas() && solid.minimum_pressure < 0.0;
}

/// Which bodies have a grid field of their own.
std::vector<char> own_fields(std::vector<Body> const& bodies, std::vector<Contact> const& contacts) {
  int const count = static_cast<int>(bodies.size());
  std::vector<char> own(bodies.size(), 0);
  for (Contact const& c : contacts) {
    if (c.first == c.second || c.first < 0 || c.second < 0 || c.first >= count || c.second >= count) {
      throw InputError("a contact joins two different bodies");
    }
    own[c.first] = 1;
    own[c.second] = 1;
  }
  for (int b = 0; b < count; ++b) {
    if (bodies[b].rigid_velocity) own[b] = 1;
  }
  return own;
}

std::vector<std::pair<int, double>> contacts_of(int body, std::vector<Contact> const& contacts) {
  std::vector<std::pair<int, double>> found;
  for (Contact const& c : contacts) {
    if (c.first == body || c.second == body) found.emplace_back(c.first == body ? c.second : c.first, c.friction);
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// Fills `field_of` and `fields`.
void number_fields(GridFields& g, std::vector<Body> const& bodies, std::vector<Contact> const& contacts) {
  int const count = static_cast<int>(bodies.size());
  std::vector<char> const own = own_fields(bodies, contacts);
  g.field_of.assign(bodies.size(), 0);
  g.fields = 0;
  for (bool const slips : {false, true}) {
    int members = 0;
    for (int b = 0; b < count; ++b) {
      if (own[b] != 0 || bodies[b].slips != slips) continue;
      g.field_of[b] = g.fields;
      ++members;
    }
    if (members > 0) ++g.fields;
  }
  for (int b = 0; b < count; ++b) {
    if (own[b] == 0) continue;
    g.field_of[b] = -1;
    for (int a = 0; a < b && g.field_of[b] < 0 && bodies[b].rigid_velocity; ++a) {
      bool const alike =
          bodies[a].rigid_velocity == bodies[b].rigid_velocity && contacts_of(a, contacts) == contacts_of(b, contacts);
      if (alike) g.field_of[b] = g.field_of[a];
    }
    if (g.field_of[b] < 0) g.field_of[b] = g.fields++;
  }
}

void find_laws(GridFields& g, std::vector<Contact> const& contacts) {
  g.laws.assign(static_cast<std::size_t>(g.fields) * g.fields, Law{});
  for (int a = 0; a < g.fields; ++a) {
    for (int b = 0; b < g.fields; ++b) {
      if (g.slips[a] == g.slips[b]) continue;
      g.laws[a * g.fields + b].kind = Law::Kind::slips;
      g.slides = true;
    }
  }
  g.parts.assign(g.fields, 0);
  for (Contact const& c : contacts) {
    int const a = g.field_of[c.first];
    int const b = g.field_of[c.second];
    g.laws[a * g.fields + b] = {Law::Kind::contact, c.friction};
    g.laws[b * g.fields + a] = {Law::Kind::contact, c.friction};
    g.touches = true;
    g.parts[a] = g.parts[b] = 1;
  }
}

}  // namespace

GridFields make_grid_fields(grid::Domain const& domain, Options const& options, std::vector<Body> const& bodies,
                            std::vector<BodyRules> const& rules, std::vector<Contact> const& contacts) {
  GridFields g;
  number_fields(g, bodies, contacts);
  g.slips.assign(g.fields, 0);
  g.one_sided.assign(g.fields, 0);
  g.affine.assign(g.fields, 0);
  g.shared.assign(g.fields, 0);
  g.heats.assign(g.fields, 0);
  g.early.assign(g.fields, 1);
  g.rigid.resize(g.fields);
  std::vector<char> increments(g.fields, 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Body const& body = bodies[b];
    int const f = g.field_of[b];
    g.slips[f] = body.slips ? 1 : 0;
    if (pulls(body.solid) && !body.rigid_velocity) g.one_sided[f] = 1;
    (rules[b].affine ? g.affine : increments)[f] = 1;
    if (rules[b].keeps_energy) g.heats[f] = 1;
    if (rules[b].order != StressOrder::usl) g.early[f] = 0;
    if (body.rigid_velocity) g.rigid[f] = body.rigid_velocity;
    if (body.fills_space) g.filling = f;
    g.maps_back = g.maps_back || rules[b].order == StressOrder::musl;
    g.strains_early = g.strains_early || rules[b].order == StressOrder::usl;
    g.keeps_energy = g.keeps_energy || rules[b].keeps_energy;
    g.counts_energy = g.counts_energy || (rules[b].affine && !body.rigid_velocity);
    g.books_work = g.books_work || rules[b].books_work;
    g.conducts = g.conducts || body.shock_conduction > 0.0;
    g.filters = g.filters || body.transfer.value_or(options.transfer) == Transfer::xpic;
    g.pushes = g.pushes || body.rigid_velocity.has_value();
  }
  for (int f = 0; f < g.fields; ++f) g.shared[f] = g.affine[f] != 0 && increments[f] != 0 ? 1 : 0;
  g.contact = g.fields > 1;
  auto const& faces = domain.boundary;
  g.stops = std::find(g.one_sided.begin(), g.one_sided.end(), 1) != g.one_sided.end() &&
            std::find(faces.begin(), faces.end(), grid::Boundary::wall) != faces.end();
  find_laws(g, contacts);
  return g;
}

}  // namespace brisance::mpm
