// One step of the engine against the same step written down from the definitions: all particles times all nodes, dense.
#include <random>

#include "mpm/harness.hpp"

namespace brisance::test {
namespace {

using grid::Boundary;
using grid::Geometry;

/// Integral of the tent max(0, 1 - |t|) from -1 to x.
double tent_integral(double x) {
  if (x <= -1.0) return 0.0;
  if (x >= 1.0) return 1.0;
  return x <= 0.0 ? 0.5 * (1.0 + x) * (1.0 + x) : 1.0 - 0.5 * (1.0 - x) * (1.0 - x);
}
double tent(double x) { return std::max(0.0, 1.0 - std::abs(x)); }

/// Weight of a node at a distance of x cells, by definition, and its derivative.
double weight(ShapeFunction shape, double x, double half) {
  double const r = std::abs(x);
  switch (shape) {
    case ShapeFunction::linear: return tent(x);
    case ShapeFunction::bspline: return r < 0.5 ? 0.75 - r * r : r < 1.5 ? 0.5 * (1.5 - r) * (1.5 - r) : 0.0;
    default: return (tent_integral(x + half) - tent_integral(x - half)) / (2.0 * half);
  }
}
double slope(ShapeFunction shape, double x, double half) {
  double const r = std::abs(x);
  double const sign = x > 0.0 ? 1.0 : -1.0;
  switch (shape) {
    case ShapeFunction::linear: return r < 1.0 ? -sign : 0.0;
    case ShapeFunction::bspline: return r < 0.5 ? -2.0 * x : r < 1.5 ? sign * (r - 1.5) : 0.0;
    default: return (tent(x + half) - tent(x - half)) / (2.0 * half);
  }
}

struct Particle {
  Vec3 x{}, v{};
  double mass = 0.0;
  double density = 0.0;
  std::array<double, 6> stress{};  ///< with the viscosity
  std::array<Vec3, 3> affine{};    ///< APIC, rows
};

/// The same step, slowly. `density` at the end is that of Eq. (27) with the velocities that the stress order takes.
struct Reference {
  Problem const& problem;
  std::vector<Particle> particles;
  int dims;
  std::vector<Vec3> nodes;
  std::vector<double> mass;
  std::vector<Vec3> old_velocity, velocity;

  explicit Reference(Problem const& p) : problem(p), dims(p.domain.dimensions()) {
    Index3 n{1, 1, 1};
    for (int d = 0; d < dims; ++d) n[d] = p.domain.cells[d] + 1;
    for (int k = 0; k < n[2]; ++k) {
      for (int j = 0; j < n[1]; ++j) {
        for (int i = 0; i < n[0]; ++i) nodes.push_back({i * p.domain.h, j * p.domain.h, k * p.domain.h});
      }
    }
  }

  double w(Particle const& p, Vec3 const& node) const {
    double product = 1.0;
    for (int d = 0; d < dims; ++d)
      product *= weight(problem.options.shape, (p.x[d] - node[d]) / problem.domain.h, half());
    return product;
  }
  double half() const { return 0.5 / problem.bodies[0].particles_per_direction; }
  Vec3 gradient(Particle const& p, Vec3 const& node) const {
    Vec3 g{0.0, 0.0, 0.0};
    for (int d = 0; d < dims; ++d) {
      double product = 1.0 / problem.domain.h;
      for (int e = 0; e < dims; ++e) {
        double const u = (p.x[e] - node[e]) / problem.domain.h;
        product *= e == d ? slope(problem.options.shape, u, half()) : weight(problem.options.shape, u, half());
      }
      g[d] = product;
    }
    return g;
  }
  static Vec3 times(std::array<Vec3, 3> const& m, Vec3 const& x) { return {dot(m[0], x), dot(m[1], x), dot(m[2], x)}; }
  Vec3 flat(Vec3 x) const {
    for (int d = dims; d < 3; ++d) x[d] = 0.0;
    return x;
  }

