/// Cut cells in a step of the gas: the state beside their walls, what a sweep changes in them, and how small ones share
/// their state with neighbours. See cut_cells.hpp.
#include <algorithm>
#include <cmath>

#include "core/loops.hpp"
#include "core/parallel.hpp"
#include "gas/gas.hpp"
#include "gas/primitives.hpp"

namespace brisance::gas {

namespace {

/// Partial densities and volume fractions may leave their range by round-off.
constexpr double round_off = 1e-12;

/// Nodes or mergers that a thread takes at a time: fewer are done sooner than handed out.
constexpr int batch = 512;

/// What is asked of a state.
struct Judged {
  bool sound = false;
  double pressure = 0.0;
  double sound_speed = 0.0;
};

/// Of one ideal gas alone.
Judged judge_ideal(material::IdealGas const& gas, Floors const& floors, double const* u, bool with_sound) {
  Judged judged;
  double const rho = u[partial_density(0)];
  double const square = u[momentum_x] * u[momentum_x] + u[momentum_y] * u[momentum_y] + u[momentum_z] * u[momentum_z];
  judged.pressure = (gas.gamma - 1.0) * (u[energy] - 0.5 * square / rho);
  if (with_sound) judged.sound_speed = std::sqrt(std::max(0.0, gas.gamma * judged.pressure) / rho);
  judged.sound = rho >= 0.999999 * floors.density && judged.pressure >= 0.999999 * floors.pressure;
  return judged;
}

Judged judge(Fluids const& fluids, Floors const& floors, double most_H, double const* u, double F,
             bool with_sound = true) {
  if (!fluids.mixed()) {
    auto const* ideal = std::get_if<material::IdealGas>(&fluids.ambient());
    if (ideal != nullptr) return judge_ideal(*ideal, floors, u, with_sound);
  }
  Judged judged;
  double const rho = mixture_density(fluids.count, [u](int c) { return u[c]; });
  double square = 0.0;
  for (int d = 0; d < 3; ++d) square += u[momentum_x + d] * u[momentum_x + d];
  Mixture const m = mixture(fluids, partial_densities(fluids.count, u), volume_fractions(fluids.count, u), F);
  judged.pressure = m.pressure(u[energy] - 0.5 * square / rho);
  judged.sound_speed = std::sqrt(std::max(0.0, m.bulk_modulus(judged.pressure)) / rho);
  judged.sound = is_sound(floors, most_H, rho, judged.pressure, m.xi, m.H);
  double rest = 1.0;
  for (int k = 1; k < fluids.count; ++k) {
    double const alpha = u[volume_fraction(k)];
    judged.sound = judged.sound && u[partial_density(k)] >= -round_off * rho && alpha >= -round_off;
    rest -= alpha;
  }
  judged.sound = judged.sound && u[partial_density(0)] >= -round_off * rho && rest >= -round_off;
  return judged;
}

/// Pressure of gas that is stopped at a wall [Pa], as HLLC has it between a state and its mirror image.
double stopped(double rho, double p, double c, double speed_into_wall, bool bears_tension) {
  double const w = speed_into_wall;
  double const slowest = w > 0.0 ? w + c : c - w;
  double const star = p + rho * w * (w + slowest);
  return bears_tension ? star : std::max(star, 0.0);
}

}  // namespace

void Gas::load_node(int n) {
  grid::Cell const& cell = cut.nodes()[n].cell;
  for (int c = 0; c < components(); ++c) cut.state(n)[c] = c == shock ? 0.0 : fields_.at(cell.block, c)[cell.offset];
}

void Gas::load_nodes() {
  parallel_for(static_cast<int>(cut.nodes().size()), [&](int n, int) { load_node(n); });
}

void Gas::note_change(grid::Cell const& cell) {
  disturbance_.note(cell);
  if (int const node = cut.node_at(cell); node >= 0) load_node(node);
}

bool Gas::is_quiescent(double const* state) const {
  for (int c = 0; c < components(); ++c) {
    if (c != shock && state[c] != quiet_.state[c]) return false;
  }
  return true;
}

void Gas::find_wall(Node const& node, double const* u) {
  bool const quiescent = norm(quiescent_.velocity) == 0.0 && is_quiescent(u);
  cut.quiescent(node.cut) = quiescent ? 1 : 0;
  if (quiescent) return;
  WallState& wall = cut.wall(node.cut);
  CutCell const& cell = cut.cells()[node.cut];
  double const rho = mixture_density(fluids_.count, [u](int c) { return u[c]; });
  Floors const floors{options_.density_floor, options_.pressure_floor};
  Judged const gas = judge(fluids_, floors, most_H(), u, burn_fraction(*this, node.cell));
  Vec3 velocity{u[momentum_x] / rho, u[momentum_y] / rho, u[momentum_z] / rho};
  double const area = norm(cell.wall);
  double into_wall = 0.0;
  if (area > 0.0) {
    Vec3 const normal = (1.0 / area) * cell.wall;
    into_wall = -dot(velocity, normal);
    velocity = velocity + into_wall * normal;
  }
  wall.velocity = velocity;
  wall.pressure = stopped(rho, gas.pressure, gas.sound_speed, into_wall, fluids_.any_bears_tension());
  wall.partial = partial_densities(fluids_.count, u);
  wall.enthalpy = u[energy] + gas.pressure;
  wall.progress = components() > progress ? u[progress] : 0.0;
}

void Gas::find_walls() {
  auto const& nodes = cut.nodes();
  int const count = static_cast<int>(nodes.size());
  parallel_for((count + batch - 1) / batch, [&](int part, int) {
    for (int n = part * batch; n < std::min(count, (part + 1) * batch); ++n) {
      if (nodes[n].cut >= 0 && awake_[nodes[n].cell.block] != 0) find_wall(nodes[n], cut.state(n));
    }
  });
}

/// Through the wall of a cut cell, per area along a direction.
Components Gas::wall_flux(int cut_cell, int d) {
  if (cut.quiescent(cut_cell) != 0) return quiet_.flux[d];
  WallState const& wall = cut.wall(cut_cell);
  Components flux{};
  double const speed = wall.velocity[d];
  for (int k = 0; k < fluids_.count; ++k) flux[partial_density(k)] = speed * wall.partial[k];
  double const mass = mixture_density(fluids_.count, flux);
  for (int i = 0; i < 3; ++i) flux[momentum_x + i] = mass * wall.velocity[i];
  flux[momentum_x + d] += wall.pressure;
  flux[energy] = speed * wall.enthalpy;
  if (components() > progress) flux[progress] = speed * wall.progress;
  return flux;
}

void Gas::announce_nodes(int b, int direction, int index) {
  for (CutCells::InBundle const& node : cut.in_bundle(b, direction, index)) {
    for (int l = 0; l < cut.lines(); ++l) __builtin_prefetch(cut.state(node.node) + l * CutCells::line, 1, 2);
    if (node.cut < 0) continue;
    __builtin_prefetch(&cut.flow(node.cut), 0, 2);
    __builtin_prefetch(&cut.wall(node.cut), 0, 2);
  }
}

void Gas::take_cut_changes(int b, int index, BundleLayout const& layout, SweepContext const& s, BundleArrays& a) {
  auto const list = cut.in_bundle(b, s.direction, index);
  if (list.empty()) return;
  int const d = s.direction;
  int const st = layout.stride;
  for (CutCells::InBundle const& node : list) {
    if (node.cut < 0) continue;
    int const q = node.q;
    CutFlow const& cell = cut.flow(node.cut);
    double* const change = cut.state(node.node);
    double const scale = s.dt * cell.inverse_volume;
    double const high = scale * cell.area[2 * d + 1];
    double const low = scale * cell.area[2 * d];
    double const at_wall = high - low - (d == 0 ? scale * cell.opening : 0.0);
    // Fluxes count by their difference to one of them: uniform gas then stays as it is to the last bit.
    auto const take = [&](int c, double own, double least) {
      double const* const flux = a[flux_array(c)];
      change[c] = low * (flux[q - st] - least) - high * (flux[q] - least) + at_wall * (own - least);
    };
    Components const own = wall_flux(node.cut, d);
    for (int c = 0; c <= energy; ++c) take(c, own[c], s.radial ? 0.0 : own[c]);
    if (s.radial) take(s.normal(), own[s.normal()], a[a_p_half][q]);
    for (int k = 1; k < fluids_.count; ++k) {
      int const partial = partial_density(k);
      int const c = volume_fraction(k);
      if (s.present <= k) {
        change[partial] += at_wall * own[partial];
        continue;
      }
      take(partial, own[partial], s.radial ? 0.0 : own[partial]);
      double const alpha = a[c][q];
      change[c] = low * (a[a_flux + c][q - st] - alpha * a[a_face_speed][q - st]) -
                  high * (a[a_flux + c][q] - alpha * a[a_face_speed][q]);
    }
    if (components() > progress) {
      if (s.progress)
        take(progress, own[progress], s.radial ? 0.0 : own[progress]);
      else
        change[progress] += at_wall * own[progress];
    }
    a[a_solid][q] = 1.0;  // the update leaves it alone
  }
}

void Gas::take_node_states(int b, int index, SweepContext const& s, BundleArrays& a) {
  for (CutCells::InBundle const& node : cut.in_bundle(b, s.direction, index)) {
    int const q = node.q;
    double* const state = cut.state(node.node);
    bool const is_cut = node.cut >= 0;
    auto const take = [&](int c) { state[c] = a[state_array(c)][q] + (is_cut ? state[c] : 0.0); };
    for (int c = 0; c <= energy; ++c) take(c);
    for (int k = 1; k < s.present; ++k) {
      take(partial_density(k));
      take(volume_fraction(k));
    }
    if (s.progress) take(progress);
  }
}

void Gas::keep_peaks(int b, int index, SweepContext const& s, BundleArrays& a) const {
  for (CutCells::InBundle const& node : cut.in_bundle(b, s.direction, index)) a[a_p][node.q] = quiet_.pressure;
}

void Gas::merge_small_cells() {
  auto const& members = cut.members();
  int const count = static_cast<int>(cut.mergers().size());
  parallel_for((count + batch - 1) / batch, [&](int part, int) {
    for (int m = part * batch; m < std::min(count, (part + 1) * batch); ++m) {
      constexpr int ahead = 8;
      if (m + ahead < count) {
        Merger const& next = cut.mergers()[m + ahead];
        for (int n = next.first; n < next.end; ++n) __builtin_prefetch(cut.state(members[n].node));
      }
      Merger const& merger = cut.mergers()[m];
      double* const mean = cut.merged(m);
      double const* const own = cut.state(merger.node);
      // From the differences to the small cell: equal states stay equal to the last bit.
      for (int l = 0; l < cut.lines(); ++l) {
        int const first = l * CutCells::line;
        std::array<double, CutCells::line> sum{};
        for (int n = merger.first; n < merger.end; ++n) {
          double const* const state = cut.state(members[n].node) + first;
          BRISANCE_VECTOR_LOOP
          for (int c = 0; c < CutCells::line; ++c) sum[c] += members[n].weight * (state[c] - own[first + c]);
        }
        BRISANCE_VECTOR_LOOP
        for (int c = 0; c < CutCells::line; ++c) mean[first + c] = sum[c] + own[first + c];
      }
    }
  });
}

void Gas::share_states(int begin, int end, SweepContext const& s, bool last, std::vector<int>& unsound) {
  int const dims = grid_->domain().dimensions();
  int const b = cut.nodes()[begin].cell.block;
  int const count = components();
  bool const burning = burn.burning_in(b);
  std::array<double*, most_components> fields{};
  for (int c = 0; c < count; ++c) fields[c] = fields_.at(b, c);
  for (int n = begin; n < end; ++n) {
    constexpr int ahead = 8;
    if (n + ahead < end) {
      Node const& next = cut.nodes()[n + ahead];
      for (int c = 0; c < count; ++c) {
        if (c != shock) __builtin_prefetch(fields[c] + next.cell.offset, 1);
      }
      for (int i = next.first; i < next.end; ++i) __builtin_prefetch(cut.merged(cut.shares()[i].merger));
      if (last) peaks_.announce(next.cell);
    }
    Node const& node = cut.nodes()[n];
    double* const state = cut.state(n);
    for (int l = 0; l < cut.lines() && node.end > node.first; ++l) {
      int const first = l * CutCells::line;
      std::array<double, CutCells::line> change{};
      for (int i = node.first; i < node.end; ++i) {
        Share const& share = cut.shares()[i];
        double const* const mean = cut.merged(share.merger) + first;
        BRISANCE_VECTOR_LOOP
        for (int c = 0; c < CutCells::line; ++c) change[c] += share.weight * (mean[c] - state[first + c]);
      }
      BRISANCE_VECTOR_LOOP
      for (int c = 0; c < CutCells::line; ++c) state[first + c] += change[c];
    }
    bool const quiet = is_quiescent(state);
    if (quiet && awake_[b] == 0) continue;
    store_node(n);
    double pressure = quiet_.pressure;
    if (!quiet) {
      awake_[b] = 1;
      disturbance_.note(node.cell);
      Judged const gas =
          judge(fluids_, s.floors, s.most_H, state, burning ? burn_fraction(*this, node.cell) : 1.0, last);
      if (!gas.sound) unsound.push_back(n);
      pressure = gas.pressure;
      if (last && gas.sound) {
        double const rho = mixture_density(fluids_.count, [state](int c) { return state[c]; });
        double flow = 0.0;
        for (int d = 0; d < dims; ++d) flow = std::max(flow, std::abs(state[momentum_x + d]) / rho);
        blocks_[b].signal = std::max(blocks_[b].signal, flow + gas.sound_speed);
      }
    }
    if (last) peaks_.follow(node.cell, pressure - quiet_.pressure, s.dt);
  }
}

void Gas::store_node(int n) {
  grid::Cell const& cell = cut.nodes()[n].cell;
  double const* const state = cut.state(n);
  for (int c = 0; c < components(); ++c) {
    if (c != shock) fields_.at(cell.block, c)[cell.offset] = state[c];
  }
}

void Gas::share_small_cells(SweepContext const& s, bool last) {
  merge_small_cells();
  auto const& ranges = cut.ranges();
  std::vector<std::vector<int>> unsound(ranges.size());
  parallel_for(static_cast<int>(ranges.size()),
               [&](int part, int) { share_states(ranges[part].first, ranges[part].second, s, last, unsound[part]); });
  for (auto const& part : unsound) {
    for (int const n : part) mend(n, s);
  }
}

void Gas::mend(int n, SweepContext const& s) {
  grid::Domain const& domain = grid_->domain(cut.level());
  Node const& node = cut.nodes()[n];
  // The cell and those that its open faces lead to.
  std::vector<grid::Cell> cells{node.cell};
  Index3 const index = grid_->index(node.cell);
  for (int face = 0; face < 2 * domain.dimensions(); ++face) {
    if (!(cut.area(node.cell, face / 2, face % 2) > 0.0)) continue;
    Index3 const beside = grid::beside(index, face / 2, face % 2);
    Index3 const image = grid::image_cell(domain, beside);
    if (image == index || obstacles.contain(cut.level(), image)) continue;
    if (beside != image && domain.boundary[face] != grid::Boundary::periodic) continue;
    if (auto const at = grid_->locate(cut.level(), image)) cells.push_back(*at);
  }
  double volume = 0.0;
  Components mean{};
  std::vector<Components> states;
  for (grid::Cell const& cell : cells) {
    Components u{};
    for (int c = 0; c < components(); ++c) u[c] = fields_.at(cell.block, c)[cell.offset];
    for (int c = 0; c < components(); ++c) mean[c] += cut.volume(cell) * u[c];
    volume += cut.volume(cell);
    states.push_back(u);
  }
  for (double& value : mean) value /= volume;
  auto const blended = [&](Components const& u, double theta) {
    Components x = u;
    for (int c = 0; c < components(); ++c) {
      if (c != shock) x[c] = u[c] + theta * (mean[c] - u[c]);
    }
    return x;
  };
  auto const is_sound_at = [&](double theta) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      Components const x = blended(states[i], theta);
      if (!judge(fluids_, s.floors, s.most_H, x.data(), burn_fraction(*this, cells[i])).sound) return false;
    }
    return true;
  };
  double theta = 1.0;
  if (is_sound_at(1.0)) {
    double low = 0.0;
    constexpr int bisections = 20;
    for (int i = 0; i < bisections; ++i) {
      double const middle = 0.5 * (low + theta);
      (is_sound_at(middle) ? theta : low) = middle;
    }
  }
  ++blocks_[node.cell.block].account.fallback_faces;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    Components const x = blended(states[i], theta);
    for (int c = 0; c < components(); ++c) fields_.at(cells[i].block, c)[cells[i].offset] = x[c];
    awake_[cells[i].block] = 1;
    disturbance_.note(cells[i]);
    int const number = cut.node_at(cells[i]);
    if (number >= 0) load_node(number);
  }
}

}  // namespace brisance::gas
