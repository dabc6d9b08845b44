#include "shape/cut_cells.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "core/parallel.hpp"
#include "shape/open_face.hpp"
#include "shape/parts.hpp"

namespace brisance::shape {

namespace {

/// Parts of a cell per direction in which is looked for pieces of gas.
int parts_of(int dimensions) { return dimensions == 3 ? 10 : 16; }

/// Lines through a cell in each direction that look for a small open corner, and how much of the cell it has at least
/// for what it opens of a face, where they find less.
constexpr int corner_lines = 48;
constexpr double corner_part = 1e-3;

using Numbers = std::unordered_map<std::size_t, std::size_t>;

/// The largest piece of the gas in a cell that bodies part.
struct Piece {
  bool parted = false;
  double volume = 1.0;  ///< fraction of what is open
  /// Along each face, part by part: 2 where this piece lies, 1 where another does, else 0.
  std::array<std::vector<std::uint8_t>, 6> faces;
};

/// The largest piece of the gas in a cell. Pieces without a free part are too small to count: what is open of faces
/// beside them is closed.
Piece largest_piece(std::vector<Shape> const& shapes, grid::Domain const& domain, Index3 const& cell) {
  int const p = parts_of(domain.dimensions());
  grid::Domain fine = domain;
  fine.h /= p;
  Parts const parts = parts_of_cell(shapes, fine, cell, p);
  Pieces const pieces = pieces_of(parts);
  int const largest = pieces.largest();
  int const all = std::accumulate(pieces.size.begin(), pieces.size.end(), 0);
  Piece piece;
  piece.parted = true;
  piece.volume = all > 0 ? static_cast<double>(pieces.size[largest]) / all : 0.0;
  for (std::size_t at = 0; at < pieces.number.size(); ++at) {
    for (int face = 0; face < 2 * domain.dimensions(); ++face) {
      if (parts.box.at(at)[face / 2] != (face % 2 == 0 ? 0 : p - 1)) continue;
      int const number = pieces.number[at];
      piece.faces[face].push_back(number == 0 ? 0 : number == largest ? 2 : 1);
    }
  }
  return piece;
}

/// The part of a face's opening that the pieces on its two sides have in common; `other` is null where the cell there
/// is not parted.
double common_part(std::vector<std::uint8_t> const& own, std::vector<std::uint8_t> const* other) {
  int any = 0;
  int common = 0;
  for (std::size_t n = 0; n < own.size(); ++n) {
    bool const here = own[n] == 2 && (other == nullptr || (*other)[n] == 2);
    any += own[n] != 0 || (other != nullptr && (*other)[n] != 0) ? 1 : 0;
    common += here ? 1 : 0;
  }
  return any > 0 ? static_cast<double>(common) / any : 0.0;
}

/// Finds the geometry of a domain, step by step.
class Cutter {
 public:
  Cutter(std::vector<Shape> const& shapes, grid::Domain const& domain, grid::CellRange const& range)
      : shapes_(shapes), domain_(domain), all_(grid::common(range, domain.all_cells())), bodies_(shapes, domain) {}

  CutGeometry run() {
    find_cells();
    find_corners();
    measure_faces();
    keep_largest_pieces();
    close_solid();
    collect();
    return std::move(result_);
  }

