/// Soil: Drucker-Prager over one step, [Cui14] Eqs. (59)-(63). Dilation and tension change the pressure beside the
/// volume, so that the pressure is a state: dp = K d(rho/rho0) and the return, which without yielding is the linear
/// equation of state exactly.
#include <cmath>
#include <numbers>

#include "material/stress_stages.hpp"

namespace brisance::material {

void update_soil(Material const& solid, DruckerPrager const& model, ParticleArrays const& a, StepData const& step,
                 Scratch& t) {
  auto const& eos = std::get<Linear>(solid.eos);
  trial_deviator(a, model.G, t);
  int const n = a.n;
  alignas(64) double p1[chunk];
  alignas(64) double modulus[chunk];
  DruckerPrager::Cone const cone = model.cone(eos.K);
  double const* const density = a.density;
  double const* const pressure = a.pressure;
  double const* const volumetric = a.volumetric;
  double const* const trial_work = t.trial_work;
  double* const mises = t.mises;
  double* const increment = t.increment;
  double* const scale = t.scale;
  double* const work = t.work;
  double const per_rho0 = 1.0 / eos.rho0;
  double const per_three_G = 1.0 / (3.0 * model.G);
  double const minimum = solid.minimum_pressure;
  BRISANCE_VECTOR_LOOP
  for (int k = 0; k < n; ++k) {
    double const rho = density[k] * per_rho0;
    double const rho1 = rho / volume_ratio(volumetric[k]);
    double const trial = mises[k];
    auto const end = cone.returned(trial * std::numbers::inv_sqrt3, -pressure[k] - eos.K * (rho1 - rho));
    double const left = end.tau * std::numbers::sqrt3;
    double const kept = left < trial ? left : trial;
    double const p = -end.mean > minimum ? -end.mean : minimum;
    p1[k] = p;
    modulus[k] = eos.K * rho1;
    increment[k] = (trial - kept) * per_three_G;
    scale[k] = kept / (trial > 0.0 ? trial : 1.0);
    mises[k] = kept;
    work[k] += scale[k] * trial_work[k];
  }
  scale_deviator(a, t);
  plastic_flow(a, solid.specific_heat, solid.taylor_quinney, t);
  fill(t.widest, n, 1.0 / solid.density);
  finish(ColdPressure{p1, modulus}, a, step, model.G, t);
}

}  // namespace brisance::material
