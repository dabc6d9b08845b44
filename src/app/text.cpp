#include "app/text.hpp"

#include <fmt/format.h>

namespace brisance::app {

std::string panel_in_words(run::PanelReport const& p, grid::Domain const& domain) {
  char const* const unit =
      domain.geometry == grid::Geometry::planar2d || domain.geometry == grid::Geometry::cylindrical1d ? "m2 per m"
                                                                                                      : "m2";
  std::string const area =
      domain.geometry == grid::Geometry::planar1d ? "" : fmt::format(" of {:.4g} {}", p.place.area, unit);
  if (!p.released) {
    return fmt::format("intact; the pressure difference reached {} of {}", quantity(p.largest, "Pa", 3),
                       quantity(p.release.pressure, "Pa", 3));
  }
  std::string text = fmt::format("failed at {} with a pressure difference of {}", quantity(*p.released, "s"),
                                 quantity(p.difference, "Pa"));
  if (!(p.release.areal_mass > 0.0)) return text + fmt::format("; the whole area{} opened at once", area);
  std::string const moved = fmt::format("travel {}, speed {}", quantity(p.travel, "m", 3), quantity(p.speed, "m/s", 3));
  if (p.opened)
    return text + fmt::format("; the whole area{} was open at {}, {}", area, quantity(*p.opened, "s"), moved);
  return text + fmt::format("; {:.3g}{} is open, {}", p.open_area(), area, moved);
}

std::string verdict_word(run::Verdict const& verdict) {
  if (!verdict.balanced) return "NOT BALANCED";
  return verdict.drift_judged ? "balanced" : "energy drift not checked, because [audit] warn = 0";
}

std::string verdict_reasons(run::Verdict const& verdict, bool for_comparison) {
  std::string text;
  for (std::string const& reason : verdict.reasons) text += "NOT BALANCED: " + reason + "\n";
  if (!verdict.balanced && for_comparison) {
    text += "scheme = \"lax-wendroff\" and transport = \"paper\" are meant for comparison, so the run is not stopped\n";
  }
  return text;
}

}  // namespace brisance::app
