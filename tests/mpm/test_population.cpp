// Splitting and merging of gas particles: what is conserved, what is bounded, and what it does to a gas that expands or
// is compressed.
#include <cstring>
#include <map>
#include <random>

#include "core/error.hpp"
#include "mpm/harness.hpp"
#include "mpm/workspace.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using mpm::ParticleSet;
using mpm::PopulationCount;
using mpm::PopulationOptions;

material::Material gas(double rho, double p, double gamma = 1.4) {
  material::Fluid fluid;
  fluid.name = "gas";
  fluid.eos = material::IdealGas{gamma};
  fluid.density = rho;
  fluid.pressure = p;
  return material::of(fluid);
}

/// Sums over particles that splitting and merging keep, each with the sum of the magnitudes of its terms for the
/// round-off.
struct Sums {
  std::map<std::string, std::pair<double, double>> values;
  void add(std::string const& name, double value) {
    values[name].first += value;
    values[name].second += std::abs(value);
  }
  void add(ParticleSet const& set) {
    for (int q = 0; q < set.size(); ++q) {
      auto const at = [&](Field f) { return set.field(f)[q]; };
      double const m = at(Field::mass);
      double const v = m / at(Field::density);
      Vec3 const u = Problem::get(set, q, Field::velocity_x);
      Vec3 const x = Problem::get(set, q, Field::position_x);
      add("mass", m);
      add("volume", v);
      add("energy", m * (0.5 * dot(u, u) + at(Field::energy)));
      add("kinetic energy", 0.5 * m * dot(u, u));
      add("volume times pressure", v * at(Field::pressure));
      add("volume times viscosity", v * at(Field::viscosity));
      for (int d = 0; d < 3; ++d) {
        add("momentum " + std::to_string(d), m * u[d]);
        add("centre " + std::to_string(d), m * x[d]);
        int const e = (d + 1) % 3;
        add("angular momentum " + std::to_string(d), m * (x[d] * u[e] - x[e] * u[d]));
      }
      if (set.field(Field::mass_fraction) != nullptr) {
        add("mass of the second fluid", m * at(Field::mass_fraction));
        add("volume of the second fluid", v * at(Field::volume_fraction));
      }
      if (set.field(Field::half_x) != nullptr) add("boxes", at(Field::half_x) * at(Field::half_y) * at(Field::half_z));
    }
  }
};

/// 1e-13 of the magnitudes: sums of up to 1e5 terms in another order lose their square root times 1e-16, and each merge
/// rounds a few times.
void expect_same(Sums const& now, Sums const& before, std::vector<std::string> const& but = {}) {
  for (auto const& [name, value] : before.values) {
    if (std::find(but.begin(), but.end(), name) != but.end()) continue;
    auto const& [sum, magnitude] = now.values.at(name);
    EXPECT_NEAR(sum, value.first, 1e-13 * std::max(magnitude, value.second)) << name;
  }
}

/// A set in a single block of 4^D cells, with every field that a gas may have.
struct Synthetic {
  Synthetic(Geometry geometry, bool affine, bool sized) {
    domain.geometry = geometry;
    domain.h = 0.25;
    domain.boundary.fill(Boundary::wall);
    for (int d = 0; d < domain.dimensions(); ++d) domain.cells[d] = 4;
    grid = std::make_unique<grid::Grid>(domain, 4);
    patches = mpm::make_patches(*grid, 1);
    mpm::FieldList fields;
    fields.add(Field::position_x, 3);
    fields.add(Field::velocity_x, 3);
    fields.add(Field::move_x, 3);
    for (Field const f : {Field::mass, Field::density, Field::pressure, Field::viscosity, Field::energy,
                          Field::identity, Field::mass_fraction, Field::volume_fraction}) {
      fields.add(f);
    }
    if (affine) fields.add(Field::affine_xx, 9);
    if (sized) fields.add(Field::half_x, 3);
    set = ParticleSet(fields);
    out.particles = ParticleSet(fields);
  }

