/// The passes of one step over the blocks; see `mpm.hpp`.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/timer.hpp"
#include "mpm/contact.hpp"
#include "mpm/mpm.hpp"
#include "mpm/set_kernels.hpp"
#include "mpm/workspace.hpp"

namespace brisance::mpm {

namespace {

double amplitude(ActiveLoad const& load, double time) {
  if (time < load.times.front() || time > load.times.back()) return 0.0;
  for (std::size_t n = 1; n < load.times.size(); ++n) {
    if (time > load.times[n]) continue;
    double const s = (time - load.times[n - 1]) / (load.times[n] - load.times[n - 1]);
    return (1.0 - s) * load.pressures[n - 1] + s * load.pressures[n];
  }
  return load.pressures.back();
}

/// Mean of pressure and bulk viscosity over each cell of a set.
CellMeans mean_pressures(SetView const& v, Scratch& scratch) {
  PointSet const& set = *v.set;
  double const* mass = set.field(Field::mass);
  double const* density = set.field(Field::density);
  double const* pressure = set.field(Field::pressure);
  double const* viscosity = set.field(Field::viscosity);
  CellMeans means(v, scratch);
  for (int q = 0; q < set.size(); ++q) means.add(q, mass[q] / density[q], pressure[q] + viscosity[q]);
  return means;
}

/// How far apart neighbours along d stand among a patch's nodes.
int stride_of(Patch const& patch, int d) { return d == 0 ? 1 : d == 1 ? patch.n[0] : patch.n[0] * patch.n[1]; }

/// Storage index along d of a patch's node.
int index_along(Patch const& patch, int d, int node) { return node / stride_of(patch, d) % patch.n[d]; }

/// Calls visit(d, side, face) for each of the `Options::ends` within reach of a block's nodes, with the index along d
/// of the nodes on it.
template <class Visit>
void for_ends(Options const& options, Patch const& patch, double h, Visit&& visit) {
  for (int d = 0; d < patch.dimensions; ++d) {
    for (int side = 0; side < 2; ++side) {
      std::optional<double> const& end = options.ends[2 * d + side];
      if (!end) continue;
      int const face = patch.reach + static_cast<int>(std::lround((*end - patch.first[d]) / h));
      if (face >= 0 && face < patch.n[d]) visit(d, side, face);
    }
  }
}

/// A body that reaches one of the ends goes on behind it: what it fills there is the mirror image of what it fills
/// before it, so that it has no surface on the end. Of the points of one block: all nodes that one touches behind an
/// end have their image in the block's patch.
void continue_behind_ends(Options const& options, Patch const& patch, double h, NodeVelocity* filled) {
  for_ends(options, patch, h, [&](int d, int, int face) {
    Lanes4 sign{1.0, 1.0, 1.0, 1.0};
    sign[d] = -1.0;
    int const stride = stride_of(patch, d);
    int const width = std::min({patch.reach, face, patch.n[d] - 1 - face});
    for (int node = 0; node < patch.count(); ++node) {
      if (index_along(patch, d, node) != face) continue;
      filled[node] += sign * filled[node];
      for (int k = 1; k <= width; ++k) {
        NodeVelocity const before = filled[node - k * stride];
        NodeVelocity const behind = filled[node + k * stride];
        filled[node - k * stride] = before + sign * behind;
        filled[node + k * stride] = behind + sign * before;
      }
    }
  });
}

/// There it shows no area to an end either.
void cut_at_ends(Options const& options, Patch const& patch, double h, NodeVelocity* area) {
  for_ends(options, patch, h, [&](int d, int side, int face) {
    double const outwards = side == 0 ? -1.0 : 1.0;
    for (int node = 0; node < patch.count(); ++node) {
      if (std::abs(index_along(patch, d, node) - face) > patch.reach || outwards * area[node][d] <= 0.0) continue;
      area[node][d] = 0.0;
    }
  });
}

/// What the velocity of a fluid that slips along a held body changes by at a node, to stay at the body's surface.
Vec3 follow(double mass_floor, NodeVelocity const& filled, NodeVelocity const& body, NodeVelocity const& fluid) {
  Surface const surface = surface_at(filled);
  if (!(fluid[3] > mass_floor) || !surface.felt) return {0.0, 0.0, 0.0};
  return surface.stopped({body[0] - fluid[0], body[1] - fluid[1], body[2] - fluid[2]});
}

}  // namespace

void Mpm::advance(double dt) {
  if (static_cast<int>(work_->scratch.size()) < threads()) work_->scratch.resize(threads());
  for (Scratch& scratch : work_->scratch) {
    scratch.state.resize(work_->fields);
    scratch.velocity.resize(work_->fields);
    scratch.gradient.resize(work_->fields);
    scratch.area.resize(work_->fields);
    scratch.extent.resize(work_->fields);
    scratch.present.resize(work_->fields);
    scratch.exchange.resize(work_->fields);
    scratch.exchanges.resize(work_->fields);
    scratch.halt.resize(work_->fields);
    scratch.halts.resize(work_->fields);
  }
  bool const first = options_.order == StressOrder::usf;
  if (first) {
    map_to_grid(true, false);
    update_stress(dt);
    // Points that stretched with the stress weigh on their nodes anew.
    map_to_grid(options_.shape == ShapeFunction::cpgimp, true);
  } else {
    map_to_grid(true, true);
  }
  if (work_->filters) filter();
  integrate(dt);
  if (!first) update_stress(dt);
  if (work_->conducts) conduct();
  collect_signals();
  time_ += dt;
  ++step_;
  migrate();
}

void Mpm::map_to_grid(bool with_mass, bool with_forces) {
  PhaseTimer const timer(timings_["points to grid"]);
  Workspace& w = *work_;
  double const h = grid_.domain().h;
  Hoops const hoops = hoops_of(grid_.domain().geometry);
  OuterForces const outer = outer_forces();
  if (with_mass) std::fill(w.present.begin(), w.present.end(), 0);
  if (with_mass) std::fill(w.momentum_present.begin(), w.momentum_present.end(), 0);
  if (with_forces) std::fill(w.area_present.begin(), w.area_present.end(), 0);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    for_sets(block, [&](PointSet& set, int body) {
      int const slot = w.slot(block, w.field_of[body]);
      NodeState* nodes = w.state[slot].get(patch.count());
      bool const surface = w.contact && w.slips[w.field_of[body]] == 0;
      NodeVelocity* gradient = surface ? w.gradient[slot].get(patch.count()) : nullptr;
      if (w.present[slot] == 0) {
        std::fill(nodes, nodes + patch.count(), NodeState{});
        if (gradient != nullptr) std::fill(gradient, gradient + patch.count(), NodeVelocity{});
        w.present[slot] = 1;
      }
      SetView const view{&set, &bodies_[body], &patch, h};
      std::optional<CellMeans> means;
      if (with_forces && options_.locking_control && bodies_[body].solid.has_deviator())
        means = mean_pressures(view, w.scratch[thread]);
      CellMeans const* mean = means ? &*means : nullptr;
      with_kernels(options_.shape, patch.dimensions, [&](auto kernels) {
        if (with_mass && with_forces) {
          kernels.template map_state<true, true>(view, hoops, outer, mean, nodes);
        } else if (with_mass) {
          kernels.template map_state<true, false>(view, hoops, outer, mean, nodes);
        } else {
          kernels.template map_state<false, true>(view, hoops, outer, mean, nodes);
        }
        if (with_forces && w.slides) map_areas(block, body, view, kernels);
        if (with_mass && gradient != nullptr) kernels.map_gradient(view, grid_.domain().geometry, gradient);
        if (with_mass && w.shared[w.field_of[body]] != 0 && !affine(body)) {
          NodeVelocity* own = w.momentum[slot].get(patch.count());
          if (w.momentum_present[slot] == 0) std::fill(own, own + patch.count(), NodeVelocity{});
          w.momentum_present[slot] = 1;
          kernels.map_velocity(view, Field::velocity_x, own);
        }
      });
    });
    for (int f = 0; with_mass && w.slides && f < w.fields; ++f) {
      int const slot = w.slot(block, f);
      if (w.slips[f] == 0 && w.present[slot] != 0) continue_behind_ends(options_, patch, h, w.gradient[slot].data());
    }
  });
  if (with_mass && w.touches) map_extents();
}

