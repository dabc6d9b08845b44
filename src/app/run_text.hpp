/// What the terminal says of a run, before it and after it.
#pragma once

#include "session/session.hpp"

namespace brisance::app {

/// What is about to be calculated, with the warnings of the plan.
void print_head(session::Session const& session, std::string const& title);
/// The remaps with which it starts.
void print_starts(run::World const& world);
/// Gauges, bodies, panels and the audit at its end.
void print_results(run::World const& world, observe::Gauges const& gauges);

}  // namespace brisance::app