  int add(Vec3 const& x, double volume, double rho = 1.0, double p = 1.0) {
    int const q = set.append();
    for (int d = 0; d < 3; ++d) {
      set.field(Field::position_x + d)[q] = d < domain.dimensions() ? x[d] : 0.0;
      if (double* half = set.field(Field::half_x + d)) half[q] = 0.5 * std::cbrt(volume);
    }
    set.field(Field::mass)[q] = rho * volume;
    set.field(Field::density)[q] = rho;
    set.field(Field::pressure)[q] = p;
    set.field(Field::energy)[q] = p / (0.4 * rho);
    set.field(Field::identity)[q] = q;
    return q;
  }

  PopulationCount control(PopulationOptions const& options = {}) {
    mpm::PopulationPlace const place{grid.get(), 0, patches.data(), 2};
    PopulationCount count = mpm::split_particles(set, place, options, scratch, out);
    EXPECT_TRUE(out.destination.empty());
    PopulationCount const merged = mpm::merge_particles(set, place, options, scratch);
    count.merged = merged.merged;
    count.heat += merged.heat;
    return count;
  }

  [[nodiscard]] double standard(int q) const {
    return mpm::standard_volume(domain, 2, set.field(Field::position_x)[q]);
  }
  [[nodiscard]] int cell(int q) const {
    int c = 0;
    for (int d = domain.dimensions() - 1; d >= 0; --d) {
      c = 4 * c + static_cast<int>(set.field(Field::position_x + d)[q] / domain.h);
    }
    return c;
  }
  [[nodiscard]] Sums sums() const {
    Sums s;
    s.add(set);
    return s;
  }

  grid::Domain domain;
  std::unique_ptr<grid::Grid> grid;
  std::vector<mpm::Patch> patches;
  ParticleSet set;
  mpm::Outbox out;
  mpm::PopulationScratch scratch;
};

/// Volumes and places change at random; together the particles keep filling the domain.
void stir(Synthetic& s, std::mt19937_64& random, bool mixed, bool fills) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int q = 0; q < s.set.size(); ++q) {
    // The gas expands and is compressed by up to a quarter at a time.
    s.set.field(Field::density)[q] *= std::exp(0.5 * (unit(random) - 0.5));
    for (int d = 0; d < s.domain.dimensions(); ++d) {
      double& x = s.set.field(Field::position_x + d)[q];
      x = std::abs(x + 0.1 * (unit(random) - 0.5));
      if (x >= 1.0) x = 1.999999 - x;
      s.set.field(Field::velocity_x + d)[q] = 0.2 * (unit(random) - 0.5);
    }
    s.set.field(Field::viscosity)[q] = 0.1 * unit(random);
    if (mixed) s.set.field(Field::volume_fraction)[q] = unit(random);
    if (mixed) s.set.field(Field::mass_fraction)[q] = unit(random);
    s.set.field(Field::pressure)[q] = 0.8 + 0.4 * unit(random);
    if (s.set.field(Field::affine_xx) == nullptr) continue;
    for (int c = 0; c < 9; ++c) s.set.field(Field::affine_xx + c)[q] = unit(random) - 0.5;
  }
  if (!fills) return;
  double volume = 0.0;
  for (int q = 0; q < s.set.size(); ++q) volume += Problem::volume(s.set, q);
  double whole = 0.0;
  for (int i = 0; i < 4; ++i) whole += s.domain.cell_volume(i) * std::pow(4.0, s.domain.dimensions() - 1);
  for (int q = 0; q < s.set.size(); ++q) s.set.field(Field::density)[q] *= volume / whole;
}

class RandomParticles : public testing::TestWithParam<std::tuple<Geometry, bool, bool>> {};

INSTANTIATE_TEST_SUITE_P(All, RandomParticles,
                         testing::Combine(testing::Values(Geometry::planar1d, Geometry::spherical1d,
                                                          Geometry::axisymmetric2d, Geometry::cartesian3d),
                                          testing::Bool(), testing::Bool()),
                         [](auto const& one) {
                           return std::string(word_of(std::get<0>(one.param))) +
                                  (std::get<1>(one.param) ? "_apic" : "") + (std::get<2>(one.param) ? "_mixed" : "");
                         });

