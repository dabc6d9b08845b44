#include "empirical/kingery_bulmash.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.hpp"

namespace brisance::empirical {

namespace {

/// One piece of a curve: log10 y = sum of c_i U^i with U = k0 + k1 log10 Z, for lowest <= Z <= highest. y is in kPa,
/// kPa ms/kg^(1/3), ms/kg^(1/3) or m/ms, as printed.
struct Piece {
  Burst burst;
  std::optional<double> Blast::*value;
  double lowest;
  double highest;
  double k0;
  double k1;
  std::array<double, 15> c;
};

// The pieces of one curve follow each other with growing Z.
constexpr Piece pieces[] = {
    {Burst::spherical,
     &Blast::incident_overpressure,
     0.0531,
     40,
     -0.214362789151,
     1.35034249993,
     {2.611368669, -1.69012801396, 0.00804973591951, 0.336743114941, -0.00516226351334, -0.0809228619888,
      -0.00478507266747, 0.00793030472242, 0.0007684469735}},
    {Burst::spherical,
     &Blast::reflected_overpressure,
     0.0531,
     40,
     -0.214362789151,
     1.35034249993,
     {3.22958031387, -2.21400538997, 0.035119031446, 0.657599992109, 0.0141818951887, -0.243076636231, -0.0158699803158,
      0.0492741184234, 0.00227639644004, -0.00397126276058}},
    {Burst::spherical,
     &Blast::incident_impulse,
     0.0531,
     0.792,
     2.34723921354,
     3.24299066475,
     {2.38830516757, -0.443749377691, 0.168825414684, 0.0348138030308, -0.010435192824}},
    {Burst::spherical,
     &Blast::incident_impulse,
     0.792,
     40,
     -1.75305660315,
     2.30629231803,
     {1.55197227115, -0.40463292088, -0.0142721946082, 0.00912366316617, -0.0006750681404, -0.00800863718901,
      0.00314819515931, 0.00152044783382, -0.0007470265899}},
    {Burst::spherical,
     &Blast::reflected_impulse,
     0.0531,
     40,
     -0.204004553231,
     1.37882996018,
     {2.55875660396, -0.903118886091, 0.101771877942, -0.0242139751146}},
    {Burst::spherical,
     &Blast::arrival,
     0.0531,
     40,
     -0.253273111999,
     1.37407043777,
     {0.0720707787637, 1.36456871214, -0.0570035692784, -0.182832224796, 0.0118851436014, 0.0432648687627,
      -0.0007997367834, -0.00436073555033}},
    {Burst::spherical,
     &Blast::duration,
     0.147,
     0.888,
     2.26367268496,
     5.11588554305,
     {-0.686608550419, 0.164953518069, 0.127788499497, 0.00291430135946, 0.00187957449227, 0.0173413962543,
      0.00269739758043, -0.00361976502798, -0.00100926577934}},
    {Burst::spherical,
     &Blast::duration,
     0.888,
     2.28,
     -1.33361206714,
     9.2996288611,
     {0.23031841078, -0.0297944268969, 0.0306329542941, 0.0183405574074, -0.0173964666286, -0.00106321963576,
      0.0056206003128, 0.0001618217499, -0.0006860188944}},
    {Burst::spherical,
     &Blast::duration,
     2.28,
     40,
     -3.13005805346,
     3.1524725364,
     {0.621036276475, 0.0967031995552, -0.00801302059667, 0.00482705779732, 0.00187587272287, -0.00246738509321,
      -0.000841116668, 0.0006193291052}},
    {Burst::spherical,
     &Blast::shock_speed,
     0.0531,
     40,
     -0.214362789151,
     1.35034249993,
     {-0.144615443471, -0.650507560471, 0.291320654009, 0.307916322787, -0.183361123489, -0.197740454538,
      0.0909119559768, 0.0898926178054, -0.0287370990248, -0.0248730221702, 0.00496311705671, 0.00372242076361,
      -0.0003533736952, -0.0002292913709}},
    {Burst::hemispherical,
     &Blast::incident_overpressure,
     0.0674,
     40,
     -0.214362789151,
     1.35034249993,
     {2.78076916577, -1.6958988741, -0.154159376846, 0.514060730593, 0.0988534365274, -0.293912623038, -0.0268112345019,
      0.109097496421, 0.00162846756311, -0.0214631030242, 0.0001456723382, 0.00167847752266}},
    {Burst::hemispherical,
     &Blast::reflected_overpressure,
     0.0674,
     40,
     -0.240657322658,
     1.36637719229,
     {3.40283217581, -2.21030870597, -0.218536586295, 0.895319589372, 0.24989009775, -0.569249436807, -0.11791682383,
      0.224131161411, 0.0245620259375, -0.0455116002694, -0.00190930738887, 0.00361471193389}},
    {Burst::hemispherical,
     &Blast::incident_impulse,
     0.0674,
     0.955,
     2.06761908721,
     3.0760329666,
     {2.52455620925, -0.502992763686, 0.171335645235, 0.0450176963051, -0.0118964626402}},
    {Burst::hemispherical,
     &Blast::incident_impulse,
     0.955,
     40,
     -1.94708846747,
     2.40697745406,
     {1.67281645863, -0.384519026965, -0.0260816706301, 0.00595798753822, 0.014544526107, -0.00663289334734,
      -0.00284189327204, 0.0013644816227}},
    {Burst::hemispherical,
     &Blast::reflected_impulse,
     0.0674,
     40,
     -0.246208804814,
     1.33422049854,
     {2.70588058103, -0.949516092853, 0.112136118689, -0.0250659183287}},
    {Burst::hemispherical,
     &Blast::arrival,
     0.0674,
     40,
     -0.202425716178,
     1.37784223635,
     {-0.0591634288046, 1.35706496258, 0.052492798645, -0.196563954086, -0.0601770052288, 0.0696360270891,
      0.0215297490092, -0.0161658930785, -0.00232531970294, 0.00147752067524}},
    {Burst::hemispherical,
     &Blast::duration,
     0.178,
     1.01,
     1.92946154068,
     5.25099193925,
     {-0.614227603559, 0.130143717675, 0.134872511954, 0.0391574276906, -0.00475933664702, -0.00428144598008}},
    {Burst::hemispherical,
     &Blast::duration,
     1.01,
     2.78,
     -2.12492525216,
     9.2996288611,
     {0.315409245784, -0.0297944268976, 0.030632954288, 0.0183405574086, -0.0173964666211, -0.00106321963633,
      0.00562060030977, 0.0001618217499, -0.0006860188944}},
    {Burst::hemispherical,
     &Blast::duration,
     2.78,
     40,
     -3.53626218091,
     3.46349745571,
     {0.686906642409, 0.0933035304009, -0.0005849420883, -0.00226884995013, -0.00295908591505, 0.00148029868929}},
    {Burst::hemispherical,
     &Blast::shock_speed,
     0.0674,
     40,
     -0.202425716178,
     1.37784223635,
     {-0.06621072854, -0.698029762594, 0.158916781906, 0.443812098136, -0.113402023921, -0.369887075049, 0.129230567449,
      0.19857981197, -0.0867636217397, -0.0620391900135, 0.0307482926566, 0.0102657234407, -0.00546533250772,
      -0.000693180974, 0.0003847494916}},
};

double evaluate(Piece const& piece, double z) {
  double const u = piece.k0 + piece.k1 * std::log10(z);
  double sum = 0.0;
  for (auto c = piece.c.rbegin(); c != piece.c.rend(); ++c) sum = sum * u + *c;
  return std::pow(10.0, sum);
}

/// Value of a curve as printed, at scaled distance z.
std::optional<double> curve(std::optional<double> Blast::*value, Burst burst, double z) {
  for (Piece const& piece : pieces) {
    if (piece.value == value && piece.burst == burst && z >= piece.lowest && z <= piece.highest)
      return evaluate(piece, z);
  }
  return std::nullopt;
}

/// Peak dynamic pressure behind a shock of overpressure ps in air at pa, gamma = 1.4: q = 5 ps^2 / (2 (7 pa + ps)).
std::optional<double> dynamic_pressure(std::optional<double> ps, double pa) {
  if (!ps || *ps > strongest_ideal_shock * pa) return std::nullopt;
  return 2.5 * *ps * *ps / (7.0 * pa + *ps);
}

void require_positive(double value, char const* what) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw InputError(std::string("Kingery-Bulmash: the ") + what + " must be positive and finite");
  }
}

}  // namespace