 private:
  /// Solid cells and those that surfaces cut, with their open volumes.
  void find_cells() {
    result_.range = all_;
    result_.solid.assign(all_.count(), 0);
    int const last = domain_.dimensions() - 1;
    constexpr int thickness = 8;
    int const slabs = (all_.n(last) + thickness - 1) / thickness;
    std::vector<std::vector<CutCell>> found(slabs);
    grid::Metric flat = domain_;
    flat.geometry = domain_.dimensions() == 1 ? grid::Geometry::planar1d : grid::Geometry::planar2d;
    bool const radial = grid::radial_exponent(domain_.geometry) > 0;
    parallel_for(slabs, [&](int n, int) {
      CellRange slab = all_;
      slab.lower[last] = all_.lower[last] + n * thickness;
      slab.upper[last] = std::min(all_.upper[last], slab.lower[last] + thickness);
      for_each_share(shapes_, domain_, slab, [&](CellRange const& r, std::vector<Share> const& shares) {
        double const open = 1.0 - sum_of(shares);
        if (open < least_open) {
          for_each_cell(r, [&](Index3 const& cell) { result_.solid[all_.offset(cell)] = 1; });
          return true;
        }
        CutCell cut;
        cut.cell = r.lower;
        cut.open = open;
        cut.open_section = radial ? 1.0 - sum_of(shares_of_cell(shapes_, flat, r.lower)) : open;
        found[n].push_back(cut);
        return true;
      });
    });
    for (auto const& part : found) cells_.insert(cells_.end(), part.begin(), part.end());
    for (std::size_t n = 0; n < cells_.size(); ++n) number_[all_.offset(cells_[n].cell)] = n;
  }

  /// Cells in the corners of which a surface leaves so little open that the lines through the cell have missed it:
  /// their faces tell. Closed, they would tilt the walls of their neighbours.
  void find_corners() {
    for (std::size_t n = 0; n < cells_.size(); ++n) {
      for (int face = 0; face < 2 * domain_.dimensions(); ++face) {
        Index3 const beside = grid::beside(cells_[n].cell, face / 2, face % 2);
        if (!is_solid(beside)) continue;
        double const open = bodies_.open_face(face % 2 == 0 ? cells_[n].cell : beside, face / 2);
        if (open == 0.0) continue;
        result_.solid[all_.offset(beside)] = 0;
        CutCell corner;
        corner.cell = beside;
        corner.open =
            std::max(corner_part * open, 1.0 - sum_of(shares_of_cell(shapes_, domain_, beside, corner_lines)));
        corner.open_section = corner.open;
        number_[all_.offset(beside)] = cells_.size();
        cells_.push_back(corner);
      }
    }
  }

  [[nodiscard]] bool is_solid(Index3 const& cell) const {
    return all_.contains(cell) && result_.solid[all_.offset(cell)] != 0;
  }

  /// Faces of cut cells, each once; a neighbour that is not cut itself becomes so where its face is not open.
  void measure_faces() {
    std::vector<std::array<double, 6>> faces(cells_.size());
    parallel_for(static_cast<int>(cells_.size()), [&](int n, int) {
      Index3 const& cell = cells_[n].cell;
      for (int face = 0; face < 2 * domain_.dimensions(); ++face) {
        // The high face of one cell is the low one of the next, which measures it where it is cut.
        Index3 const next = face % 2 == 0 ? cell : grid::beside(cell, face / 2, 1);
        if (face % 2 == 1 && find(next) != none) continue;
        faces[n][face] = bodies_.open_face(next, face / 2);
      }
    });
    for (std::size_t n = 0; n < faces.size(); ++n) {
      for (int face = 0; face < 2 * domain_.dimensions(); ++face) {
        std::size_t const other = face % 2 == 1 ? find(grid::beside(cells_[n].cell, face / 2, 1)) : none;
        cells_[n].open_faces[face] = other != none ? faces[other][face - 1] : faces[n][face];
      }
    }
    share_faces();
  }

  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  [[nodiscard]] std::size_t find(Index3 const& cell) const {
    if (!all_.contains(cell)) return none;
    auto const found = number_.find(all_.offset(cell));
    return found == number_.end() ? none : found->second;
  }

