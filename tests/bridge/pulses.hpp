/// Packets of sound that pass the bridge, head on or at an angle. Shared by the tests and by the validation.
#pragma once

#include <complex>
#include <map>
#include <numbers>

#include "bridge/harness.hpp"

namespace brisance::test {

/// A packet of sound of relative amplitude 1e-3 in a gas with rho = 1.4, p = 1, c = 1, as a sum of plane waves that all
/// go to the right and have the same wave number along y: an exact solution of the linear equations at any time.
class Packet {
 public:
  /// `wavelength` and `length` (of the window cos^2) [m]; `ky`: wave number along y [1/m]; `box`: period along x that
  /// the packet never notices.
  Packet(double centre, double wavelength, double ky, double length, double box) : centre_(centre), ky_(ky) {
    double const pi = std::numbers::pi;
    double const k = 2.0 * pi / wavelength;
    double const kx = std::sqrt(k * k - ky * ky);
    int const samples = 4096;
    double const dk = 2.0 * pi / box;
    // The spectrum of the window falls with the cube of the distance from kx; waves that stand or go to the left are
    // left out.
    int const last = static_cast<int>(2.5 * kx / dk);
    for (int m = 1; m <= last; ++m) {
      std::complex<double> sum = 0.0;
      for (int n = 0; n < samples; ++n) {
        double const s = ((n + 0.5) / samples - 0.5) * length;
        double const window = std::cos(pi * s / length);
        sum += window * window * std::polar(1.0, (kx - m * dk) * s);
      }
      waves_.push_back({m * dk, sum * (length / samples / box)});
    }
  }

  struct Value {
    double p = 0.0;  ///< relative to the pressure
    double u = 0.0;  ///< [m/s], c = 1
    double v = 0.0;
  };

  /// At a place and time; to first order. Places come in columns: the sum over the waves is made once for each x.
  [[nodiscard]] Value at(double x, double y, double t) {
    auto const [found, fresh] = columns_.try_emplace({x, t});
    auto& column = found->second;
    if (fresh) {
      for (Wave const& w : waves_) {
        double const k = std::hypot(w.kx, ky_);
        std::complex<double> const p = amplitude * w.strength * std::polar(1.0, w.kx * (x - centre_) - k * t);
        column[0] += p;
        column[1] += p / 1.4 * w.kx / k;
        column[2] += p / 1.4 * ky_ / k;
      }
    }
    std::complex<double> const phase = std::polar(1.0, ky_ * y);
    return {(column[0] * phase).imag(), (column[1] * phase).imag(), (column[2] * phase).imag()};
  }

  static constexpr double amplitude = 1e-3;

