/// Afterburn: energy that detonation products release after the detonation, as their carbon, carbon monoxide and
/// hydrogen burn. Neither model knows how much air has been mixed in: both release their energy in proportion to the
/// mass of the products, wherever these are.
///
/// A progress lambda runs from 0 to 1, and the specific internal energy of the products grows by Q d(lambda).
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <variant>

#include "core/math.hpp"
#include "core/parameter.hpp"

namespace brisance::material {

/// Constant rate between two times: lambda = (t - begin) / (end - begin), from 0 to 1.
struct ConstantRateAfterburn {
  double begin = 0.0;   ///< [s]
  double end = 1.0e-2;  ///< [s]

  static constexpr char const* name = "constant_rate";
  static constexpr auto parameters() {
    return std::array{
        Parameter<ConstantRateAfterburn>{"begin", "s", &ConstantRateAfterburn::begin, 0.0, 1e4,
                                         "Time at which the release begins, not before the end of the detonation"},
        Parameter<ConstantRateAfterburn>{"end", "s", &ConstantRateAfterburn::end, 0.0, 1e4,
                                         "Time at which all energy has been released"},
    };
  }

  /// lambda at a time [s].
  [[nodiscard]] double progress(double time) const { return std::clamp((time - begin) / (end - begin), 0.0, 1.0); }
};

/// Miller's rate law [Miller95]: d(lambda)/dt = a (1 - lambda)^m p^n, where the pressure exceeds p_min. With n > 0 it
/// starts by itself from lambda = 0. The unit of a depends on n; here it is the rate at a reference pressure, so that
/// constants published in megabar and microseconds are the rate a per microsecond at 100 GPa.
struct MillerAfterburn {
  double rate = 6500.0;               ///< at lambda = 0 and the reference pressure [1/s]
  double reference_pressure = 100e9;  ///< [Pa]
  double m = 0.5;                     ///< exponent of 1 - lambda
  double n = 0.1667;                  ///< exponent of the pressure
  double minimum_pressure = 1e5;      ///< below it nothing burns [Pa]

  static constexpr char const* name = "miller";
  static constexpr auto parameters() {
    using M = MillerAfterburn;
    return std::array{
        Parameter<M>{"rate", "s-1", &M::rate, 1e-6, 1e12, "Rate a at lambda = 0 and the reference pressure"},
        Parameter<M>{"reference_pressure", "Pa", &M::reference_pressure, 1.0, 1e13,
                     "Reference pressure for `rate`: 1 Mbar for constants in megabar and microseconds", 100e9},
        Parameter<M>{"m", "1", &M::m, 0.0, 0.99, "Exponent of 1 - lambda"},
        Parameter<M>{"n", "1", &M::n, 0.0, 10.0, "Exponent of the pressure"},
        Parameter<M>{"minimum_pressure", "Pa", &M::minimum_pressure, 0.0, 1e13,
                     "Pressure below which there is no afterburn", 0.0},
    };
  }

  /// 1 - lambda after a time dt [s] from 1 - lambda before it, exact for a constant pressure [Pa]. For m < 1 the
  /// products burn out in a finite time.
  [[nodiscard]] double advance(double unburnt, double pressure, double dt) const {
    double const burns = pressure > minimum_pressure ? 1.0 : 0.0;
    double const k = rate * pow_nonnegative(std::max(pressure, 0.0) / reference_pressure, n);
    double const left = pow_nonnegative(unburnt, 1.0 - m) - (1.0 - m) * k * dt;
    double const after = pow_nonnegative(std::max(left, 0.0), 1.0 / (1.0 - m));
    // Where nothing burns not even the last bit changes, which the two powers might.
    return unburnt - burns * std::max(unburnt - after, 0.0);
  }
};

/// The closed list of rates. Contract: a trivially copyable value with a parameter table and either progress(time),
/// where lambda follows from the time alone, or advance(1 - lambda, pressure, dt), where the products carry it along.
/// A `meaning` goes into the manual.
using AfterburnRate = std::variant<ConstantRateAfterburn, MillerAfterburn>;

struct Afterburn {
  double energy = 0.0;  ///< Q per mass of products, released from lambda = 0 to 1 [J/kg]
  AfterburnRate rate;

  /// Has every part of the products a lambda of its own, which must be carried along with them?
  [[nodiscard]] bool carried() const {
    return std::visit(
        [](auto const& law) {
          return requires { law.advance(1.0, 0.0, 0.0); };
        },
        rate);
  }
  /// lambda at a time [s] where it is the same everywhere, else none.
  [[nodiscard]] std::optional<double> progress(double time) const {
    return std::visit(
        [time](auto const& law) -> std::optional<double> {
          if constexpr (requires { law.progress(time); }) {
            return law.progress(time);
          } else {
            return std::nullopt;
          }
        },
        rate);
  }
};

}  // namespace brisance::material