TEST_P(RandomParticles, KeepTheirSumsAndTheirBounds) {
  auto const [geometry, affine, mixed] = GetParam();
  Synthetic s(geometry, affine, geometry == Geometry::cartesian3d);
  int const dims = s.domain.dimensions();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int const start = 40 * dims * dims;
  for (int n = 0; n < start; ++n) s.add({unit(random), unit(random), unit(random)}, 1.0 / start);
  PopulationOptions const options;
  int const most = 4 * (1 << dims);
  long split = 0;
  long merged = 0;
  long light = 0;
  for (int step = 0; step < 1000; ++step) {
    stir(s, random, mixed, true);
    Sums const before = s.sums();
    PopulationCount const count = s.control(options);
    split += count.split;
    merged += count.merged;
    Sums const now = s.sums();
    // Merging loses the angular momentum of the relative motion; that of splitting is in a test of its own.
    std::vector<std::string> but{"angular momentum 0", "angular momentum 1", "angular momentum 2", "kinetic energy"};
    expect_same(now, before, but);
    EXPECT_NEAR(before.values.at("kinetic energy").first - now.values.at("kinetic energy").first, count.heat,
                1e-13 * before.values.at("energy").second);
    std::map<int, std::vector<int>> cells;
    for (int q = 0; q < s.set.size(); ++q) cells[s.cell(q)].push_back(q);
    for (auto const& [cell, members] : cells) {
      ASSERT_LE(members.size(), static_cast<std::size_t>(std::max(2 * most, 10)));
      double heaviest = 0.0;
      for (int const q : members) heaviest = std::max(heaviest, s.set.field(Field::mass)[q]);
      for (int const q : members) {
        double const m = s.set.field(Field::mass)[q];
        double const v = m / s.set.field(Field::density)[q];
        if (m * options.mass_ratio >= heaviest || v >= options.small_volume * s.standard(q)) continue;
        ++light;
        for (int const other : members) {  // then nobody is like it
          if (other == q) continue;
          auto const ratio = [&](Field f) {
            double const r = s.set.field(f)[q] / s.set.field(f)[other];
            return std::max(r, 1.0 / r);
          };
          double const difference =
              std::abs(s.set.field(Field::volume_fraction)[q] - s.set.field(Field::volume_fraction)[other]);
          Vec3 const u = Problem::get(s.set, q, Field::velocity_x) - Problem::get(s.set, other, Field::velocity_x);
          double const reference = (s.set.field(Field::pressure)[q] + s.set.field(Field::pressure)[other]) /
                                   (s.set.field(Field::density)[q] + s.set.field(Field::density)[other]);
          ASSERT_TRUE(ratio(Field::pressure) > options.pressure_ratio ||
                      ratio(Field::density) > options.density_ratio || difference > options.composition ||
                      dot(u, u) > options.speed * options.speed * reference);
        }
      }
    }
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(split, 50);
  EXPECT_GT(merged, 50);
  std::printf("split %ld, merged %ld, light points that stay %.2g per step, %d points at the end\n", split, merged,
              1e-3 * static_cast<double>(light), s.set.size());
}

TEST(Splitting, KeepsEverySumAndBoundsTheVolume) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::planar2d, Geometry::cartesian3d}) {
    for (bool const affine : {false, true}) {
      Synthetic s(geometry, affine, false);
      int const dims = s.domain.dimensions();
      std::mt19937_64 random(3);
      std::uniform_real_distribution<double> unit(0.0, 1.0);
      for (int n = 0; n < 60; ++n) {
        s.add({unit(random), unit(random), unit(random)}, std::pow(0.125, dims) * (0.5 + 30.0 * unit(random)));
      }
      stir(s, random, true, false);
      Sums const before = s.sums();
      mpm::PopulationPlace const place{s.grid.get(), 0, s.patches.data(), 2};
      mpm::PopulationOptions options;
      options.crowd = 1e6;  // these particles overlap; no cell shall count as crowded
      auto const count = mpm::split_particles(s.set, place, options, s.scratch, s.out);
      EXPECT_GT(count.split, 100);
      EXPECT_EQ(s.set.size(), 60 + count.split);
      for (int q = 0; q < s.set.size(); ++q) EXPECT_LE(Problem::volume(s.set, q), 2.0 * s.standard(q));
      std::vector<std::string> but;
      if (affine) but = {"kinetic energy", "angular momentum 0", "angular momentum 1", "angular momentum 2"};
      expect_same(s.sums(), before, but);
      EXPECT_EQ(count.heat == 0.0, !affine);
    }
  }
}