  /// Velocity of the nodes from that of the particles.
  std::vector<Vec3> map(std::vector<Vec3> const& of_particles, bool affine) {
    mass.assign(nodes.size(), 0.0);
    std::vector<Vec3> out(nodes.size(), Vec3{0.0, 0.0, 0.0});
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      for (std::size_t q = 0; q < particles.size(); ++q) {
        double const m = particles[q].mass * w(particles[q], nodes[n]);
        mass[n] += m;
        Vec3 v = of_particles[q];
        if (affine) v = v + times(particles[q].affine, flat(nodes[n] - particles[q].x));
        out[n] = out[n] + m * v;
      }
      if (mass[n] > 0.0) out[n] = (1.0 / mass[n]) * out[n];
    }
    return out;
  }
  Vec3 at(Particle const& p, std::vector<Vec3> const& field) const {
    Vec3 sum{0.0, 0.0, 0.0};
    for (std::size_t n = 0; n < nodes.size(); ++n) sum = sum + w(p, nodes[n]) * field[n];
    return sum;
  }
  /// Density after the volume change of a step; the particles still stand where they were.
  void stretch(std::vector<Vec3> const& field, double dt) {
    for (Particle& p : particles) {
      double change = 0.0;
      for (std::size_t n = 0; n < nodes.size(); ++n) change += dot(gradient(p, nodes[n]), field[n]);
      p.density /= 1.0 + dt * change;
    }
  }

  void step(double dt) {
    mpm::Options const& o = problem.options;
    bool const affine = o.transfer == Transfer::apic;
    std::vector<Vec3> own;
    for (Particle const& p : particles) own.push_back(p.v);
    old_velocity = map(own, affine);
    velocity = old_velocity;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      Vec3 force{0.0, 0.0, 0.0};
      for (Particle const& p : particles) {
        Vec3 const g = gradient(p, nodes[n]);
        auto const& s = p.stress;
        Vec3 const pull{s[0] * g[0] + s[3] * g[1] + s[5] * g[2], s[3] * g[0] + s[1] * g[1] + s[4] * g[2],
                        s[5] * g[0] + s[4] * g[1] + s[2] * g[2]};
        force = force + (-p.mass / p.density) * pull;
      }
      if (mass[n] > 0.0) velocity[n] = velocity[n] + (dt / mass[n]) * force + dt * o.body_force;
    }
    std::vector<Vec3> noise = own;  // XPIC: (1 - S+ S)^m v
    for (int m = 0; o.transfer == Transfer::xpic && m < o.xpic_order; ++m) {
      auto const seen = map(noise, false);
      for (std::size_t q = 0; q < particles.size(); ++q) noise[q] = noise[q] - at(particles[q], seen);
    }
    std::vector<Vec3> moved;
    for (std::size_t q = 0; q < particles.size(); ++q) {
      Particle& p = particles[q];
      Vec3 const now = at(p, velocity);
      Vec3 const flip = p.v + (now - at(p, old_velocity));
      moved.push_back(p.x + dt * flat(now));
      switch (o.transfer) {
        case Transfer::flip: p.v = (1.0 - o.pic_fraction) * flip + o.pic_fraction * now; break;
        case Transfer::xpic: p.v = flip - noise[q]; break;
        case Transfer::apic: {
          p.v = now;
          for (auto& row : p.affine) row = {0.0, 0.0, 0.0};
          for (int d = 0; d < dims; ++d) {
            // sum w v (x_I - x) / sum w (x_I - x)^2, direction by direction; for tents the gradient.
            double moment = 0.0;
            Vec3 sum{0.0, 0.0, 0.0};
            Vec3 sloped{0.0, 0.0, 0.0};
            for (std::size_t n = 0; n < nodes.size(); ++n) {
              double const distance = nodes[n][d] - p.x[d];
              moment += w(p, nodes[n]) * distance * distance;
              sum = sum + w(p, nodes[n]) * distance * velocity[n];
              sloped = sloped + gradient(p, nodes[n])[d] * velocity[n];
            }
            for (int i = 0; i < 3; ++i) {
              p.affine[i][d] = o.shape == ShapeFunction::linear ? sloped[i] : sum[i] / moment;
            }
          }
          break;
        }
      }
    }
    if (o.order == StressOrder::musl) {
      own.clear();
      for (Particle const& p : particles) own.push_back(p.v);
      stretch(map(own, affine), dt);
    } else {
      stretch(velocity, dt);
    }
    for (std::size_t q = 0; q < particles.size(); ++q) particles[q].x = moved[q];
  }
};

class ReferenceStep : public testing::TestWithParam<std::tuple<Geometry, ShapeFunction>> {};

