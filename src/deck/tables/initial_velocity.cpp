/// The velocity of bodies and initial states at the start: constant, by expressions, turning.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"
#include "setup/velocity_field.hpp"
#include "shape/shares.hpp"

namespace brisance::deck {

namespace {

constexpr double fastest = 1e5;      ///< [m/s]
constexpr double most_places = 1e6;  ///< at which a velocity is checked
constexpr double round_off = 1e-9;   ///< fraction of the largest speed that is round-off

}  // namespace

std::vector<Key> initial_velocity_keys(std::string const& otherwise) {
  Key velocity = typed(Type::field, "velocity", "m/s", -fastest, fastest);
  velocity.like("[\"-100*x\", \"500*y\", 0]")
      .note(otherwise)
      .means(
          "Initial velocity. An expression in quotes gives a component in m/s as a function of x, y and z in m: + - * "
          "/ "
          "^, comparisons, `a ? b : c`, `pi`, and functions such as `sqrt`, `exp`, `ln`, `sin`, `atan2`, `abs`, `min`, "
          "`max`");
  Key spin = typed(Type::point, "spin", "rad/s", -1e9, 1e9);
  spin.like("[0, 0, 100]")
      .note("none")
      .means(
          "Angular velocity: a rotation about `spin_centre` that is added to the velocity; in planar2d a number, "
          "about z");
  return {std::move(velocity), std::move(spin),
          position("spin_centre").note("centre of the shape").like("[0.1, 0, 0]").means("Point on the axis of `spin`")};
}

namespace {

/// The angular velocity and what it turns about; false after an error.
bool build_spin(Draft const& draft, Section const& section, shape::Shape const& shape, run::InitialMotion& motion) {
  if (!section.given("spin")) {
    if (!section.given("spin_centre")) return true;
    draft.error(section, "spin_centre", "has no effect without spin: remove it, or write, for example, spin = 100");
    return false;
  }
  auto const* spin = section.numbers("spin");
  if (spin == nullptr || section.broken("spin_centre")) return false;
  if (draft.radial() || draft.dims() == 1) {
    draft.error(section, "spin",
                fmt::format("a rotation has no components in {}, which resolves {} only{}: remove the key, or use "
                            "cartesian3d",
                            word_of(draft.geometry()), direction_list(draft.dims()),
                            draft.radial() ? " and no motion around the axis" : ""));
    return false;
  }
  bool const number = draft.dims() == 2 && spin->size() == 1;
  if (!number && spin->size() != 3) {
    draft.error(section, "spin",
                fmt::format("{} has {} element{}; expected {}", section.shown("spin"), spin->size(),
                            spin->size() == 1 ? "" : "s",
                            draft.dims() == 2 ? "a number, about z" : "three, as in [0, 0, 100]"));
    return false;
  }
  if (draft.dims() == 2 && !number && ((*spin)[0] != 0.0 || (*spin)[1] != 0.0)) {
    draft.error(section, "spin",
                fmt::format("{} turns about x or y, but {} resolves {} only: write 0 for both, or a number",
                            section.shown("spin"), word_of(draft.geometry()), direction_list(2)));
    return false;
  }
  motion.spin = number ? Vec3{0.0, 0.0, spin->front()} : Vec3{(*spin)[0], (*spin)[1], (*spin)[2]};
  motion.centre = shape::centre(shape);
  if (!section.given("spin_centre")) return true;
  auto const centre = draft.point(section, "spin_centre");
  if (centre) motion.centre = *centre;
  return centre.has_value();
}

/// Calls visit(x, face) for places all over the part of the shape in the domain, with face -1, and on the axis and the
/// symmetry planes, with the number of the face, until it returns false.
template <class Visit>
void for_places(Draft const& draft, shape::Shape const& shape, Visit visit) {
  grid::Domain const& domain = draft.out.domain;
  shape::CellRange const range = shape::cells_around(shape, domain);
  double const count = static_cast<double>(range.count());
  int const stride = count <= most_places ? 1 : static_cast<int>(std::ceil(std::cbrt(count / most_places)));
  bool goes_on = true;
  auto const look = [&](Vec3 const& x, int face) {
    goes_on = goes_on && (!shape::contains(shape, domain, x) || visit(x, face));
  };
  for (int k = range.lower[2]; goes_on && k < range.upper[2]; k += stride) {
    for (int j = range.lower[1]; goes_on && j < range.upper[1]; j += stride) {
      for (int i = range.lower[0]; goes_on && i < range.upper[0]; i += stride) {
        Index3 const cell{i, j, k};
        Vec3 x = domain.centre(cell);
        for (int d = draft.dims(); d < 3; ++d) x[d] = 0.0;
        look(x, -1);
        for (int f = 0; f < 2 * draft.dims(); ++f) {
          int const d = f / 2;
          bool const beside = cell[d] == (f % 2 == 0 ? 0 : domain.cells[d] - 1);
          if (!beside || domain.boundary[f] != Boundary::symmetry) continue;
          Vec3 on = x;
          on[d] = f % 2 == 0 ? domain.lower[d] : domain.upper(d);
          look(on, f);
        }
      }
    }
  }
}

/// Reports where the velocity is none, or leaves the axis or a symmetry plane.
bool is_sound(Draft const& draft, Section const& section, shape::Shape const& shape, Vec3 const& velocity,
              run::InitialMotion const& motion) {
  std::string_view const key = section.given("velocity") ? "velocity" : "spin";
  setup::VelocityField field(velocity, motion);
  double largest = 0.0;
  double across = 0.0;
  int face = -1;
  Vec3 where{0.0, 0.0, 0.0};
  bool sound = true;
  for_places(draft, shape, [&](Vec3 const& x, int at_face) {
    Vec3 const v = field.unchecked(x);
    double const speed = norm(v);
    if (at_face >= 0 && std::abs(v[at_face / 2]) > across) {
      across = std::abs(v[at_face / 2]);
      face = at_face;
      where = x;
    }
    largest = std::max(largest, speed);
    if (speed <= fastest) return true;
    draft.error(
        section, key,
        fmt::format("{} = {} makes the speed {} at {} m; allowed: up to {:g} m/s everywhere in the shape: change "
                    "it, or cut this place out of the shape",
                    key, section.shown(key),
                    std::isfinite(speed) ? fmt::format("{:.6g} m/s", speed) : std::string("infinite or undefined"),
                    point_text(x, draft.dims()), fastest));
    sound = false;
    return false;
  });
  if (!sound || !(across > round_off * largest)) return sound;
  bool const axis = draft.out.domain.is_axis(face);
  draft.error(section, key,
              fmt::format("{} = {} is {:.6g} m/s along {} at {} m, on {}, where it must vanish{}", key,
                          section.shown(key), across, directions[face / 2], point_text(where, draft.dims()),
                          axis ? std::string("the axis") : fmt::format("the symmetry plane {}", grid::face_names[face]),
                          axis ? ": write, for example, \"100*x\"" : ": change it, or choose another boundary"));
  return false;
}

}  // namespace

bool build_initial_velocity(Draft const& draft, Section const& section, shape::Shape const* shape, Vec3& velocity,
                            run::InitialMotion& motion) {
  if (section.broken("velocity") || section.broken("spin")) return false;
  if (!draft.geometry_known) return true;
  auto const* expressions = section.strings("velocity");
  if (expressions != nullptr) {
    auto const dims = static_cast<std::size_t>(draft.dims());
    bool extra = false;  // beyond the resolved directions 0 may stand
    for (std::size_t d = dims; d < expressions->size(); ++d) extra = extra || (*expressions)[d] != "0";
    if (expressions->size() < dims || extra) {
      draft.error(section, "velocity",
                  fmt::format("{} has {} element{}, but {} resolves {}: give {}", section.shown("velocity"),
                              expressions->size(), expressions->size() == 1 ? "" : "s", word_of(draft.geometry()),
                              direction_list(draft.dims()), dims));
      return false;
    }
    motion.expressions.assign(expressions->begin(), expressions->begin() + static_cast<long>(dims));
    velocity = {0.0, 0.0, 0.0};
  } else if (section.given("velocity")) {
    auto const constant = draft.point(section, "velocity");
    if (!constant) return false;
    velocity = *constant;
  }
  if (shape == nullptr) return !section.given("spin");
  if (!build_spin(draft, section, *shape, motion)) return false;
  return !motion.any() || !draft.domain_known || !draft.boundaries_known ||
         is_sound(draft, section, *shape, velocity, motion);
}

}  // namespace brisance::deck