TEST(Splitting, LeavesACrowdedCellAlone) {
  // More volume than the cell has, in as many points as it may hold: their halves would merge at once and split again,
  // in every call.
  for (int const particles : {15, 16, 30}) {
    Synthetic s(Geometry::planar2d, false, false);
    for (int n = 0; n < particles; ++n) s.add({0.1 + 0.001 * n, 0.1, 0.0}, 1.0);
    mpm::PopulationPlace const place{s.grid.get(), 0, s.patches.data(), 2};
    auto const count = mpm::split_particles(s.set, place, {}, s.scratch, s.out);
    EXPECT_EQ(count.split > 0, particles < 16) << particles;
    // A pass may double what a cell that is not crowded holds, no more.
    EXPECT_LE(s.set.size(), 32) << particles;
  }
}

TEST(Splitting, FillsTheLargestGap) {
  // A lattice twice as long along y as along x: the new particles halve the distance along y.
  Synthetic s(Geometry::planar2d, false, false);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 8; ++i) s.add({0.125 * (i + 0.5), 0.25 * (j + 0.5), 0.0}, 0.125 * 0.2501);
  }
  EXPECT_EQ(s.control().split, 32);
  for (int q = 0; q < s.set.size(); ++q) {
    double const i = s.set.field(Field::position_x)[q] / 0.125 - 0.5;
    double const j = s.set.field(Field::position_y)[q] / 0.125 - 0.5;
    EXPECT_NEAR(i, std::round(i), 1e-12);
    EXPECT_NEAR(j, std::round(j), 1e-12);
  }
}

TEST(Merging, LeavesUnlikeParticlesAlone) {
  // Forty particles at one place, in 2D: forty is above the crowd (16), and above twice the crowd all merge that can.
  auto const merged = [](int particles, auto&& change) {
    Synthetic s(Geometry::planar2d, false, false);
    for (int n = 0; n < particles; ++n) change(s, s.add({0.1 + 0.001 * n, 0.1, 0.0}, 1e-4), n);
    return s.control().merged;
  };
  EXPECT_EQ(merged(30, [](Synthetic&, int, int) {}), 14);
  auto const composition = [](Synthetic& s, int q, int n) { s.set.field(Field::volume_fraction)[q] = n % 2; };
  EXPECT_EQ(merged(30, composition), 14);  // like with like
  auto const levels = [](Synthetic& s, int q, int n) { s.set.field(Field::pressure)[q] = std::pow(1.3, n); };
  EXPECT_EQ(merged(30, levels), 0);
  EXPECT_EQ(merged(40, levels), 8);
  auto const hot = [](Synthetic& s, int q, int n) {
    s.set.field(Field::density)[q] = std::pow(2.1, n);
    s.set.field(Field::mass)[q] = 1e-4 * std::pow(2.1, n);
  };
  EXPECT_EQ(merged(30, hot), 0);
  auto const fast = [](Synthetic& s, int q, int n) { s.set.field(Field::velocity_x)[q] = 0.4 * n; };
  EXPECT_EQ(merged(30, fast), 0);
}

