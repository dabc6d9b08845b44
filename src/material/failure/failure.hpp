/// The closed list of failure models. Contract: a trivially copyable value with a parameter table, the flag `damages`
/// (plastic strain makes it grow) and, if it is set, failure_strain(triaxiality, ln r, T*). Tensile damage belongs to
/// the strength hjc and is coupled to it in stress_concrete.cpp. At damage 1 a particle carries no deviatoric stress
/// and no tension and stays in the simulation.
#pragma once

#include <variant>

#include "material/failure/johnson_cook_failure.hpp"
#include "material/failure/none.hpp"
#include "material/failure/tensile_damage.hpp"

namespace brisance::material {

using Failure = std::variant<NoFailure, JohnsonCookFailure, TensileDamage>;

}  // namespace brisance::material
