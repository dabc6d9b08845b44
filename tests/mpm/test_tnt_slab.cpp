// A slab of TNT lit over one face: the detonation runs through its particles as a plane wave.
#include "material/chapman_jouguet.hpp"
#include "mpm/explosives.hpp"

namespace brisance::test {
namespace {

/// The slab stands on a mirror plane; behind it is empty space.
struct Slab : Problem {
  static constexpr double thickness = 0.1;
  static constexpr std::array stations{0.040, 0.070, 0.0975};
  double const cj = material::chapman_jouguet(material::Jwl{}, 6.993e9).pressure;
  std::array<double, 3> arrivals{};  ///< when half of the peak is passed, relative to x / D
  std::array<double, 3> peaks{};     ///< relative to `cj`
  double highest = 0.0;              ///< pressure of any point at any time, relative to `cj`
  double drift = 0.0;                ///< of the energy, relative: the largest until the front leaves the slab
  double late = 0.0;                 ///< the same at the end

  Slab(ShapeFunction shape, double spacing) {
    double const h = 2.0 * spacing;
    box(grid::Geometry::planar1d, h, {static_cast<int>(std::lround(1.2 * thickness / h)), 1, 1},
        grid::Boundary::outflow);
    domain.boundary[0] = grid::Boundary::symmetry;
    options = mpm::Options{};
    options.shape = shape;
    add(tnt());
    start();
    fill(0, shape::Box{{0.0, -1.0, -1.0}, {thickness, 1.0, 1.0}});
    mpm::set_lighting(*mpm, 0, [](Vec3 const& x) { return x[0] / detonation_speed; });
    watch(spacing);
  }

 private:
  struct Station {
    long identity = 0;
    mpm::Place place;
    std::vector<std::array<double, 2>> history;  ///< time, pressure
  };

  void watch(double spacing) {
    std::array<Station, 3> watched;
    for (int k = 0; k < 3; ++k) watched[k].identity = mpm::nearest(*mpm, 0, {stations[k] - 0.25 * spacing, 0.0, 0.0});
    EnergyWatch energy(*this);
    double const end = thickness / detonation_speed + 1e-6;
    for (long step = 0; mpm->time() < end; ++step) {
      mpm->advance(std::min(mpm->stable_step(), 1e-7));
      for (auto& station : watched) {
        station.place = mpm::find(*mpm, 0, station.identity, station.place);
        if (station.place.block < 0) continue;
        double const p = mpm->particles(station.place.block, 0).field(Field::pressure)[station.place.index];
        station.history.push_back({mpm->time(), p});
      }
      if (step % 10 == 0) {
        for_each_particle(0, [&](mpm::ParticleSet const& set, int q) {
          highest = std::max(highest, set.field(Field::pressure)[q] / cj);
        });
        energy.look();
        if (mpm->time() < thickness / detonation_speed) drift = std::max(drift, std::abs(energy.drift));
      }
    }
    late = energy.drift;
    for (int k = 0; k < 3; ++k) {
      auto const& history = watched[k].history;
      double peak = 0.0;
      for (auto const& record : history) peak = std::max(peak, record[1]);
      peaks[k] = peak / cj;
      for (std::size_t n = 1; n < history.size(); ++n) {
        auto const& a = history[n - 1];
        auto const& b = history[n];
        if (b[1] < 0.5 * peak) continue;
        double const arrival = a[0] + (b[0] - a[0]) * (0.5 * peak - a[1]) / (b[1] - a[1]);
        arrivals[k] = arrival * detonation_speed / stations[k];
        break;
      }
    }
  }
};

TEST(TntSlabOfParticles, RunsAtTheDetonationSpeedWithItsChapmanJouguetPressure) {
  // 4000 particles. A peer code loses 16.8 % of the energy and shows a false peak of 37.6 GPa.
  Slab const slab(ShapeFunction::bspline, 0.025e-3);
  EXPECT_EQ(mpm::particle_count(*slab.mpm), 4000);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(slab.arrivals[k], 1.0, 0.005) << Slab::stations[k];
    EXPECT_NEAR(slab.peaks[k], 1.0, 0.05) << Slab::stations[k];
  }
  // No particle ever sees more than the Chapman-Jouguet pressure; the tip of the wave stays below it.
  EXPECT_LT(slab.highest, 1.0);
  EXPECT_GT(slab.highest, 0.95);
  EXPECT_LT(slab.drift, 0.01);
  EXPECT_LT(std::abs(slab.late), 0.01);
  EXPECT_EQ(slab.mpm->accounts().losses.particles, 0);
}

TEST(TntSlabOfParticles, PeakApproachesTheChapmanJouguetPressureWithTheCellSize) {
  double last = 1.0;
  for (double spacing : {0.4e-3, 0.2e-3, 0.1e-3}) {
    Slab const slab(ShapeFunction::bspline, spacing);
    double const deviation = std::abs(slab.peaks[1] - 1.0);
    EXPECT_LT(deviation, last) << spacing;
    last = deviation;
  }
  EXPECT_LT(last, 0.08);  // measured 0.059
}

TEST(TntSlabOfParticles, ParticlesThatStretchKeepTheEnergyBest) {
  Slab const slab(ShapeFunction::cpgimp, 0.1e-3);
  EXPECT_LT(slab.drift, 2e-3);  // measured 0.0008
  EXPECT_LT(slab.highest, 1.05);
  for (double arrival : slab.arrivals) EXPECT_NEAR(arrival, 1.0, 0.005);
}

}  // namespace
}  // namespace brisance::test
