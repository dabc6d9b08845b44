// Gas particles that carry their composition: contacts, tubes against plain gases, viscosity of a body, refusals.
#include <numbers>

#include "core/error.hpp"
#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;
using material::Fluids;

constexpr double p_air = 101325.0;

Fluids air_and(material::Eos const& second) { return {{material::IdealGas{1.4}, second}, 2, p_air}; }

/// State of a gas that mixes: the fluids' own densities [kg/m3], the volume fraction of the second, pressure [Pa].
struct Blend {
  double first = 1.225;
  double second = 0.0;
  double alpha = 0.0;
  double pressure = p_air;
};

/// A tube of cells of length 1.
struct Tube : Problem {
  explicit Tube(int cells, Boundary boundary) {
    box(Geometry::planar1d, 1.0, {cells, 1, 1}, boundary);
    options = mpm::Options{};
    options.block_cells = 20;
  }

  /// Fills cells [from, to) of a body that mixes.
  void fill_with(int body, Blend const& s, double from, double to, double u = 0.0) {
    Fluids const& fluids = *bodies[body].solid.mixture;
    auto const placed = shape::place_particles(shape::Box{{from, -1.0, -1.0}, {to, 1.0, 1.0}}, domain,
                                               bodies[body].particles_per_direction);
    double const first = (1.0 - s.alpha) * s.first;
    double const second = s.alpha * s.second;
    mpm::Filling filling;
    filling.positions = placed.positions;
    filling.volumes = placed.volumes;
    filling.velocity = {u, 0.0, 0.0};
    filling.density = first + second;
    filling.specific_energy =
        material::mixture(fluids, {first, second}, material::Fractions::of(1, s.alpha)).rho_e(s.pressure) /
        (first + second);
    filling.mass_fraction = second / (first + second);
    filling.volume_fraction = s.alpha;
    mpm->fill(body, filling);
  }

  void advance(int steps) {
    for (int k = 0; k < steps; ++k) mpm->advance(mpm->stable_step());
  }
};

TEST(MixedGas, ContactsMoveAtUniformPressure) {
  // Products, products half in air, and air at one pressure in a uniform flow round a ring: nothing but the densities
  // and the compositions may move, and each particle keeps its own. Splines see no force, for the gradients of a spline
  // cancel on particles at equal distances.
  Tube ring(60, Boundary::periodic);
  double const p = 1e8;
  double const u = 800.0;
  ring.add(material::gas_of(air_and(material::Jwl{}), 1.225, p_air));
  ring.start();
  std::array const parts{Blend{20.0, 600.0, 1.0, p}, Blend{20.0, 600.0, 0.5, p}, Blend{20.0, 600.0, 0.0, p}};
  for (int part = 0; part < 3; ++part) ring.fill_with(0, parts[part], 20.0 * part, 20.0 * (part + 1), u);
  auto const Y = ring.values(0, Field::mass_fraction);
  auto const alpha = ring.values(0, Field::volume_fraction);
  EXPECT_EQ(alpha.front(), 1.0);
  EXPECT_EQ(alpha[60], 0.5);
  EXPECT_EQ(alpha.back(), 0.0);
  ring.advance(400);
  EXPECT_GT(u * ring.mpm->time(), 20.0) << "every contact passes into another block";
  // Round-off of 400 steps.
  EXPECT_LT(ring.largest(0, [&](auto const& set, int q) { return std::abs(set.field(Field::pressure)[q] / p - 1.0); }),
            1e-10);
  EXPECT_LT(
      ring.largest(0, [&](auto const& set, int q) { return std::abs(set.field(Field::velocity_x)[q] / u - 1.0); }),
      1e-10);
  EXPECT_EQ(ring.values(0, Field::mass_fraction), Y);
  EXPECT_EQ(ring.values(0, Field::volume_fraction), alpha);
}

/// Largest difference of a field between particles of two runs, relative to the largest value.
double difference(std::vector<double> const& a, std::vector<double> const& b) {
  double most = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::abs(a[i] - b[i]));
    scale = std::max(scale, std::abs(b[i]));
  }
  EXPECT_EQ(a.size(), b.size());
  return most / scale;
}

