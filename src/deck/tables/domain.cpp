/// [domain]: the grid.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "deck/draft.hpp"
#include "deck/keys.hpp"
#include "deck/tables/tables.hpp"

namespace brisance::deck {

Table const& domain_table() {
  static Table const table{
      "The grid: a box of cubic cells.",
      {word<grid::Geometry>("geometry")
           .of(word_of(grid::Domain{}.geometry))
           .like("\"cartesian3d\"")
           .means("Resolved directions and symmetry. In axisymmetric2d, x is the radius and y the axis; in "
                  "cylindrical1d and spherical1d, x is the radius"),
       number("cell", "m", smallest, 1e4).required().like("\"50 mm\"").means("Edge length h of the cubic cells"),
       position("lower").note("the origin").like("[0, 0, 0]").means("Low corner"),
       position("upper").note("from `size`").like("[4, 4, 3]").means("High corner; `upper` or `size` is required"),
       typed(Type::point, "size", "m", smallest, 2.0 * far)
           .note("from `upper`")
           .like("[4, 4, 3]")
           .means("Extent, a whole number of cells in each direction; `upper` or `size` is required")},
      {},
      {}};
  return table;
}

namespace {

constexpr double most_cells = 2147483648.0;  ///< 2^31
constexpr double fewest_cells = 4.0;         ///< per direction: the stencil of the schemes
constexpr double cell_tolerance = 1e-6;      ///< relative, of an extent to a whole number of cells

/// The number of cells along a direction; none where the extent is not a whole number of them, which is reported. The
/// whole of the domain tells whether there are too many.
std::optional<double> whole_cells(Draft const& draft, Section const& section, std::string_view key, int d,
                                  double extent) {
  double const h = draft.out.domain.h;
  if (extent <= 0.0) {
    draft.error(section, key,
                fmt::format("{} gives no positive extent in direction {} ({:g} m): the extent must be positive",
                            section.shown(key), directions[d], extent));
    return std::nullopt;
  }
  double const cells = extent / h;
  double const whole = std::max(1.0, std::round(cells));
  if (whole > most_cells) return whole;
  if (std::abs(cells - whole) > cell_tolerance * cells) {
    double const below = std::floor(cells);
    std::string const nearest_extents =
        below >= 1.0 ? fmt::format("{:.9g} or {:.9g} m", below * h, (below + 1.0) * h) : fmt::format("{:.9g} m", h);
    draft.error(section, key,
                fmt::format("{} is not a whole number of cells: {:.9g} m in direction {} are {:.6g} cells of {:.9g} m; "
                            "make the extent {}, or change the cell size",
                            section.shown(key), extent, directions[d], cells, h, nearest_extents));
    return std::nullopt;
  }
  if (whole < fewest_cells) {
    draft.error(
        section, key,
        fmt::format("{} gives {:g} cell{} in direction {}; allowed: at least {:g}: make the extent {:.9g} m or more, "
                    "or reduce the cell size",
                    section.shown(key), whole, whole > 1.0 ? "s" : "", directions[d], fewest_cells, fewest_cells * h));
    return std::nullopt;
  }
  return whole;
}

}  // namespace

void build_domain(Draft& draft) {
  Section const* section = draft.deck.section("domain");
  if (section == nullptr) return;
  auto const word = section->text("geometry");
  if (!word) return;
  draft.out.domain.geometry = *value_of<Geometry>(*word);
  draft.geometry_known = true;
  if (section->doubtful()) return;

  auto const h = section->number("cell");
  if (h) draft.out.domain.h = *h;
  std::optional<Vec3> lower = Vec3{0.0, 0.0, 0.0};
  if (section->given("lower")) lower = draft.point(*section, "lower");
  auto const upper = draft.point(*section, "upper");
  auto const size = draft.point(*section, "size");
  if (!section->given("upper") && !section->given("size")) {
    draft.report.error(
        section->place, "domain.size",
        "the extent of the domain is missing; write, for example, size = [4, 4, 3] (or upper = ...), in m");
    return;
  }
  if (lower && draft.radial() && (*lower)[0] < 0.0) {
    draft.error(*section, "lower",
                fmt::format("{} starts at a negative radius; in {}, x is the radius: write 0 or more",
                            section->shown("lower"), word_of(draft.geometry())));
    return;
  }
  if (!h || !lower || (section->given("upper") && !upper) || (section->given("size") && !size)) return;
  draft.out.domain.lower = *lower;

  std::string_view const key = upper ? "upper" : "size";
  bool sound = true;
  double count = 1.0;
  for (int d = 0; d < draft.dims(); ++d) {
    double const extent = upper ? (*upper)[d] - (*lower)[d] : (*size)[d];
    if (upper && size && std::abs(extent - (*size)[d]) > cell_tolerance * std::abs(extent)) {
      draft.error(*section, "size",
                  fmt::format("{0} disagrees with lower and upper, which are {2:g} m apart in direction {1}: give only "
                              "one of size and upper",
                              section->shown("size"), directions[d], extent));
      return;
    }
    auto const whole = whole_cells(draft, *section, key, d, extent);
    sound = sound && whole;
    if (!whole) continue;
    count *= *whole;
    if (*whole <= most_cells) draft.out.domain.cells[d] = static_cast<int>(*whole);
  }
  if (!sound) return;
  double const coarser = *h * std::pow(count / most_cells, 1.0 / draft.dims());
  if (count >= most_cells) {
    draft.error(*section, "cell",
                fmt::format("{} gives {:.4g} cells; allowed: fewer than 2^31 ({:.4g}); choose a cell size above {:.3g} "
                            "m or a smaller domain",
                            section->shown("cell"), count, most_cells, coarser));
    return;
  }
  draft.domain_known = true;
}

}  // namespace brisance::deck