TEST(Population, RefusesWhatIsNoGas) {
  Problem problem;
  problem.box(Geometry::planar2d, 1.0, {8, 8, 1}, Boundary::wall);
  problem.add(unit_solid(0.3));
  problem.add(gas(1.0, 1.0));
  problem.start();
  EXPECT_THROW(problem.mpm->control_population(0), InputError);
  EXPECT_NO_THROW(problem.mpm->control_population(1));
  PopulationOptions wrong;
  wrong.split_volume = 1.0;
  EXPECT_THROW(problem.mpm->control_population(1, wrong), InputError);
}

/// Every field of every particle, in the order in which they are kept.
std::vector<double> everything(Problem& problem) {
  std::vector<double> all;
  problem.for_each_particle(0, [&](ParticleSet const& set, int q) {
    for (int f = 0; f < mpm::field_count; ++f) {
      if (double const* values = set.field(static_cast<Field>(f))) all.push_back(values[q]);
    }
  });
  return all;
}

bool same_bits(std::vector<double> const& a, std::vector<double> const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(Population, LeavesAGasAtRestAlone) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::spherical1d, Geometry::axisymmetric2d,
                                  Geometry::planar2d, Geometry::cartesian3d}) {
    for (int const ppc : {1, 2, 3}) {
      Problem problem;
      problem.box(geometry, 0.125, {8, 8, 8}, Boundary::symmetry);
      problem.add(gas(1.0, 1.0), ppc);
      problem.start();
      problem.fill(0, shape::Everywhere{});
      auto const before = everything(problem);
      PopulationCount const count = problem.mpm->control_population(0);
      EXPECT_EQ(count.split, 0);
      EXPECT_EQ(count.merged, 0);
      EXPECT_TRUE(same_bits(everything(problem), before));
    }
  }
}

/// Gas at one end or in the middle of an empty domain.
struct Expansion : Problem {
  Expansion(Geometry geometry, double h, int cells, ShapeFunction shape, Transfer transfer, bool controlled_)
      : controlled(controlled_) {
    box(geometry, h, {cells, cells, cells}, Boundary::symmetry);
    domain.boundary[1] = domain.boundary[3] = domain.boundary[5] = Boundary::outflow;
    options = mpm::Options{};
    options.shape = shape;
    options.transfer = transfer;
    options.block_cells = 20;
    add(gas(1.0, 1.0));
  }
  void go(double end) {
    double const start = energy();
    for (long n = 1; mpm->time() < end - 1e-12; ++n) {
      mpm->advance(std::min({mpm->stable_step(), end - mpm->time(), 0.2 * domain.h}));
      if (!controlled || n % 4 != 0) continue;
      PopulationCount const count = mpm->control_population(0);
      total.split += count.split;
      total.merged += count.merged;
      total.heat += count.heat;
    }
    drift = energy() / start - 1.0;
  }
  /// Cells that hold no particle, and all of them, within the distance from the corner that holds 99 % of the mass. The
  /// rest is the front to the vacuum, which nothing resolves.
  std::pair<int, int> holes() {
    std::vector<std::pair<double, double>> distances;
    double whole = 0.0;
    std::vector<int> particles(static_cast<std::size_t>(domain.cell_count()), 0);
    for_each_particle(0, [&](ParticleSet const& set, int q) {
      Vec3 x = position(set, q);
      Index3 const i = mpm->grid().cell_at(x);
      ++particles[i[0] + static_cast<std::size_t>(domain.cells[0]) * i[1]];
      for (int d = domain.dimensions(); d < 3; ++d) x[d] = 0.0;
      distances.emplace_back(norm(x), set.field(Field::mass)[q]);
      whole += set.field(Field::mass)[q];
    });
    std::sort(distances.begin(), distances.end());
    double reach = 0.0;
    double mass = 0.0;
    for (auto const& [distance, m] : distances) {
      mass += m;
      if (mass <= 0.99 * whole) reach = distance;
    }
    std::pair<int, int> count{0, 0};
    for (int j = 0; j < domain.cells[1]; ++j) {
      for (int i = 0; i < domain.cells[0]; ++i) {
        double const y = domain.dimensions() > 1 ? (j + 0.5) * domain.h : 0.0;
        if (std::hypot((i + 0.5) * domain.h, y) > reach) continue;
        ++count.second;
        count.first += particles[i + static_cast<std::size_t>(domain.cells[0]) * j] == 0 ? 1 : 0;
      }
    }
    return count;
  }
  bool controlled;
  PopulationCount total;
  double drift = 0.0;
};