TEST(MixedGas, ProductsIntoAirAreTwoPlainBodies) {
  // One body whose left half is all products and whose right half is all air, against two bodies of the plain fluids.
  Blend const products{1.225, 400.0, 1.0, 3e8};
  Blend const air{1.225, 400.0, 0.0, p_air};
  Tube one(80, Boundary::wall);
  one.add(material::gas_of(air_and(material::Jwl{}), air.first, air.pressure));
  one.start();
  one.fill_with(0, products, 0.0, 40.0);
  one.fill_with(0, air, 40.0, 80.0);
  Tube two(80, Boundary::wall);
  two.add(material::of(material::Fluid{"products", "", material::Jwl{}, products.second, products.pressure}));
  two.add(material::of(material::Fluid{"air", "", material::IdealGas{1.4}, air.first, air.pressure}));
  two.start();
  two.fill(0, shape::Box{{0.0, -1.0, -1.0}, {40.0, 1.0, 1.0}});
  two.fill(1, shape::Box{{40.0, -1.0, -1.0}, {80.0, 1.0, 1.0}});
  for (int k = 0; k < 150; ++k) {
    double const dt = two.mpm->stable_step();
    EXPECT_NEAR(one.mpm->stable_step() / dt, 1.0, 1e-10);
    one.mpm->advance(dt);
    two.mpm->advance(dt);
  }
  for (Field const field : {Field::position_x, Field::velocity_x, Field::pressure, Field::density, Field::energy}) {
    auto expected = two.values(0, field);
    auto const right = two.values(1, field);
    expected.insert(expected.end(), right.begin(), right.end());
    // Round-off of 150 steps: the sums over particles run in another order.
    EXPECT_LT(difference(one.values(0, field), expected), 1e-10) << static_cast<int>(field);
  }
  EXPECT_GT(one.largest(0, [](auto const& set, int q) { return set.field(Field::velocity_x)[q]; }), 500.0);
}

TEST(MixedGas, TwoIdealGasesAreOne) {
  // Ideal gases mix to an ideal gas: 1/(gamma - 1) = sum alpha_k/(gamma_k - 1). Sod's tube of both.
  double const alpha = 0.3;
  double const gamma = 1.0 + 1.0 / ((1.0 - alpha) / 0.4 + alpha / 0.2);
  Tube mixed(80, Boundary::wall);
  mixed.add(material::gas_of(air_and(material::IdealGas{1.2}), 1.0, 1.0));
  mixed.start();
  mixed.fill_with(0, {1.0, 1.0, alpha, 1.0}, 0.0, 40.0);
  mixed.fill_with(0, {0.1, 0.125 / alpha - 0.1 * (1.0 - alpha) / alpha, alpha, 0.1}, 40.0, 80.0);
  Tube plain(80, Boundary::wall);
  plain.add(material::of(material::Fluid{"left", "", material::IdealGas{gamma}, 1.0, 1.0}));
  plain.add(material::of(material::Fluid{"right", "", material::IdealGas{gamma}, 0.125, 0.1}));
  plain.start();
  plain.fill(0, shape::Box{{0.0, -1.0, -1.0}, {40.0, 1.0, 1.0}});
  plain.fill(1, shape::Box{{40.0, -1.0, -1.0}, {80.0, 1.0, 1.0}});
  for (int k = 0; k < 150; ++k) {
    double const dt = plain.mpm->stable_step();
    mixed.mpm->advance(dt);
    plain.mpm->advance(dt);
  }
  for (Field const field : {Field::position_x, Field::velocity_x, Field::pressure, Field::density, Field::energy}) {
    auto expected = plain.values(0, field);
    auto const right = plain.values(1, field);
    expected.insert(expected.end(), right.begin(), right.end());
    EXPECT_LT(difference(mixed.values(0, field), expected), 1e-10) << static_cast<int>(field);
  }
}