/// What `share_pressure` needs of one set: of fluids only where there are bodies around.
template <class SetKernels>
void Mpm::map_areas(int block, int body, SetView const& view, SetKernels&& kernels) {
  Workspace& w = *work_;
  int const f = w.field_of[body];
  bool const slips = w.slips[f] != 0;
  if (slips) {
    auto const has_bodies = [&](int there) {
      if (there == grid::no_neighbour) return false;
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        if (w.slips[w.field_of[b]] == 0 && !points(there, static_cast<int>(b)).empty()) return true;
      }
      return false;
    };
    if (std::none_of(w.around[block].begin(), w.around[block].end(), has_bodies)) return;
  }
  int const slot = w.slot(block, f);
  int const count = view.patch->count();
  NodeVelocity* nodes = w.area[slot].get(count);
  if (w.area_present[slot] == 0) std::fill(nodes, nodes + count, NodeVelocity{});
  w.area_present[slot] = 1;
  if (slips) {
    kernels.map_pressure(view, nodes);
  } else {
    kernels.map_area(view, hoops_of(grid_.domain().geometry), nodes);
  }
}

/// The pressure of a fluid that slips along bodies acts on the area that these show to the nodes, and they push back as
/// much. Then gas at rest under an even pressure stays at rest, and the bodies bear that pressure and no other up to
/// their outermost points, also where the velocity of the nodes is not shared; by the shared velocity alone they would
/// bear what the gas around happens to give to nodes that they hardly weigh on.
void Mpm::share_pressure(int block, double dt, Scratch& scratch) const {
  Workspace const& w = *work_;
  scratch.pressed = {};
  int const count = w.patches[block].count();
  for (int g = 0; g < w.fields; ++g) {
    if (w.slips[g] == 0 || scratch.present[g] == 0) continue;
    if (!w.gather(w.area, w.area_present, block, g, scratch.area[g], true)) continue;
    NodeVelocity const* pressure = scratch.area[g].data();
    NodeState* fluid = scratch.state[g].data();
    for (int f = 0; f < w.fields; ++f) {
      if (!w.slips_along(g, f) || scratch.present[f] == 0) continue;
      if (!w.gather(w.area, w.area_present, block, f, scratch.area[f])) continue;
      cut_at_ends(options_, w.patches[block], grid_.domain().h, scratch.area[f].data());
      NodeVelocity const* area = scratch.area[f].data();
      NodeVelocity const* filled = scratch.gradient[f].data();
      NodeState* body = scratch.state[f].data();
      for (int node = 0; node < count; ++node) {
        if (!(fluid[node].momentum[3] > w.mass_floor && body[node].momentum[3] > w.mass_floor)) continue;
        Surface const surface = surface_at(filled[node]);
        Lanes4 push = area[node];
        if (surface.felt) {
          // Deep in the body next to no gas is there to bear what does not point along the normal, in which they move
          // as one.
          Vec3 const& n = surface.normal;
          double const across = push[0] * n[0] + push[1] * n[1] + push[2] * n[2];
          push = Lanes4{across * n[0], across * n[1], across * n[2], 0.0};
        }
        double const p = pressure[node][0] / pressure[node][1];
        push *= Lanes4{p, p, p, 0.0};
        fluid[node].force += push;
        body[node].force -= push;
        if (!w.rigid[f]) continue;
        for (int d = 0; d < 3; ++d) {
          double const impulse = w.node_weight[block][node] * dt * push[d];
          scratch.pressed.impulse[d] += impulse;
          scratch.pressed.work += impulse * (*w.rigid[f])[d];
        }
      }
    }
  }
}