/// A gas too thin of pressure to matter, each particle with the velocity of its place, a x: rho = rho0/(1 + a t)^D
/// exactly.
TEST(Expansion, StaysWholeInAUniformFlow) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::planar2d}) {
    double without = 0.0;
    for (bool const controlled : {false, true}) {
      Expansion flow(geometry, 0.05, 80, ShapeFunction::bspline, Transfer::flip, controlled);
      flow.domain.boundary[3] = geometry == Geometry::planar2d ? Boundary::outflow : Boundary::symmetry;
      flow.bodies[0].solid = gas(1.0, 1e-6);
      flow.start();
      flow.fill(0, shape::Sphere{{0.0, 0.0, 0.0}, 0.5}, [&](Vec3 const& x) -> Vec3 {
        return {x[0], geometry == Geometry::planar2d ? x[1] : 0.0, 0.0};
      });
      flow.go(5.0);
      auto const [empty, all] = flow.holes();
      int const dims = flow.domain.dimensions();
      double const exact = std::pow(1.0 + flow.mpm->time(), -dims);
      // Within four fifths of the radius: particles at the rim see the gradient on one side only.
      double const rim = 0.5 * (1.0 + flow.mpm->time());
      double error = 0.0;
      double mass = 0.0;
      flow.for_each_particle(0, [&](ParticleSet const& set, int q) {
        Vec3 x = Problem::position(set, q);
        for (int d = dims; d < 3; ++d) x[d] = 0.0;
        if (norm(x) > 0.8 * rim) return;
        mass += set.field(Field::mass)[q];
        error += set.field(Field::mass)[q] * std::abs(set.field(Field::density)[q] / exact - 1.0);
      });
      error /= mass;
      std::printf("uniform %dD %s: %d of %d cells empty, %ld points, density off by %.2g, energy %+.2e\n", dims,
                  controlled ? "controlled" : "free", empty, all, mpm::particle_count(*flow.mpm), error, flow.drift);
      // Measured: without control two of three cells in 1D and nine of ten in 2D are empty, and the particles nearly
      // keep the density that they had when they lost sight of each other; with it none, and 0.9 %. The rest of the
      // error is that of one to two particles per cell and direction.
      if (controlled) {
        EXPECT_LE(empty, dims == 1 ? 0 : 0.015 * all);
        EXPECT_LT(error, 0.4 * without);
      } else {
        EXPECT_GT(empty, 0.6 * all);
        without = error;
      }
      EXPECT_LT(std::abs(flow.drift), 1e-6);
    }
  }
}

TEST(Expansion, FillsTheTubeBehindTheFront) {
  for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::cpgimp}) {
    for (bool const controlled : {false, true}) {
      Expansion tube(Geometry::planar1d, 0.01, 200, shape, Transfer::flip, controlled);
      tube.start();
      tube.fill(0, shape::Box{{0.0, -1.0, -1.0}, {0.2, 1.0, 1.0}});
      tube.go(0.3);
      auto const [empty, all] = tube.holes();
      std::printf("1D %s %s: %d of %d cells empty, %ld points, %ld split, energy %+.2e\n", word_of(shape),
                  controlled ? "controlled" : "free", empty, all, mpm::particle_count(*tube.mpm), tube.total.split,
                  tube.drift);
      EXPECT_EQ(tube.mpm->accounts().losses.particles, 0);
      if (controlled) {
        // Measured 2 % (splines) and 1 %; energy -1.8e-3 and -1.3e-3, without control -3.2e-3.
        EXPECT_LE(empty, 0.03 * all);
        EXPECT_LT(std::abs(tube.drift), 2e-3);
      } else {
        EXPECT_GT(empty, 0.4 * all);
      }
    }
  }
}