Range validity(Field const& field, Burst burst) {
  auto const value = field.value == &Blast::dynamic_pressure ? &Blast::incident_overpressure : field.value;
  Range range{std::numeric_limits<double>::infinity(), 0.0};
  for (Piece const& piece : pieces) {
    if (piece.value != value || piece.burst != burst) continue;
    range.lowest = std::min(range.lowest, piece.lowest);
    range.highest = std::max(range.highest, piece.highest);
  }
  if (field.value != &Blast::dynamic_pressure) return range;
  // The overpressure falls with the distance.
  auto const holds = [burst](double z) { return kingery_bulmash(1.0, z, burst).dynamic_pressure.has_value(); };
  double above = range.lowest;
  double at = range.highest;
  while (!holds(above)) {
    double const middle = 0.5 * (above + at);
    if (middle == above || middle == at) break;
    (holds(middle) ? at : above) = middle;
  }
  range.lowest = at;
  return range;
}

std::optional<double> other_incident_impulse(double z, Burst burst) {
  constexpr double difference = -0.002;  // of the coefficient of U^2
  for (Piece const& piece : pieces) {
    if (piece.value != &Blast::incident_impulse || piece.burst != burst || burst != Burst::hemispherical) continue;
    if (piece.lowest < 0.9 || z < piece.lowest || z > piece.highest) continue;
    double const u = piece.k0 + piece.k1 * std::log10(z);
    return std::pow(10.0, difference * u * u);
  }
  return std::nullopt;
}

