/// A world that is built with its gauges, as tests look at it.
#pragma once

#include "observe/gauges.hpp"
#include "setup/build.hpp"

namespace brisance::observe {

class Watched : public run::World {
 public:
  explicit Watched(Case c) : World(setup::build(std::move(c))), gauges(*this) {}

  void sample_gauges() { gauges.sample(*this); }
  void record_bodies() { gauges.record_bodies(*this); }
  void archive(Archive& a) {
    World::archive(a);
    gauges.archive(a, *this);
  }

  Gauges gauges;
};

}  // namespace brisance::observe