OuterForces Mpm::outer_forces() const {
  OuterForces outer;
  for (ActiveLoad const& load : work_->loads) outer.pressures.push_back(amplitude(load, time_));
  outer.acceleration = options_.acceleration;
  outer.time = time_;
  return outer;
}

double Mpm::work_on(int block, int body, OuterForces const& outer) const {
  PointSet const& set = points(block, body);
  if (bodies_[body].rigid_velocity) return 0.0;
  Vec3 const& g = options_.body_force;
  double const* load_number = set.field(Field::load_number);
  double const* mass = set.field(Field::mass);
  double work = 0.0;
  if (dot(g, g) > 0.0) {
    for (int d = 0; d < 3; ++d) {
      double const* move = set.field(Field::move_x + d);
      for (int q = 0; q < set.size(); ++q) work += mass[q] * g[d] * move[q];
    }
  }
  if (outer.acceleration) {
    for (int q = 0; q < set.size(); ++q) {
      Vec3 const a = outer.acceleration(
          {set.field(Field::position_x)[q], set.field(Field::position_y)[q], set.field(Field::position_z)[q]},
          outer.time);
      for (int d = 0; d < 3; ++d) work += mass[q] * a[d] * set.field(Field::move_x + d)[q];
    }
  }
  if (load_number != nullptr) {
    for (int q = 0; q < set.size(); ++q) {
      if (load_number[q] <= 0.0) continue;
      double const push =
          mass[q] / set.field(Field::density)[q] * outer.pressures[static_cast<std::size_t>(load_number[q]) - 1];
      for (int d = 0; d < 3; ++d) work += push * set.field(Field::load_x + d)[q] * set.field(Field::move_x + d)[q];
    }
  }
  return work;
}

