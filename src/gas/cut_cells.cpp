#include "gas/cut_cells.hpp"

#include <algorithm>
#include <cmath>

namespace brisance::gas {

namespace {

/// Cells smaller than this part of a whole one are merged with neighbours until they are as large together: with the
/// default Courant number of 0.8 a wave then crosses one cell at most.
constexpr double large_enough = 0.8;
/// Most members of a merger.
constexpr std::size_t most_members = 8;

/// The open volume and areas of a cut cell, and its wall.
CutCell measured(grid::Domain const& domain, shape::CutCell const& cut) {
  int const i = cut.cell[0];
  CutCell cell;
  cell.cell = cut.cell;
  cell.volume = cut.open * domain.cell_volume(i);
  for (int face = 0; face < 2 * domain.dimensions(); ++face)
    cell.area[face] = cut.open_faces[face] * domain.face_area(face / 2, i + (face == 1 ? 1 : 0));
  for (int d = 0; d < domain.dimensions(); ++d) cell.wall[d] = cell.area[2 * d + 1] - cell.area[2 * d];
  // The faces of a ring or shell open outwards without any wall: the part of what they surround counts.
  if (grid::radial_exponent(domain.geometry) > 0) {
    double const part = domain.geometry == grid::Geometry::spherical1d ? cut.open : cut.open_section;
    cell.wall[0] -= part * (domain.face_area(0, i + 1) - domain.face_area(0, i));
  }
  return cell;
}

}  // namespace

int CutCells::node_at(grid::Cell const& cell) const {
  if (!in(cell.block)) return -1;
  return of_block_[cell.block].numbers[cell.offset];
}

CutCell const* CutCells::find(grid::Cell const& cell) const {
  int const node = node_at(cell);
  int const cut = node < 0 ? -1 : nodes_[node].cut;
  return cut < 0 ? nullptr : &cells_[cut];
}

double CutCells::volume(grid::Cell const& cell) const {
  CutCell const* const found = find(cell);
  return found == nullptr ? grid_->block(cell).volume(cell) : found->volume;
}

double CutCells::area(grid::Cell const& cell, int direction, int side) const {
  CutCell const* const found = find(cell);
  return found == nullptr ? grid_->block(cell).face_area(direction, side, cell) : found->area[2 * direction + side];
}

CutCell const* CutCells::find(Index3 const& cell) const {
  auto const found = number_.find(domain().all_cells().offset(cell));
  return found == number_.end() ? nullptr : &cells_[found->second];
}

double CutCells::open_area(Index3 const& cell, int face) const {
  if (auto const* cut = find(cell)) return cut->area[face];
  return domain().face_area(face / 2, cell[0] + (face == 1 ? 1 : 0));
}

double CutCells::open_volume(Index3 const& cell) const {
  if (auto const* cut = find(cell)) return cut->volume;
  return domain().cell_volume(cell[0]);
}

CutCells::Group CutCells::group_of(std::size_t number, IsSolid const& is_solid) const {
  grid::Domain const& domain = this->domain();
  CutCell const& cut = cells_[number];
  double const wanted = large_enough * domain.cell_volume(cut.cell[0]);
  double const size = std::max(norm(cut.wall), 1e-300);
  Group group{number, {}, 0.0};
  std::vector<Index3> reached{cut.cell};
  double others = 0.0;
  while (cut.volume + others < wanted && reached.size() < most_members) {
    Index3 best{0, 0, 0};
    double most = 0.0;
    for (Index3 const& from : reached) {
      for (int face = 0; face < 2 * domain.dimensions(); ++face) {
        int const d = face / 2;
        Index3 beside = grid::beside(from, d, face % 2);
        if (!domain.contains(beside)) {
          if (domain.boundary[face] != grid::Boundary::periodic) continue;
          beside = grid::image_cell(domain, beside);
        }
        if (is_solid(beside)) continue;
        if (std::find(reached.begin(), reached.end(), beside) != reached.end()) continue;
        double const whole = std::max(domain.face_area(d, from[0] + (face == 1 ? 1 : 0)), 1e-300);
        double const open = open_area(from, face) / whole;
        if (!(open > 0.0)) continue;
        // Away from the wall first, through a wide face, to a large cell.
        double const away = std::max(0.0, (face % 2 == 0 ? -1.0 : 1.0) * cut.wall[d] / size);
        double const value = (0.1 + away) * open * open_volume(beside);
        if (value > most) {
          most = value;
          best = beside;
        }
      }
    }
    if (most <= 0.0) break;
    reached.push_back(best);
    group.members.push_back(best);
    others += open_volume(best);
  }
  if (others > 0.0) group.weight = std::min(1.0, (wanted - cut.volume) / others);
  return group;
}

std::vector<CutCells::Group> CutCells::groups(IsSolid const& is_solid) const {
  std::vector<Group> all;
  for (std::size_t n = 0; n < cells_.size(); ++n) {
    if (cells_[n].volume >= large_enough * domain().cell_volume(cells_[n].cell[0])) continue;
    Group group = group_of(n, is_solid);
    if (!group.members.empty()) all.push_back(std::move(group));
  }
  return all;
}

void CutCells::make_nodes(std::vector<Group> const& groups) {
  grid::CellRange const all = domain().all_cells();
  auto const add = [&](Index3 const& index, int cut) {
    Node node;
    node.cell = locate(index);
    node.volume = open_volume(index);
    node.cut = cut;
    nodes_.push_back(node);
  };
  std::unordered_map<std::size_t, bool> known;
  for (std::size_t n = 0; n < cells_.size(); ++n) add(cells_[n].cell, static_cast<int>(n));
  for (Group const& group : groups) {
    for (Index3 const& member : group.members) {
      std::size_t const place = all.offset(member);
      if (number_.contains(place) || !known.emplace(place, true).second) continue;
      add(member, -1);
    }
  }
  std::sort(nodes_.begin(), nodes_.end(), [](Node const& a, Node const& b) {
    return a.cell.block != b.cell.block ? a.cell.block < b.cell.block : a.cell.offset < b.cell.offset;
  });
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    node_of_[all.offset(grid_->index(nodes_[n].cell))] = static_cast<int>(n);
    std::vector<int>& numbers = of_block_[nodes_[n].cell.block].numbers;
    if (numbers.empty()) numbers.assign(grid_->block(nodes_[n].cell).cell_count(), -1);
    numbers[nodes_[n].cell.offset] = static_cast<int>(n);
    auto const number = static_cast<int>(n);
    if (n == 0 || nodes_[n].cell.block != nodes_[n - 1].cell.block) ranges_.emplace_back(number, number);
    ranges_.back().second = number + 1;
  }
}

