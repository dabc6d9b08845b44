/// The closed list of failure models. Contract: a trivially copyable value with a parameter table, the flag `damages`
/// and, if it is set, failure_strain(triaxiality, ln r, T*). At damage 1 a point carries no deviatoric stress and no
/// tension and stays in the calculation.
#pragma once

#include <variant>

#include "material/failure/johnson_cook_failure.hpp"
#include "material/failure/none.hpp"

namespace brisance::material {

using Failure = std::variant<NoFailure, JohnsonCookFailure>;

}  // namespace brisance::material