TEST(Expansion, FillsThePlaneBehindTheFront) {
  for (Transfer const transfer : {Transfer::flip, Transfer::apic}) {
    double without = 0.0;
    for (bool const controlled : {false, true}) {
      Expansion disk(Geometry::planar2d, 0.025, 80, ShapeFunction::bspline, transfer, controlled);
      disk.start();
      disk.fill(0, shape::Sphere{{0.0, 0.0, 0.0}, 0.4});
      disk.go(0.3);
      auto const [empty, all] = disk.holes();
      std::printf("2D %s %s: %d of %d cells empty, %ld points, %ld split, energy %+.2e\n", word_of(transfer),
                  controlled ? "controlled" : "free", empty, all, mpm::particle_count(*disk.mpm), disk.total.split,
                  disk.drift);
      // With APIC the energy that the transfer would lose is kept as heat: the thinnest particles of the front outrun
      // it.
      EXPECT_LE(disk.mpm->accounts().losses.particles, mpm::particle_count(*disk.mpm) / 1000);
      // Measured 4 to 5 % with control, 67 to 68 % without. APIC loses 6 % of the energy where particles are alone, 0.9
      // % where they are not; FLIP 0.24 and 0.20 %.
      if (controlled) {
        EXPECT_LE(empty, 0.06 * all);
        EXPECT_LT(std::abs(disk.drift), std::abs(without));
      } else {
        EXPECT_GT(empty, 0.6 * all);
        without = disk.drift;
      }
    }
  }
}

TEST(Compression, KeepsTheNumberBounded) {
  // A gas implodes onto the corner of two mirror planes, at eight times its sound speed.
  double without = 0.0;
  for (bool const controlled : {false, true}) {
    Problem problem;
    problem.box(Geometry::planar2d, 0.025, {40, 40, 1}, Boundary::symmetry);
    problem.options = mpm::Options{};
    problem.add(gas(1.0, 0.01));
    problem.start();
    problem.fill(0, shape::Sphere{{0.0, 0.0, 0.0}, 0.9}, [](Vec3 const& x) -> Vec3 {
      return (-1.0 / std::max(norm({x[0], x[1], 0.0}), 1e-9)) * Vec3{x[0], x[1], 0.0};
    });
    double const start = problem.energy();
    int crowded = 0;
    PopulationCount total;
    for (long n = 1; problem.mpm->time() < 0.5; ++n) {
      problem.mpm->advance(std::min(problem.mpm->stable_step(), 0.005));
      if (n % 8 != 0) continue;
      if (controlled) {
        PopulationCount const count = problem.mpm->control_population(0);
        total.merged += count.merged;
        total.split += count.split;
        total.heat += count.heat;
      }
      std::vector<int> particles(1600, 0);
      problem.for_each_particle(0, [&](ParticleSet const& set, int q) {
        Index3 const i = problem.mpm->grid().cell_at(Problem::position(set, q));
        crowded = std::max(crowded, ++particles[i[0] + 40 * i[1]]);
      });
    }
    std::printf("implosion %s: up to %d points in a cell, %ld points, %ld merged, %ld split, heat %.2e, energy %+.2e\n",
                controlled ? "controlled" : "free", crowded, mpm::particle_count(*problem.mpm), total.merged,
                total.split, total.heat, problem.energy() / start - 1.0);
    if (controlled) {
      EXPECT_LE(crowded, 32);  // twice the crowd; measured 16, the crowd itself
      EXPECT_GT(total.merged, 0);
      // The energy of this rough simulation drifts by 2.4 %, with and without merging; measured difference 1e-4.
      EXPECT_NEAR(problem.energy() / start, without, 1e-3);
    } else {
      EXPECT_GT(crowded, 32);  // measured 84
      without = problem.energy() / start;
    }
  }
}