TEST(ViscosityOfABody, StandsInForThatOfTheOptions) {
  auto const run = [](double linear, double quadratic, std::optional<double> own_linear,
                      std::optional<double> own_quadratic) {
    Tube tube(40, Boundary::wall);
    tube.options.linear_viscosity = linear;
    tube.options.quadratic_viscosity = quadratic;
    tube.add(material::gas_of(air_and(material::Jwl{}), 1.225, p_air));
    tube.bodies[0].linear_viscosity = own_linear;
    tube.bodies[0].quadratic_viscosity = own_quadratic;
    tube.start();
    tube.fill_with(0, {12.0, 0.0, 0.0, 1e6}, 0.0, 20.0);
    tube.fill_with(0, {1.225, 0.0, 0.0, p_air}, 20.0, 40.0);
    tube.advance(40);
    return tube.values(0, Field::pressure);
  };
  auto const usual = run(0.06, 1.5, {}, {});
  EXPECT_EQ(run(0.0, 0.0, 0.06, 1.5), usual);
  EXPECT_EQ(run(0.0, 1.5, 0.06, {}), usual);
  EXPECT_EQ(run(0.06, 0.0, {}, 1.5), usual);
  EXPECT_NE(run(0.06, 1.5, 0.0, {}), usual);
  EXPECT_NE(run(0.06, 1.5, {}, 0.0), usual);
}

TEST(MixedGas, RefusesCompositionsThatCannotBe) {
  auto const message = [](material::Material const& solid, double Y, double alpha) -> std::string {
    Tube tube(4, Boundary::wall);
    tube.add(solid);
    tube.start();
    mpm::Filling filling;
    filling.positions = {{1.0, 0.0, 0.0}};
    filling.volumes = {1.0};
    filling.mass_fraction = Y;
    filling.volume_fraction = alpha;
    try {
      tube.mpm->fill(0, filling);
    } catch (InputError const& error) {
      return error.what();
    }
    return "";
  };
  material::Material const mixing = material::gas_of(air_and(material::Jwl{}), 1.225, p_air);
  Fluids one = air_and(material::Jwl{});
  one.count = 1;
  EXPECT_EQ(message(mixing, 0.2, 0.1), "");
  EXPECT_NE(message(mixing, 1.2, 0.1).find("body 0"), std::string::npos);
  EXPECT_NE(message(mixing, 1.2, 0.1).find("1.2"), std::string::npos);
  EXPECT_NE(message(mixing, 0.2, -0.1).find("-0.1"), std::string::npos);
  EXPECT_NE(message(mixing, 0.2, std::nan("")).find("between 0 and 1"), std::string::npos);
  EXPECT_NE(message(material::gas_of(one, 1.225, p_air), 0.2, 0.1).find("second fluid"), std::string::npos);
  EXPECT_NE(message(unit_solid(0.3), 0.2, 0.1).find("second fluid"), std::string::npos);
  EXPECT_EQ(message(unit_solid(0.3), 0.0, 0.0), "");
}

/// A closed box of gas, half of it under ten times the pressure.
struct Box : Problem {
  explicit Box(Geometry geometry, bool fills_space = false) {
    int const dims = grid::dimensions(geometry);
    box(geometry, 1.0, {dims == 1 ? 100 : 24, 24, 1}, Boundary::wall);
    options = mpm::Options{};
    options.transfer = Transfer::apic;
    options.order = StressOrder::usl;
    options.block_cells = dims == 1 ? 30 : 10;
    add(material::gas_of(air_and(material::IdealGas{1.4}), 1.225, p_air));
    bodies[0].fills_space = fills_space;
  }
  [[nodiscard]] double energy() const {
    mpm::BodySums const sums = mpm::sums(*mpm, 0);
    return sums.kinetic_energy + sums.internal_energy;
  }
  void run(double time) {
    while (mpm->time() < time) mpm->advance(mpm->stable_step());
  }
};

