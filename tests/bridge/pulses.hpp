/// Packets of sound that pass the bridge, head on or at an angle. Shared by the tests and by the validation.
#pragma once

#include <complex>
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

  /// At a place and time; to first order.
  [[nodiscard]] Value at(double x, double y, double t) const {
    Value sum;
    for (Wave const& w : waves_) {
      double const k = std::hypot(w.kx, ky_);
      double const p = amplitude * (w.strength * std::polar(1.0, w.kx * (x - centre_) + ky_ * y - k * t)).imag();
      sum.p += p;
      sum.u += p / 1.4 * w.kx / k;
      sum.v += p / 1.4 * ky_ / k;
    }
    return sum;
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
};

struct PulseSetting {
  double wavelength = 20.0;  ///< [cells], about: at an angle the trace along the face is a whole number of cells
  double angle = 0.0;        ///< between the wave's direction and the normal of the face [degrees]
  bool into_region = true;   ///< from the gas to the points, or back
  double periods = 3.0;
  std::function<void(run::MpmRegion&)> change = nullptr;
};

struct PulseResult {
  double wavelength = 0.0;         ///< [cells]
  double reflected = 0.0;          ///< rms on the side where the packet came from / rms at the start
  double reflected_alone = 0.0;    ///< the same of the gas scheme alone: what the packet leaves behind
  double transmitted = 0.0;        ///< rms on the other side / rms there in the gas scheme alone
  double kept = 0.0;               ///< rms on the other side / rms at the start
  double kept_alone = 0.0;         ///< the same in the gas scheme alone
  double mass = 0.0;               ///< relative error
};

inline PulseResult run_pulse(PulseSetting const& setting) {
  double const angle = setting.angle * std::numbers::pi / 180.0;
  bool const oblique = setting.angle > 0.0;
  int const rows = oblique ? static_cast<int>(std::lround(setting.wavelength / std::sin(angle))) : 1;
  double const wavelength = oblique ? rows * std::sin(angle) : setting.wavelength;
  double const length = setting.periods * wavelength / std::cos(angle);  // [cells] along x
  constexpr int before = 12;                                              // from the packet to the face at the start
  constexpr int beyond = 16;                                              // and at the end
  // The window widens with time at an angle, since its waves have different directions.
  int const spare = 8 + static_cast<int>(0.25 * length * std::sin(angle));
  int const half = static_cast<int>(std::ceil(length)) + before + beyond + spare;
  int const n = 2 * half;
  double const h = 1.0 / n;

  auto c = coupled_case(oblique ? grid::Geometry::planar2d : grid::Geometry::planar1d, {n, rows, 1},
                        grid::Boundary::outflow);
  c.domain.boundary[2] = c.domain.boundary[3] = grid::Boundary::periodic;
  set_region(c, {setting.into_region ? half : 0, 0, 0}, {setting.into_region ? n : half, rows, 1});
  c.mpm_region->activation = -1.0;
  if (setting.change) setting.change(*c.mpm_region);
  double const centre = 0.5 - (0.5 * length + before) * h;
  double const ky = oblique ? 2.0 * std::numbers::pi / (rows * h) : 0.0;
  Packet const packet(centre, wavelength * h, ky, length * h, 4.0);

  auto const make = [&](bool with_points) {
    run::Case one = c;
    if (!with_points) one.mpm_region.reset();
    auto w = std::make_unique<run::World>(one);
    w->clock.step = 10;  // no gentle start: the points' first step is as long as all others
    for_each_cell(*w, [&](int block, int offset, Index3 const& cell) {
      Packet::Value const s = packet.at((cell[0] + 0.5) * h, (cell[1] + 0.5) * h, 0.0);
      gas::MixtureState m;
      m.ambient_density = 1.4 * std::pow(1.0 + s.p, 1.0 / 1.4);
      m.pressure = 1.0 + s.p;
      m.velocity = {s.u, s.v, 0.0};
      w->gas->set(block, offset, m);
    });
    w->gas->start();
    if (!with_points) return w;
    double const half_step = 0.5 * w->points->stable_step();  // the velocity of points lags (leapfrog)
    for (int b = 0; b < w->points->grid().block_count(); ++b) {
      mpm::PointSet& set = w->points->points(b, w->gas_body());
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
  // Sums of squares of the overpressure on both sides, bridge and its neighbours included.
  auto const squares = [&](run::World const& w) {
    std::array<double, 2> sum{0.0, 0.0};
    for (int j = 0; j < rows; ++j) {
      auto const p = pressure_line(w, j);
      for (int i = 0; i < n; ++i) sum[i < half ? 0 : 1] += (p[i] - 1.0) * (p[i] - 1.0);
    }
    return sum;
  };
  auto const coupled = make(true);
  auto const alone = make(false);
  run::Totals const start = coupled->totals();
  auto const in = squares(*alone);
  double const end = (length + before + beyond) * h / std::cos(angle);
  run_to(*coupled, end);
  run_to(*alone, end);
  auto const out = squares(*coupled);
  auto const out_alone = squares(*alone);
  PulseResult r;
  r.wavelength = wavelength;
  r.reflected = std::sqrt(out[0] / in[0]);
  r.reflected_alone = std::sqrt(out_alone[0] / in[0]);
  r.transmitted = std::sqrt(out[1] / out_alone[1]);
  r.kept = std::sqrt(out[1] / in[0]);
  r.kept_alone = std::sqrt(out_alone[1] / in[0]);
  r.mass = balance_of(*coupled, start).mass;
  return r;
}

}  // namespace brisance::test