void Mpm::map_extents() {
  Workspace& w = *work_;
  double const h = grid_.domain().h;
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    Scratch& scratch = w.scratch[thread];
    gather_gradients(block, scratch);
    for (int f = 0; f < w.fields; ++f) {
      int const slot = w.slot(block, f);
      if (w.present[slot] == 0 || w.slips[f] != 0) continue;
      std::vector<Vec3> normals(patch.count(), Vec3{0.0, 0.0, 0.0});
      bool any = false;
      for (int node = 0; node < patch.count(); ++node) {
        NodeVelocity others{};
        bool met = false;
        bool rigid = false;
        for (int g = 0; g < w.fields; ++g) {
          if (g == f || w.slips[g] != 0 || scratch.present[g] == 0) continue;
          NodeVelocity const& gradient = scratch.gradient[g].data()[node];
          others += gradient;
          rigid = rigid || w.rigid[g].has_value();
          met = met || gradient[0] != 0.0 || gradient[1] != 0.0 || gradient[2] != 0.0;
        }
        if (!met) continue;
        normals[node] = contact_normal(scratch.gradient[f].data()[node], w.rigid[f].has_value(), others, rigid);
        any = true;
      }
      double* extents = w.extent[slot].get(patch.count());
      std::fill(extents, extents + patch.count(), -std::numeric_limits<double>::max());
      if (!any) continue;
      for_sets(block, [&](PointSet& set, int body) {
        if (w.field_of[body] != f) return;
        SetView const view{&set, &bodies_[body], &patch, h};
        with_kernels(options_.shape, patch.dimensions,
                     [&](auto kernels) { kernels.map_extent(view, grid_.domain().geometry, normals.data(), extents); });
      });
    }
  });
}

void Mpm::gather_gradients(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  for (int f = 0; f < w.fields; ++f) {
    if (w.slips[f] != 0) continue;
    scratch.present[f] = w.gather(w.gradient, block, f, scratch.gradient[f]) ? 1 : 0;
  }
}

void Mpm::filter() {
  PhaseTimer const timer(timings_["filter"]);
  Workspace& w = *work_;
  double const h = grid_.domain().h;
  auto const each_set = [&](int block, auto&& work) {
    for_sets(block, [&](PointSet& set, int body) {
      if (!set.fields().has(Field::filtered_x)) return;
      SetView const view{&set, &bodies_[body], &w.patches[block], h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) { work(body, view, kernels); });
    });
  };
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    for_sets(active_[n], [&](PointSet& set, int) {
      if (!set.fields().has(Field::filtered_x)) return;
      for (int d = 0; d < 3; ++d) {
        double const* v = set.field(Field::velocity_x + d);
        std::copy(v, v + set.size(), set.field(Field::filtered_x + d));
      }
    });
  });
  for (int pass = 0; pass < options_.xpic_order; ++pass) {
    parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
      int const block = active_[n];
      clear_velocity(block);
      each_set(block, [&](int body, SetView const& view, auto kernels) {
        kernels.map_velocity(view, Field::filtered_x, w.velocity[w.slot(block, w.field_of[body])].data());
      });
    });
    parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
      int const block = active_[n];
      Scratch& scratch = w.scratch[thread];
      gather_velocity(block, scratch);
      each_set(block, [&](int body, SetView const& view, auto kernels) {
        kernels.filter(view, scratch.velocity[w.field_of[body]].data());
      });
    });
  }
}