 private:
  struct Wave {
    double kx;
    std::complex<double> strength;
  };
  double centre_;
  double ky_;
  std::vector<Wave> waves_;
  std::map<std::pair<double, double>, std::array<std::complex<double>, 3>> columns_;  ///< by x and time
};

struct PulseSetting {
  double wavelength = 20.0;    ///< [cells], about: at an angle the trace along the face is a whole number of cells
  double angle = 0.0;          ///< between the wave's direction and the normal of the face [degrees]
  bool into_region = true;     ///< from the gas to the particles, or back
  bool particles_too = false;  ///< also in particles alone
  double periods = 3.0;
  std::function<void(run::MpmRegion&)> change = nullptr;
};

/// Root mean squares of the overpressure over one side of the face, relative to the packet at the start.
struct PulseResult {
  double wavelength = 0.0;         ///< [cells]
  double reflected = 0.0;          ///< side where the packet came from: difference to the same medium without a bridge
  double left_behind = 0.0;        ///< there without a bridge: slow waves of an oblique packet
  double kept = 0.0;               ///< on the other side
  double kept_by_gas = 0.0;        ///< there, in the gas scheme alone
  double kept_by_particles = 0.0;  ///< there, in particles alone
  double mass = 0.0;               ///< relative error
  [[nodiscard]] double transmitted() const { return kept / kept_by_gas; }
};

inline PulseResult run_pulse(PulseSetting const& setting) {
  double const angle = setting.angle * std::numbers::pi / 180.0;
  bool const oblique = setting.angle > 0.0;
  int const rows = oblique ? static_cast<int>(std::lround(setting.wavelength / std::sin(angle))) : 1;
  double const wavelength = oblique ? rows * std::sin(angle) : setting.wavelength;
  double const length = setting.periods * wavelength / std::cos(angle);  // [cells] along x
  constexpr int before = 12;                                             // from the packet to the face at the start
  constexpr int beyond = 16;                                             // and at the end
  // The window widens with time at an angle, since its waves have different directions.
  int const spare = 8 + static_cast<int>(0.25 * length * std::sin(angle));
  int const half = static_cast<int>(std::ceil(length)) + before + beyond + spare;
  int const n = 2 * half;
  double const h = 1.0 / n;

  auto c = coupled_case(oblique ? grid::Geometry::planar2d : grid::Geometry::planar1d, {n, rows, 1},
                        grid::Boundary::outflow);
  c.domain.boundary[2] = c.domain.boundary[3] = grid::Boundary::periodic;
  set_region(c, {setting.into_region ? half : 0, 0, 0}, {setting.into_region ? n : half, rows, 1});
  c.mpm_regions.front().activation = -1.0;
  if (setting.change) setting.change(c.mpm_regions.front());
  double const centre = 0.5 - (0.5 * length + before) * h;
  double const ky = oblique ? 2.0 * std::numbers::pi / (rows * h) : 0.0;
  Packet packet(centre, wavelength * h, ky, length * h, 2.0);

  enum class Media { both, gas, particles };
  auto const make = [&](Media media) {
    bool const with_particles = media != Media::gas;
    run::Case one = c;
    if (!with_particles) one.mpm_regions.clear();
    if (media == Media::particles) {
      one.mpm_regions.front().boxes.clear();
      set_region(one, {0, 0, 0}, {n, rows, 1});
    }
    auto w = std::make_unique<run::World>(setup::build(one));
    w->clock.step = 10;  // no gentle start: the particles' first step is as long as all others
    for_each_cell(*w, [&](int, int, Index3 const& cell) {
      Packet::Value const s = packet.at((cell[0] + 0.5) * h, (cell[1] + 0.5) * h, 0.0);
      material::Primitive m;
      m.density = 1.4 * std::pow(1.0 + s.p, 1.0 / 1.4);
      m.pressure = 1.0 + s.p;
      m.velocity = {s.u, s.v, 0.0};
      w->gas->set(w->grid.locate(cell), m);
    });
    w->gas->start();
    if (!with_particles) return w;
    double const half_step =
        0.5 * w->regions.front().particles->stable_step();  // the velocity of particles lags (leapfrog)
    for (int b = 0; b < w->regions.front().particles->grid().block_count(); ++b) {
      mpm::ParticleSet& set = w->regions.front().particles->particles(b, w->regions.front().gas_body());
      for (int q = 0; q < set.size(); ++q) {
        double const x = set.field(Field::position_x)[q];
        double const y = oblique ? set.field(Field::position_y)[q] : 0.0;
        Packet::Value const s = packet.at(x, y, 0.0);
        Packet::Value const earlier = packet.at(x, y, -half_step);
        double const rho = 1.4 * std::pow(1.0 + s.p, 1.0 / 1.4);
        set.field(Field::mass)[q] *= rho / 1.4;
        set.field(Field::density)[q] = rho;
        set.field(Field::pressure)[q] = 1.0 + s.p;
        set.field(Field::energy)[q] = (1.0 + s.p) / (0.4 * rho);
        set.field(Field::velocity_x)[q] = earlier.u;
        set.field(Field::velocity_y)[q] = earlier.v;
      }
    }
    return w;
  };
  auto const field = [&](run::World const& w) {
    std::vector<std::vector<double>> p;
    for (int j = 0; j < rows; ++j) p.push_back(pressure_line(w, j));
    return p;
  };
  // Root of the sum of squares over a side; the bridge and its neighbours are included.
  auto const size = [&](std::vector<std::vector<double>> const& p, std::vector<std::vector<double>> const& less,
                        int first, int last) {
    double sum = 0.0;
    for (int j = 0; j < rows; ++j) {
      for (int i = first; i < last; ++i) sum += std::pow(p[j][i] - (less.empty() ? 1.0 : less[j][i]), 2);
    }
    return std::sqrt(sum);
  };
  double const end = (length + before + beyond) * h / std::cos(angle);
  auto const coupled = make(Media::both);
  auto const gas = make(Media::gas);
  run::Totals const start = coupled->totals();
  double const in = size(field(*gas), {}, 0, n);
  run_to(*coupled, end);
  run_to(*gas, end);
  auto const p = field(*coupled);
  auto const p_gas = field(*gas);
  std::vector<std::vector<double>> p_particles;
  PulseResult r;
  if (setting.particles_too || !setting.into_region) {
    auto const particles = make(Media::particles);
    run_to(*particles, end);
    p_particles = field(*particles);
    r.kept_by_particles = size(p_particles, {}, half, n) / in;
  }
  auto const& p_same = setting.into_region ? p_gas : p_particles;
  r.wavelength = wavelength;
  r.reflected = size(p, p_same, 0, half) / in;
  r.left_behind = size(p_same, {}, 0, half) / in;
  r.kept = size(p, {}, half, n) / in;
  r.kept_by_gas = size(p_gas, {}, half, n) / in;
  r.mass = balance_of(*coupled, start).mass;
  return r;
}

}  // namespace brisance::test
