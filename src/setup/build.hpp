/// A case becomes a world.
#pragma once

#include "run/world.hpp"

namespace brisance::setup {

/// The initial state of a case, with the audit begun. Throws InputError where the case cannot be realised (charge over
/// a symmetry plane, ...).
[[nodiscard]] run::World build(Case setup);

}  // namespace brisance::setup