void Mpm::conduct() {
  PhaseTimer const timer(timings_["heat in shocks"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  double const h = grid_.domain().h;
  auto const each_set = [&](int block, auto&& work) {
    for (int body = 0; body < bodies; ++body) {
      PointSet& set = points(block, body);
      if (set.empty() || bodies_[body].shock_conduction <= 0.0) continue;
      SetView const view{&set, &bodies_[body], &w.patches[block], h};
      with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) { work(body, view, kernels); });
    }
  };
  // Blocks without a shock have nothing to exchange but with their neighbours.
  std::fill(w.shocked.begin(), w.shocked.end(), 0);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    int const block = active_[n];
    bool shocked = false;
    for (int body = 0; body < bodies; ++body) {
      PointSet const& set = points(block, body);
      if (set.empty() || bodies_[body].shock_conduction <= 0.0) continue;
      double const* p = set.field(Field::pressure);
      double const* q = set.field(Field::viscosity);
      for (int k = 0; k < set.size() && !shocked; ++k) shocked = q[k] > 1e-3 * p[k];
    }
    w.shocked[block] = shocked ? 1 : 0;
  });
  auto const near_shock = [&](int block) {
    auto const& around = w.around[block];
    return std::any_of(around.begin(), around.end(),
                       [&](int other) { return other != grid::no_neighbour && w.shocked[other] != 0; });
  };
  parallel_for(static_cast<int>(active_.size()), [&](int n, int) {
    int const block = active_[n];
    if (!near_shock(block)) {
      // Its neighbours may look at it all the same.
      bool const seen = std::any_of(w.around[block].begin(), w.around[block].end(),
                                    [&](int other) { return other != grid::no_neighbour && near_shock(other); });
      if (!seen) return;
    }
    clear_velocity(block);
    each_set(block, [&](int body, SetView const& view, auto kernels) {
      kernels.map_heat(view, w.velocity[w.slot(block, w.field_of[body])].data());
    });
  });
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    if (!near_shock(block)) return;
    Scratch& scratch = w.scratch[thread];
    gather_velocity(block, scratch, true);  // divides by the mass
    int const count = w.patches[block].count();
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0) continue;
      NodeVelocity* nodes = scratch.velocity[f].data();
      for (int node = 0; node < count; ++node) nodes[node][0] *= nodes[node][1];
    }
    each_set(block, [&](int body, SetView const& view, auto kernels) {
      kernels.take_heat(view, scratch.velocity[w.field_of[body]].data());
    });
  });
}

void Mpm::clear_velocity(int block) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    int const slot = w.slot(block, f);
    if (w.present[slot] == 0) continue;
    NodeVelocity* nodes = w.velocity[slot].get(count);
    std::fill(nodes, nodes + count, NodeVelocity{});
  }
}

void Mpm::gather_velocity(int block, Scratch& scratch, bool scalars) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.present[f] = w.gather(w.velocity, block, f, scratch.velocity[f], scalars) ? 1 : 0;
    if (scratch.present[f] == 0) continue;
    NodeVelocity* nodes = scratch.velocity[f].data();
    double const floor = w.mass_floor;
    for (int node = 0; node < count; ++node) {
      double const m = nodes[node][3];
      double const inverse = m > floor ? 1.0 / m : 0.0;
      nodes[node] *= NodeVelocity{inverse, inverse, inverse, 1.0};
    }
  }
}

void Mpm::constrain_velocity(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    if (scratch.present[f] == 0 || !w.rigid[f]) continue;
    NodeVelocity* nodes = scratch.velocity[f].data();
    for (int node = 0; node < count; ++node) {
      for (int d = 0; d < 3; ++d) nodes[node][d] = (*w.rigid[f])[d];
    }
  }
  if (w.contact) {
    struct Access {
      Scratch* s;
      double mass(int f, int node) const { return s->velocity[f].data()[node][3]; }
      Vec3 get(int f, int node) const {
        NodeVelocity const& v = s->velocity[f].data()[node];
        return {v[0], v[1], v[2]};
      }
      void set(int f, int node, Vec3 const& v) const {
        for (int d = 0; d < 3; ++d) s->velocity[f].data()[node][d] = v[d];
      }
      NodeVelocity const& gradient(int f, int node) const { return s->gradient[f].data()[node]; }
      double extent(int f, int node) const { return s->extent[f].data()[node]; }
    };
    make_compatible({count, w.fields, w.mass_floor, &scratch.present, &w.laws, &w.rigid, &w.slips}, Access{&scratch});
  }
  for (Hold const& hold : w.holds[block]) {
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0 || w.rigid[f] || !w.held(f, hold)) continue;
      NodeVelocity& v = scratch.velocity[f].data()[hold.node];
      for (int d = 0; d < 3; ++d) {
        if (hold.held[d]) v[d] = hold.velocity[d];
      }
      for (int g = 0; g < w.fields; ++g) {
        if (!w.slips_along(g, f) || scratch.present[g] == 0) continue;
        NodeVelocity& fluid = scratch.velocity[g].data()[hold.node];
        Vec3 const change = follow(w.mass_floor, scratch.gradient[f].data()[hold.node], v, fluid);
        for (int d = 0; d < 3; ++d) fluid[d] += change[d];
      }
    }
  }
}