Blast kingery_bulmash(double tnt_mass, double distance, Burst burst, Atmosphere const& atmosphere) {
  require_positive(tnt_mass, "mass of the charge");
  require_positive(distance, "distance");
  require_positive(atmosphere.pressure, "ambient pressure");
  require_positive(atmosphere.sound_speed, "ambient sound speed");

  // Sachs scaling [Sachs44]: overpressure / p_a, speed / c_a and time c_a / L depend on distance / L alone, L = (energy
  // / p_a)^(1/3).
  constexpr Atmosphere standard;
  double const pressure_ratio = atmosphere.pressure / standard.pressure;
  double const speed_ratio = atmosphere.sound_speed / standard.sound_speed;
  double const length_ratio = std::cbrt(tnt_mass / pressure_ratio);  // L over that of 1 kg in the standard atmosphere
  double const time_ratio = length_ratio / speed_ratio;

  Blast blast;
  blast.scaled_distance = distance / length_ratio;
  for (Field const& field : blast_fields) {
    auto const printed = curve(field.value, burst, blast.scaled_distance);
    if (!printed) continue;
    switch (field.scaling) {
      case Scaling::pressure: blast.*field.value = *printed * 1e3 * pressure_ratio; break;
      case Scaling::impulse: blast.*field.value = *printed * pressure_ratio * time_ratio; break;
      case Scaling::time: blast.*field.value = *printed * 1e-3 * time_ratio; break;
      case Scaling::speed: blast.*field.value = *printed * 1e3 * speed_ratio; break;
    }
  }
  blast.dynamic_pressure = dynamic_pressure(blast.incident_overpressure, atmosphere.pressure);
  return blast;
}

}  // namespace brisance::empirical