// The shock passes some thirty times; each time a little energy was lost that the forces on the nodes had not done.
TEST(MixedGas, ShockedAgainAndAgainKeepsItsEnergy) {
  for (Geometry const geometry : {Geometry::planar1d, Geometry::planar2d, Geometry::axisymmetric2d}) {
    Box box(geometry);
    double const size = box.domain.cells[0];
    box.start();
    box.fill(0, shape::Box{{0.0, -1.0, -1.0}, {size, 50.0, 1.0}});
    box.for_each_particle(0, [&](mpm::ParticleSet& set, int q) {
      if (Problem::position(set, q)[0] > 0.5 * size) return;
      set.field(Field::energy)[q] *= 10.0;
      set.field(Field::pressure)[q] *= 10.0;
    });
    double const before = box.energy();
    box.run(30.0 * size / 700.0);
    std::printf("%s: energy %+.1e\n", word_of(geometry), box.energy() / before - 1.0);
    EXPECT_NEAR(box.energy() / before, 1.0, 1e-3);
  }
}

// Particles that believe to fill 5 % more than there is room for come back to the room as soon as the gas is strained,
// and change nothing while it is not.
TEST(MixedGas, VolumesFollowTheRoomThatThereIs) {
  for (double const speed : {0.0, 60.0}) {
    Box box(Geometry::planar1d, true);
    double const size = box.domain.cells[0];
    box.start();
    box.fill(0, shape::Box{{0.0, -1.0, -1.0}, {size, 1.0, 1.0}}, [&](Vec3 const& x) {
      return Vec3{speed * std::sin(std::numbers::pi * x[0] / size), 0.0, 0.0};
    });
    box.for_each_particle(0, [&](mpm::ParticleSet& set, int q) { set.field(Field::density)[q] /= 1.05; });
    auto const filled = [&] {
      double volume = 0.0;
      box.for_each_particle(0, [&](mpm::ParticleSet& set, int q) { volume += Problem::volume(set, q); });
      return volume / size;
    };
    double const mass = mpm::sums(*box.mpm, 0).mass;
    EXPECT_NEAR(filled(), 1.05, 1e-12);
    box.run(4.0 * size / 340.0);
    std::printf("%g m/s: the points fill %.4f of the room\n", speed, filled());
    EXPECT_NEAR(filled(), speed > 0.0 ? 1.0 : 1.05, speed > 0.0 ? 0.005 : 1e-12);
    EXPECT_EQ(mpm::sums(*box.mpm, 0).mass, mass);
  }
}

// Where particles of APIC share nodes with others, whose velocities are not those of the nodes, the gas gets the heat
// of its own meeting with them, not of their noise: that they keep themselves.
TEST(MixedGas, TakesNoEnergyFromTheNoiseOfOthers) {
  Box box(Geometry::planar2d);
  double const size = box.domain.cells[0];
  int const other = box.add(material::of(material::Fluid{"dense", "", material::IdealGas{1.4}, 500.0, p_air}));
  box.bodies[other].transfer = Transfer::flip;
  box.start();
  box.fill(0, shape::Box{{0.0, 0.0, -1.0}, {size, size, 1.0}});
  box.fill(other, shape::Box{{0.0, 0.0, -1.0}, {size, size, 1.0}}, [](Vec3 const& x) {
    return Vec3{20.0 * std::sin(97.0 * x[0] + 31.0 * x[1]), 20.0 * std::cos(53.0 * x[0] - 71.0 * x[1]), 0.0};
  });
  auto const energy = [&](int body) {
    mpm::BodySums const sums = mpm::sums(*box.mpm, body);
    return sums.kinetic_energy + sums.internal_energy;
  };
  double const noise = mpm::sums(*box.mpm, other).kinetic_energy;
  double const gas = energy(0);
  double const all = gas + energy(other);
  box.run(0.3);
  std::printf("noise %.3g J: gas %+.3g J, all %+.3g J\n", noise, energy(0) - gas, energy(0) + energy(other) - all);
  EXPECT_LT(std::abs(energy(0) + energy(other) - all), 0.1 * noise);
}

}  // namespace
}  // namespace brisance::test