void Mpm::gather_extents(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  Patch const& patch = w.patches[block];
  for (int f = 0; f < w.fields; ++f) {
    if (scratch.present[f] == 0 || w.slips[f] != 0) continue;
    double* extents = scratch.extent[f].get(patch.count());
    std::fill(extents, extents + patch.count(), -std::numeric_limits<double>::max());
    for (Link const& link : patch.links) {
      int const slot = w.slot(link.source, f);
      if (w.present[slot] == 0) continue;
      double const* from = w.extent[slot].data();
      for (int k = link.lower[2]; k <= link.upper[2]; ++k) {
        for (int j = link.lower[1]; j <= link.upper[1]; ++j) {
          for (int i = link.lower[0]; i <= link.upper[0]; ++i) {
            double& to = extents[patch.index(i, j, k)];
            to = std::max(to, from[link.source_index(i, j, k)]);
          }
        }
      }
    }
  }
}

void Mpm::integrate(double dt) {
  PhaseTimer const timer(timings_["momentum and motion"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  double const h = grid_.domain().h;
  bool const map_back = w.maps_back;
  bool const strain_here = w.strains_early;
  Hoops const hoops = hoops_of(grid_.domain().geometry);
  OuterForces const outer = outer_forces();
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Patch const& patch = w.patches[block];
    int const count = patch.count();
    Scratch& scratch = w.scratch[thread];
    Vec3 const force = options_.body_force;
    for (int f = 0; f < w.fields; ++f) {
      scratch.present[f] = w.gather(w.state, block, f, scratch.state[f]) ? 1 : 0;
    }
    if (w.contact) {
      gather_gradients(block, scratch);
      if (w.touches) gather_extents(block, scratch);
    }
    if (w.slides) share_pressure(block, dt, scratch);
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0) continue;
      NodeState* nodes = scratch.state[f].data();
      // Eq. (22): from mass, momentum and force to the new velocity and its change.
      double const floor = w.mass_floor;
      Lanes4 const gravity{dt * force[0], dt * force[1], dt * force[2], 0.0};
      for (int node = 0; node < count; ++node) {
        NodeState& r = nodes[node];
        double const m = r.momentum[3];
        double const inverse = m > floor ? 1.0 / m : 0.0;
        double const push = dt * inverse;
        r.force = r.force * Lanes4{push, push, push, 1.0} + gravity;
        r.momentum = r.momentum * Lanes4{inverse, inverse, inverse, 1.0} + r.force * Lanes4{1.0, 1.0, 1.0, 0.0};
      }
    }
    constrain_state(block, scratch);
    share_momentum(block, scratch);
    if (options_.order != StressOrder::usf) signals_[block] = 0.0;  // usf has found them already
    if (w.keeps_energy) {
      // In the place of the mass: kinetic energy of the points around per mass, with what the forces of the step add.
      for (int f = 0; f < w.fields; ++f) {
        if (scratch.present[f] == 0) continue;
        NodeState* nodes = scratch.state[f].data();
        for (int node = 0; node < count; ++node) {
          NodeState& r = nodes[node];
          double const m = r.momentum[3];
          double sum = m > w.mass_floor ? r.force[3] / m : 0.0;
          for (int d = 0; d < 3; ++d) sum += r.force[d] * (r.momentum[d] - 0.5 * r.force[d]);
          r.momentum[3] = sum;
        }
      }
    }

    if (map_back) clear_velocity(block);
    for_sets(block, [&](PointSet& set, int body) {
      int const f = w.field_of[body];
      SetView const view{&set, &bodies_[body], &patch, h};
      bool const own = lent_body_ < 0 || &set != &lent_[block];
      with_kernels(options_.shape, patch.dimensions, [&](auto kernels) {
        if (own) {
          NodeVelocity const* exchange = scratch.exchanges[f] == 0 ? nullptr : scratch.exchange[f].data();
          NodeVelocity const* halt = scratch.halts[f] == 0 ? nullptr : scratch.halt[f].data();
          Dissipation const lost =
              kernels.move(view, options_, dt, keeps_energy(body), scratch.state[f].data(), exchange, halt);
          w.dissipation[block].held += lost.held;
          w.dissipation[block].filtered += lost.filtered;
          w.work[block] += work_on(block, body, outer);
        } else {
          for (int d = 0; d < 3; ++d) {
            std::copy_n(set.field(Field::next_x + d), set.size(), set.field(Field::velocity_x + d));
          }
        }
        if (map_back) kernels.map_velocity(view, Field::velocity_x, w.velocity[w.slot(block, f)].data());
      });
    });
    if (!strain_here) return;
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0) continue;
      NodeState const* from = scratch.state[f].data();
      NodeVelocity* to = scratch.velocity[f].get(count);
      for (int node = 0; node < count; ++node) to[node] = from[node].momentum;
    }
    for (int body = 0; body < bodies; ++body) {
      if (order_of(body) == StressOrder::usl) update_set(block, body, hoops, dt, scratch);
    }
  });
}