INSTANTIATE_TEST_SUITE_P(All, ReferenceStep,
                         testing::Combine(testing::Values(Geometry::planar1d, Geometry::planar2d,
                                                          Geometry::cartesian3d),
                                          testing::ValuesIn(all_shapes)),
                         [](auto const& one) {
                           return std::string(word_of(std::get<0>(one.param))) + "_" + word_of(std::get<1>(one.param));
                         });

TEST_P(ReferenceStep, AgreesWithTheDefinitions) {
  auto const [geometry, shape] = GetParam();
  double worst = 0.0;
  for (Transfer const transfer : {Transfer::flip, Transfer::apic, Transfer::xpic}) {
    for (StressOrder const order : {StressOrder::usl, StressOrder::musl}) {
      Problem problem;
      double const h = 0.1;
      problem.box(geometry, h, {8, 6, 5}, Boundary::outflow);
      problem.options.shape = shape;
      problem.options.transfer = transfer;
      problem.options.order = order;
      problem.options.pic_fraction = 0.3;
      problem.options.xpic_order = 3;
      problem.options.body_force = {0.3, -0.2, 0.1};
      problem.options.block_cells = 4;
      problem.add(unit_solid(0.3));
      problem.start();
      // Anywhere but within a cell of the faces, in no order, of different masses, in any state of stress.
      std::mt19937 random(7);
      std::uniform_real_distribution<double> uniform(0.0, 1.0);
      mpm::Filling filling;
      int const dims = problem.domain.dimensions();
      int const count = 40;
      for (int n = 0; n < count; ++n) {
        Vec3 x = problem.domain.centre({0, 0, 0});
        for (int d = 0; d < dims; ++d) x[d] = h * (1.6 + (problem.domain.cells[d] - 3.2) * uniform(random));
        filling.positions.push_back(x);
        filling.volumes.push_back(std::pow(h / 2.0, dims) * (0.5 + uniform(random)));
      }
      problem.mpm->fill(0, filling);
      Reference reference(problem);
      reference.particles.resize(count);
      problem.for_each_particle(0, [&](mpm::ParticleSet& set, int q) {
        std::array<double, 6> s{};
        for (double& c : s) c = 0.1 * (uniform(random) - 0.5);
        problem.put_stress(0, set, q, s);
        Vec3 v{0.0, 0.0, 0.0};
        for (int d = 0; d < 3; ++d) v[d] = uniform(random) - 0.5;
        Problem::put(set, q, Field::velocity_x, v);
        double const viscosity = 0.01 * uniform(random);
        set.field(Field::viscosity)[q] = viscosity;
        Particle& p = reference.particles[static_cast<std::size_t>(set.field(Field::identity)[q])];
        p.x = Problem::position(set, q);
        p.v = v;
        p.mass = set.field(Field::mass)[q];
        p.density = set.field(Field::density)[q];
        p.stress = Problem::stress(set, q);
        for (int d = 0; d < 3; ++d) p.stress[d] -= viscosity;
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; transfer == Transfer::apic && j < dims; ++j) {
            p.affine[i][j] = uniform(random) - 0.5;
            set.field(Field::affine_xx + (3 * i + j))[q] = p.affine[i][j];
          }
        }
      });
      double const dt = 0.01;
      reference.step(dt);
      problem.mpm->advance(dt);
      double error = 0.0;
      problem.for_each_particle(0, [&](mpm::ParticleSet const& set, int q) {
        Particle const& p = reference.particles[static_cast<std::size_t>(set.field(Field::identity)[q])];
        Vec3 const dx = Problem::position(set, q) - p.x;
        Vec3 const dv = Problem::get(set, q, Field::velocity_x) - p.v;
        error = std::max({error, norm(dx), norm(dv), std::abs(set.field(Field::density)[q] - p.density)});
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; transfer == Transfer::apic && j < dims; ++j) {
            // A gradient, per second: of velocities over h.
            double const off = set.field(Field::affine_xx + (3 * i + j))[q] - p.affine[i][j];
            error = std::max(error, h * std::abs(off));
          }
        }
      });
      EXPECT_LT(error, 1e-12) << word_of(transfer) << " " << word_of(order);
      worst = std::max(worst, error);
    }
  }
  std::printf("%s %s: largest difference %.1e\n", word_of(geometry), word_of(shape), worst);
}

}  // namespace
}  // namespace brisance::test