void CutCells::make_mergers(std::vector<Group> const& groups) {
  grid::CellRange const all = domain().all_cells();
  // What small cells ask of each node: no more than all of it.
  std::vector<double> asked(nodes_.size(), 0.0);
  for (Group const& group : groups) {
    for (Index3 const& member : group.members) asked[node_of_.at(all.offset(member))] += group.weight;
  }
  for (Group const& group : groups) {
    Merger merger;
    merger.node = node_of_.at(all.offset(cells_[group.cut].cell));
    merger.first = static_cast<int>(members_.size());
    auto const number = static_cast<int>(mergers_.size());
    members_.push_back({merger.node, number, std::max(0.0, 1.0 - asked[merger.node])});
    for (Index3 const& member : group.members) {
      int const node = node_of_.at(all.offset(member));
      members_.push_back({node, number, group.weight / std::max(1.0, asked[node])});
    }
    merger.end = static_cast<int>(members_.size());
    mergers_.push_back(merger);
  }
  shares_ = members_;
  for (Merger const& merger : mergers_) {
    double volume = 0.0;
    for (int n = merger.first; n < merger.end; ++n) {
      members_[n].weight *= nodes_[members_[n].node].volume;
      volume += members_[n].weight;
    }
    for (int n = merger.first; n < merger.end; ++n) members_[n].weight /= volume;
  }
  std::stable_sort(shares_.begin(), shares_.end(), [](Share const& a, Share const& b) { return a.node < b.node; });
  for (int n = 0; n < static_cast<int>(shares_.size()); ++n) {
    Node& node = nodes_[shares_[n].node];
    if (node.end == 0) node.first = n;
    node.end = n + 1;
  }
}

void CutCells::find_bundles() {
  for (auto const& [first, end] : ranges_) {
    grid::Block const& block = grid_->block(nodes_[first].cell);
    for (int d = 0; d < domain().dimensions(); ++d) {
      grid::Bundles const bundles(block, d, bundle_cells_);
      std::vector<std::vector<InBundle>> lists(bundles.count());
      for (int n = first; n < end; ++n) {
        int const bundle = bundles.index_of(nodes_[n].cell);
        lists[bundle].push_back({bundles.layout(bundle).place(block, nodes_[n].cell), n, nodes_[n].cut});
      }
      OfBundles& of = of_block_[block.number].in_bundles[d];
      for (auto const& list : lists) {
        of.first.push_back(static_cast<int>(of.nodes.size()));
        of.nodes.insert(of.nodes.end(), list.begin(), list.end());
      }
      of.first.push_back(static_cast<int>(of.nodes.size()));
    }
  }
}

void CutCells::find_boundaries() {
  grid::Domain const& domain = this->domain();
  for (CutCell const& cut : cells_) {
    for (int face = 0; face < 2 * domain.dimensions(); ++face) {
      if (!domain.contains(grid::beside(cut.cell, face / 2, face % 2)))
        of_block_[locate(cut.cell).block].boundary[face] = true;
    }
  }
}

void CutCells::set(std::vector<shape::CutCell> const& cells, int level, IsSolid const& is_solid, int components) {
  cells_.clear();
  level_ = level;
  for (shape::CutCell const& cut : cells) cells_.push_back(measured(domain(), cut));
  if (cells_.empty()) return;
  // By blocks, as sweeps come to them: what is read one after the other lies so.
  std::sort(cells_.begin(), cells_.end(), [this](CutCell const& a, CutCell const& b) {
    grid::Cell const at = locate(a.cell);
    grid::Cell const behind = locate(b.cell);
    return at.block != behind.block ? at.block < behind.block : at.offset < behind.offset;
  });
  grid::CellRange const all = domain().all_cells();
  of_block_.resize(grid_->blocks().size());
  for (std::size_t n = 0; n < cells_.size(); ++n) number_[all.offset(cells_[n].cell)] = n;
  std::vector<Group> const asked = groups(is_solid);
  make_nodes(asked);
  make_mergers(asked);
  find_bundles();
  find_boundaries();
  pitch_ = (static_cast<std::size_t>(components) + line - 1) / line * line;
  states_ = Buffer(nodes_.size() * pitch_);
  merged_ = Buffer(mergers_.size() * pitch_);
  walls_.resize(cells_.size());
  quiescent_.assign(cells_.size(), 1);
  for (CutCell const& cell : cells_)
    flows_.push_back({1.0 / cell.volume, cell.area, cell.area[1] - cell.area[0] - cell.wall[0]});
}

}  // namespace brisance::gas