/// Points of APIC take over the velocity of their nodes, all others add its change to their own. Where both share nodes
/// the first give and take momentum there that the others must take and give: they add the difference between the
/// nodes' common velocity and their own one.
void Mpm::share_momentum(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.exchanges[f] = 0;
    if (w.shared[f] == 0 || scratch.present[f] == 0) continue;
    if (!w.gather(w.momentum, w.momentum_present, block, f, scratch.exchange[f])) continue;
    scratch.exchanges[f] = 1;
    NodeState const* nodes = scratch.state[f].data();
    NodeVelocity* exchange = scratch.exchange[f].data();
    for (int node = 0; node < count; ++node) {
      double const own = exchange[node][3];
      // Where the others are alone the difference is round-off.
      bool const both = own > w.mass_floor && nodes[node].momentum[3] - own > 1e-12 * own;
      double const inverse = both ? 1.0 / own : 0.0;
      double const part = both ? 1.0 : 0.0;
      NodeVelocity const common = nodes[node].momentum - nodes[node].force;
      exchange[node] = part * common - inverse * exchange[node];
    }
  }
}

void Mpm::constrain_state(int block, Scratch& scratch) {
  Workspace& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    if (scratch.present[f] == 0 || !w.rigid[f]) continue;
    Vec3 const& v = *w.rigid[f];
    NodeState* nodes = scratch.state[f].data();
    for (int node = 0; node < count; ++node) {
      NodeState& r = nodes[node];
      r.momentum = Lanes4{v[0], v[1], v[2], r.momentum[3]};
      r.force = Lanes4{0.0, 0.0, 0.0, r.force[3]};
    }
  }
  Given given = scratch.pressed;
  if (w.contact) {
    struct Access {
      Scratch* s;
      std::vector<std::optional<Vec3>> const* rigid;
      double const* weights;  ///< of the nodes; null: nobody wants to know what rigid bodies give
      Given* given;
      double mass(int f, int node) const { return s->state[f].data()[node].momentum[3]; }
      Vec3 get(int f, int node) const {
        Lanes4 const& v = s->state[f].data()[node].momentum;
        return {v[0], v[1], v[2]};
      }
      void set(int f, int node, Vec3 const& v) const {
        NodeState& r = s->state[f].data()[node];
        for (int d = 0; d < 3; ++d) {
          double const change = v[d] - r.momentum[d];
          r.force[d] += change;
          r.momentum[d] = v[d];
          if (weights == nullptr) continue;
          // Between two bodies that are not rigid these cancel.
          double const impulse = weights[node] * r.momentum[3] * change;
          given->impulse[d] += impulse;
          if (Vec3 const* pusher = rigid_at(node)) given->work += impulse * (*pusher)[d];
        }
      }
      /// Velocity of the rigid body that reaches the node, or null.
      Vec3 const* rigid_at(int node) const {
        for (std::size_t g = 0; g < rigid->size(); ++g) {
          if ((*rigid)[g] && s->present[g] != 0 && mass(static_cast<int>(g), node) > 0.0) return &*(*rigid)[g];
        }
        return nullptr;
      }
      NodeVelocity const& gradient(int f, int node) const { return s->gradient[f].data()[node]; }
      double extent(int f, int node) const { return s->extent[f].data()[node]; }
    };
    double const* weights = w.node_weight[block].empty() ? nullptr : w.node_weight[block].data();
    make_compatible({count, w.fields, w.mass_floor, &scratch.present, &w.laws, &w.rigid, &w.slips},
                    Access{&scratch, &w.rigid, weights, &given});
  }
  for (int f = 0; f < w.fields; ++f) {
    scratch.halts[f] = scratch.present[f] != 0 && !w.rigid[f] && w.slips[f] == 0 && !w.holds[block].empty() ? 1 : 0;
    if (scratch.halts[f] == 0) continue;
    NodeVelocity* halt = scratch.halt[f].get(count);
    std::fill(halt, halt + count, NodeVelocity{});
  }
  for (Hold const& hold : w.holds[block]) {
    for (int f = 0; f < w.fields; ++f) {
      if (scratch.present[f] == 0 || w.rigid[f] || !w.held(f, hold)) continue;
      NodeState& r = scratch.state[f].data()[hold.node];
      double const m = r.momentum[3];
      if (!(m > w.mass_floor)) continue;
      NodeVelocity& halt = scratch.halt[f].data()[hold.node];
      for (int d = 0; d < 3; ++d) {
        if (!hold.held[d]) continue;
        double const change = hold.velocity[d] - r.momentum[d];
        given.impulse[d] += hold.weight * m * change;
        given.work += hold.weight * m * change * hold.velocity[d];
        r.force[d] += change;
        r.momentum[d] = hold.velocity[d];
        // `force` is the whole change of the step, the one against the start of the step.
        given.drive += hold.weight * m * (r.force[d] - halt[d]) * hold.velocity[d];
        halt[d] = r.force[d];
      }
      // What slips along the body stays at its surface.
      for (int g = 0; g < w.fields; ++g) {
        if (!w.slips_along(g, f) || scratch.present[g] == 0) continue;
        NodeState& fluid = scratch.state[g].data()[hold.node];
        double const mass = fluid.momentum[3];
        Vec3 const change = follow(w.mass_floor, scratch.gradient[f].data()[hold.node], r.momentum, fluid.momentum);
        for (int d = 0; d < 3; ++d) {
          fluid.force[d] += change[d];
          fluid.momentum[d] += change[d];
          given.impulse[d] += hold.weight * mass * change[d];
          given.work += hold.weight * mass * change[d] * r.momentum[d];
        }
      }
    }
  }
  w.impulse[block] = given.impulse;
  w.work[block] = given.work;
  w.dissipation[block] = {given.drive, 0.0};
}