TEST(Population, IsTheSameOnAnyNumberOfThreads) {
  for (ShapeFunction const shape : {ShapeFunction::bspline, ShapeFunction::cpgimp}) {
    for (Transfer const transfer : {Transfer::flip, Transfer::apic}) {
      auto const run = [&](int threads) {
        Expansion disk(Geometry::planar2d, 0.05, 40, shape, transfer, true);
        disk.options.block_cells = 5;
        disk.start();
        set_threads(threads);
        disk.fill(0, shape::Sphere{{0.0, 0.0, 0.0}, 0.6}, [](Vec3 const& x) -> Vec3 {
          double const s = x[0] * x[1] > 0.05 ? -3.0 : 1.0;  // part of it is compressed
          return {s * x[0], s * x[1], 0.0};
        });
        disk.go(0.3);
        EXPECT_GT(disk.total.split, 0);
        // No two particles have the same identity.
        std::vector<double> identities;
        disk.for_each_particle(
            0, [&](ParticleSet const& set, int q) { identities.push_back(set.field(Field::identity)[q]); });
        std::sort(identities.begin(), identities.end());
        EXPECT_GE(identities.front(), 0.0);
        EXPECT_EQ(std::adjacent_find(identities.begin(), identities.end()), identities.end());
        auto all = everything(disk);
        all.push_back(disk.total.heat);
        all.push_back(static_cast<double>(disk.total.merged));
        set_threads(1);
        return all;
      };
      auto const one = run(1);
      EXPECT_TRUE(same_bits(run(2), one)) << word_of(shape) << ", " << word_of(transfer);
      EXPECT_TRUE(same_bits(run(4), one)) << word_of(shape) << ", " << word_of(transfer);
    }
  }
}

TEST(Population, CostsLittle) {
  // A gas that flows but needs nothing, as most of it most of the time; measured 0.4 % (see below for one that
  // expands).
  Problem problem;
  problem.box(Geometry::cartesian3d, 1.0 / 16.0, {16, 16, 16}, Boundary::symmetry);
  problem.options = mpm::Options{};
  problem.add(gas(1.0, 1.0));
  problem.start();
  problem.fill(0, shape::Everywhere{}, [](Vec3 const& x) -> Vec3 {
    return {0.1 * std::sin(6.28 * x[0]) * std::cos(6.28 * x[1]), -0.1 * std::cos(6.28 * x[0]) * std::sin(6.28 * x[1]),
            0.0};
  });
  for (int n = 1; n <= 64; ++n) {
    problem.mpm->advance(0.01);
    if (n % 8 == 0) problem.mpm->control_population(0);
  }
  double sum = 0.0;
  for (auto const& [phase, seconds] : problem.mpm->timings()) sum += seconds;
  double const part = problem.mpm->timings().at("population") / sum;
  std::printf("%ld points, %.2f %% of the time\n", mpm::particle_count(*problem.mpm), 100.0 * part);
  EXPECT_LT(part, 0.03);
  // A ball that grows to three times its number of particles in some forty steps; measured 20 %.
  Expansion ball(Geometry::cartesian3d, 0.05, 30, ShapeFunction::bspline, Transfer::flip, true);
  ball.start();
  ball.fill(0, shape::Sphere{{0.0, 0.0, 0.0}, 0.6});
  ball.go(0.2);
  double const spent = ball.mpm->timings().at("population");
  sum = 0.0;
  for (auto const& [phase, seconds] : ball.mpm->timings()) sum += seconds;
  std::printf("%ld points, %ld split, %.2f %% of the time, %.2g us per split\n", mpm::particle_count(*ball.mpm),
              ball.total.split, 100.0 * spent / sum, 1e6 * spent / static_cast<double>(ball.total.split));
  EXPECT_LT(spent, 0.5 * sum);
}

}  // namespace
}  // namespace brisance::test