  /// Neighbours see no more of a face than the other: one that is not cut itself becomes so where its face is not open.
  void share_faces() {
    for (std::size_t n = 0; n < cells_.size(); ++n) {
      for (int face = 0; face < 2 * domain_.dimensions(); ++face) {
        Index3 const beside = grid::beside(cells_[n].cell, face / 2, face % 2);
        if (is_solid(beside)) cells_[n].open_faces[face] = 0.0;
        if (!all_.contains(beside) || is_solid(beside)) continue;
        if (find(beside) == none && cells_[n].open_faces[face] < 1.0) {
          CutCell whole;
          whole.cell = beside;
          whole.open_faces.fill(1.0);
          number_[all_.offset(beside)] = cells_.size();
          cells_.push_back(whole);
        }
        std::size_t const other = find(beside);
        if (other == none) continue;
        double& own = cells_[n].open_faces[face];
        double& theirs = cells_[other].open_faces[face ^ 1];
        own = theirs = std::min(own, theirs);
      }
    }
  }

  void keep_largest_pieces() {
    std::vector<Piece> pieces(cells_.size());
    parallel_for(static_cast<int>(cells_.size()), [&](int n, int) {
      if (domain_.dimensions() == 1 || cells_[n].open >= 1.0 || bodies_.links(cells_[n].cell).connected()) return;
      pieces[n] = largest_piece(shapes_, domain_, cells_[n].cell);
    });
    for (std::size_t n = 0; n < pieces.size(); ++n) {
      if (!pieces[n].parted) continue;
      CutCell& cut = cells_[n];
      result_.parted.push_back(cut.cell);
      cut.open *= pieces[n].volume;
      cut.open_section *= pieces[n].volume;
      for (int face = 0; face < 2 * domain_.dimensions(); ++face) {
        std::size_t const other = find(grid::beside(cut.cell, face / 2, face % 2));
        bool const both = other < pieces.size() && pieces[other].parted;
        double& open = cut.open_faces[face];
        open *= common_part(pieces[n].faces[face], both ? &pieces[other].faces[face ^ 1] : nullptr);
        if (open < sliver) open = 0.0;
      }
    }
    share_faces();
  }

  /// Cells that are left with too little, or with no open face, become solid, and close those of their neighbours.
  void close_solid() {
    for (bool changed = true; changed;) {
      changed = false;
      for (CutCell& cut : cells_) {
        if (is_solid(cut.cell)) continue;
        bool const shut =
            std::all_of(cut.open_faces.begin(), cut.open_faces.end(), [](double open) { return open == 0.0; });
        if (!shut && cut.open >= least_open) continue;
        result_.solid[all_.offset(cut.cell)] = 1;
        changed = true;
      }
      if (changed) share_faces();
    }
  }

  /// Is a cell no other than one that no surface cuts, beside solid ones at most?
  [[nodiscard]] bool is_whole(CutCell const& cut) const {
    if (cut.open < 1.0 - sliver) return false;
    for (int face = 0; face < 2 * domain_.dimensions(); ++face) {
      Index3 const beside = grid::beside(cut.cell, face / 2, face % 2);
      if (cut.open_faces[face] < 1.0 && !is_solid(beside)) return false;
    }
    return true;
  }

  void collect() {
    for (CutCell const& cut : cells_) {
      if (!is_solid(cut.cell) && !is_whole(cut)) result_.cells.push_back(cut);
    }
    std::sort(result_.cells.begin(), result_.cells.end(),
              [this](CutCell const& a, CutCell const& b) { return all_.offset(a.cell) < all_.offset(b.cell); });
  }

  std::vector<Shape> const& shapes_;
  grid::Domain domain_;
  CellRange all_;
  BodiesAlongAxes bodies_;
  std::vector<CutCell> cells_;
  Numbers number_;
  CutGeometry result_;
};

}  // namespace

CutGeometry cut_cells(std::vector<Shape> const& shapes, grid::Domain const& domain) {
  return cut_cells(shapes, domain, domain.all_cells());
}

CutGeometry cut_cells(std::vector<Shape> const& shapes, grid::Domain const& domain, grid::CellRange const& range) {
  if (shapes.empty()) return {};
  return Cutter(shapes, domain, range).run();
}

}  // namespace brisance::shape