void Mpm::update_set(int block, int body, Hoops const& hoops, double dt, Scratch& scratch) {
  Workspace& w = *work_;
  PointSet& set = points(block, body);
  if (set.empty()) return;
  double fastest = 0.0;
  if (bodies_[body].rigid_velocity) {
    fastest = norm(*bodies_[body].rigid_velocity);
  } else {
    SetView const view{&set, &bodies_[body], &w.patches[block], grid_.domain().h};
    with_kernels(options_.shape, view.patch->dimensions, [&](auto kernels) {
      fastest = kernels.update(view, options_, hoops, time_, dt, scratch.velocity[w.field_of[body]].data(), scratch);
    });
  }
  signals_[block] = std::max(signals_[block], signal_weight(body) * fastest);
}

void Mpm::update_stress(double dt) {
  bool const first = options_.order == StressOrder::usf;
  if (!first && !work_->maps_back) return;  // `integrate` did it, while the nodes were at hand
  PhaseTimer const timer(timings_["strain and stress"]);
  Workspace& w = *work_;
  int const bodies = static_cast<int>(bodies_.size());
  Hoops const hoops = hoops_of(grid_.domain().geometry);
  parallel_for(static_cast<int>(active_.size()), [&](int n, int thread) {
    int const block = active_[n];
    Scratch& scratch = w.scratch[thread];
    if (first) {
      velocity_from_state(block, scratch);
    } else {
      gather_velocity(block, scratch);
    }
    if (w.contact) {
      gather_gradients(block, scratch);
      if (w.touches) gather_extents(block, scratch);
    }
    constrain_velocity(block, scratch);
    if (first) signals_[block] = 0.0;
    for (int body = 0; body < bodies; ++body) {
      if (order_of(body) != StressOrder::usl) update_set(block, body, hoops, dt, scratch);
    }
  });
}

void Mpm::velocity_from_state(int block, Scratch& scratch) const {
  Workspace const& w = *work_;
  int const count = w.patches[block].count();
  for (int f = 0; f < w.fields; ++f) {
    scratch.present[f] = w.gather(w.state, block, f, scratch.state[f]) ? 1 : 0;
    if (scratch.present[f] == 0) continue;
    NodeState const* nodes = scratch.state[f].data();
    NodeVelocity* to = scratch.velocity[f].get(count);
    for (int node = 0; node < count; ++node) {
      Lanes4 const& p = nodes[node].momentum;
      double const inverse = p[3] > w.mass_floor ? 1.0 / p[3] : 0.0;
      to[node] = p * Lanes4{inverse, inverse, inverse, 1.0};
    }
  }
}

}  // namespace brisance::mpm
