#include "grid/forest_p4est.hpp"

#ifdef BRISANCE_FOREST
#include <p4est_bits.h>
#include <p4est_extended.h>
#include <p4est_io.h>
#include <p8est_bits.h>
#include <p8est_extended.h>
#include <p8est_io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

#if defined(__SANITIZE_ADDRESS__)
#define BRISANCE_LEAK_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define BRISANCE_LEAK_SANITIZER
#endif
#endif
#ifdef BRISANCE_LEAK_SANITIZER
#include <sanitizer/lsan_interface.h>
#endif
#endif

namespace brisance::grid {

#ifdef BRISANCE_FOREST

namespace {

/// MPI never frees a part of what it allocates for itself: the leak sanitizer skips it.
#ifdef BRISANCE_LEAK_SANITIZER
using OwnedByMpi = __lsan::ScopedDisabler;
#else
struct OwnedByMpi {};
#endif

/// p4est computes nothing without MPI. The forest is that of one process, which starts MPI when it first refines.
class Library {
 public:
  Library() {
    [[maybe_unused]] OwnedByMpi const memory;
    int running = 0;
    MPI_Initialized(&running);
    if (running == 0) {
      prepare_single_process();
      MPI_Init(nullptr, nullptr);
      started_ = true;
    }
    sc_init(sc_MPI_COMM_SELF, 0, 0, nullptr, SC_LP_ERROR);
    p4est_init(nullptr, SC_LP_ERROR);
  }
  ~Library() {
    [[maybe_unused]] OwnedByMpi const memory;
    int ended = 0;
    MPI_Finalized(&ended);
    if (started_ && ended == 0) MPI_Finalize();
  }
  Library(Library const&) = delete;
  Library& operator=(Library const&) = delete;

 private:
  /// Without mpirun, Open MPI looks for networks and starts a daemon, which needs ssh: 0.4 s, and the end of the
  /// program where there is no ssh. A process that is alone needs neither; settings of the user come first.
  static void prepare_single_process() {
    if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) return;
    constexpr int keep = 0;
    setenv("OMPI_MCA_ess_singleton_isolated", "1", keep);
    setenv("OMPI_MCA_pml", "ob1", keep);
    setenv("OMPI_MCA_btl", "self", keep);
    setenv("OMPI_MCA_coll", "self,basic,libnbc,inter,sync", keep);
  }

  bool started_ = false;
};

/// The names of the library in 2D, where its trees are quadtrees, and in 3D.
struct Quadtrees {
  static constexpr int dimensions = 2;
  static constexpr int deepest = P4EST_MAXLEVEL;
  using Trees = p4est_t;
  using Tree = p4est_tree_t;
  using Connectivity = p4est_connectivity_t;
  using Block = p4est_quadrant_t;
  static Connectivity* brick(Index3 const& n, std::array<bool, 3> const& periodic) {
    return p4est_connectivity_new_brick(n[0], n[1], periodic[0] ? 1 : 0, periodic[1] ? 1 : 0);
  }
  static void balance(Trees* trees) { p4est_balance(trees, P4EST_CONNECT_FULL, nullptr); }
  static constexpr auto permute = p4est_connectivity_permute;
  static constexpr auto disconnect = p4est_connectivity_destroy;
  static constexpr auto make = p4est_inflate;
  static constexpr auto refine = p4est_refine;
  static constexpr auto coarsen = p4est_coarsen;
  static constexpr auto destroy = p4est_destroy;
};

struct Octrees {
  static constexpr int dimensions = 3;
  static constexpr int deepest = P8EST_MAXLEVEL;
  using Trees = p8est_t;
  using Tree = p8est_tree_t;
  using Connectivity = p8est_connectivity_t;
  using Block = p8est_quadrant_t;
  static Connectivity* brick(Index3 const& n, std::array<bool, 3> const& periodic) {
    return p8est_connectivity_new_brick(n[0], n[1], n[2], periodic[0] ? 1 : 0, periodic[1] ? 1 : 0,
                                        periodic[2] ? 1 : 0);
  }
  static void balance(Trees* trees) { p8est_balance(trees, P8EST_CONNECT_FULL, nullptr); }
  static constexpr auto permute = p8est_connectivity_permute;
  static constexpr auto disconnect = p8est_connectivity_destroy;
  static constexpr auto make = p8est_inflate;
  static constexpr auto refine = p8est_refine;
  static constexpr auto coarsen = p8est_coarsen;
  static constexpr auto destroy = p8est_destroy;
};

/// What a callback sees of the call: the level beyond which nothing is refined.
struct Limits {
  int most_level = 0;
};

struct ArrayDeleter {
  void operator()(sc_array_t* array) const { sc_array_destroy(array); }
};
using ArrayPointer = std::unique_ptr<sc_array_t, ArrayDeleter>;
template <class Api>
struct ConnectivityDeleter {
  void operator()(typename Api::Connectivity* connectivity) const { Api::disconnect(connectivity); }
};
template <class Api>
struct TreesDeleter {
  void operator()(typename Api::Trees* trees) const { Api::destroy(trees); }
};
template <class Api>
using ConnectivityPointer = std::unique_ptr<typename Api::Connectivity, ConnectivityDeleter<Api>>;
template <class Api>
using TreesPointer = std::unique_ptr<typename Api::Trees, TreesDeleter<Api>>;

/// Blocks of level 0 are trees, numbered as leaves of a forest that has no others: trees in Morton order, and the
/// leaves of each in its own, are the order of the forest. A brick of the library has an order of its own, which is
/// known from the low corners of its trees. The balance needs to know trees that meet in corners and edges, too.
template <class Api>
ConnectivityPointer<Api> connect(Forest const& roots) {
  ConnectivityPointer<Api> connectivity(Api::brick(roots.parts(), roots.periodic()));
  std::size_t const count = roots.leaves().size();
  constexpr std::size_t corners = std::size_t{1} << Api::dimensions;
  ArrayPointer const numbers(sc_array_new_count(sizeof(std::size_t), count));
  for (std::size_t tree = 0; tree < count; ++tree) {
    double const* corner = connectivity->vertices + std::ptrdiff_t{3} * connectivity->tree_to_vertex[corners * tree];
    Leaf root;
    for (int d = 0; d < Api::dimensions; ++d) root.place[d] = static_cast<int>(std::lround(corner[d]));
    reinterpret_cast<std::size_t*>(numbers->array)[tree] = static_cast<std::size_t>(roots.find(root));
  }
  constexpr int to_new = 1;
  Api::permute(connectivity.get(), numbers.get(), to_new);
  return connectivity;
}

/// The tree of a leaf.
Leaf root_of(Leaf const& leaf) {
  Leaf root;
  for (int d = 0; d < 3; ++d) root.place[d] = leaf.place[d] >> leaf.level;
  return root;
}

template <class Api>
TreesPointer<Api> plant(Forest const& forest, Forest const& roots, typename Api::Connectivity* connectivity,
                        Limits& limits) {
  std::vector<Leaf> const& leaves = forest.leaves();
  std::vector<p4est_gloidx_t> before(roots.leaves().size() + 1, 0);  // leaves before each tree
  constexpr std::size_t numbers = Api::dimensions + 1;               // of a leaf: its low corner and its level
  ArrayPointer const places(sc_array_new_count(sizeof(p4est_qcoord_t), numbers * leaves.size()));
  auto* place = reinterpret_cast<p4est_qcoord_t*>(places->array);
  for (Leaf const& leaf : leaves) {
    Leaf const root = root_of(leaf);
    ++before[static_cast<std::size_t>(roots.find(root)) + 1];
    for (int d = 0; d < Api::dimensions; ++d) {
      *place++ = (leaf.place[d] - (root.place[d] << leaf.level)) << (Api::deepest - leaf.level);
    }
    *place++ = leaf.level;
  }
  for (std::size_t tree = 1; tree < before.size(); ++tree) before[tree] += before[tree - 1];
  std::array<p4est_gloidx_t, 2> const of_process{0, before.back()};
  return TreesPointer<Api>(
      Api::make(sc_MPI_COMM_SELF, connectivity, of_process.data(), before.data(), places.get(), nullptr, &limits));
}

/// Calls visit(tree, block) for all blocks, in order.
template <class Api, class Visit>
void for_each_block(typename Api::Trees& trees, Visit&& visit) {
  for (std::size_t t = 0; t < trees.trees->elem_count; ++t) {
    auto& tree = reinterpret_cast<typename Api::Tree*>(trees.trees->array)[t];
    auto* const blocks = reinterpret_cast<typename Api::Block*>(tree.quadrants.array);
    for (std::size_t b = 0; b < tree.quadrants.elem_count; ++b) visit(t, blocks[b]);
  }
}

/// Blocks carry their mark; new ones carry none.
template <class Api>
std::vector<Leaf> adapted(Forest const& forest, std::vector<std::int8_t> const& marks, int most_level) {
  using Trees = typename Api::Trees;
  using Block = typename Api::Block;
  Limits limits{most_level};
  Forest const roots(forest.parts(), forest.dimensions(), forest.periodic());
  ConnectivityPointer<Api> const connectivity = connect<Api>(roots);
  TreesPointer<Api> const trees = plant<Api>(forest, roots, connectivity.get(), limits);

  std::size_t next = 0;
  for_each_block<Api>(*trees, [&](std::size_t, Block& block) { block.p.user_int = int{marks[next++]}; });
  constexpr int once = 0;
  auto const unmarked = [](Trees*, p4est_topidx_t, Block* block) { block->p.user_int = 0; };
  auto const wants_more = [](Trees* all, p4est_topidx_t, Block* block) -> int {
    return block->p.user_int > 0 && block->level < static_cast<Limits const*>(all->user_pointer)->most_level ? 1 : 0;
  };
  auto const wants_less = [](Trees*, p4est_topidx_t, Block** family) -> int {
    constexpr int size = 1 << Api::dimensions;
    return std::all_of(family, family + size, [](Block const* block) { return block->p.user_int < 0; }) ? 1 : 0;
  };
  Api::refine(trees.get(), once, wants_more, unmarked);
  Api::coarsen(trees.get(), once, wants_less, unmarked);
  Api::balance(trees.get());

  std::vector<Leaf> leaves;
  leaves.reserve(static_cast<std::size_t>(trees->local_num_quadrants));
  for_each_block<Api>(*trees, [&](std::size_t tree, Block const& block) {
    Leaf leaf{block.level};
    int const shift = Api::deepest - block.level;
    std::array<p4est_qcoord_t, 3> corner{block.x, block.y, 0};
    if constexpr (Api::dimensions == 3) corner[2] = block.z;
    for (int d = 0; d < Api::dimensions; ++d) {
      leaf.place[d] = (roots.leaves()[tree].place[d] << block.level) + (corner[d] >> shift);
    }
    leaves.push_back(leaf);
  });
  return leaves;
}

}  // namespace

std::vector<Leaf> leaves_by_p4est(Forest const& forest, std::vector<std::int8_t> const& marks, int most_level) {
  static Library const library;
  return forest.dimensions() == 2 ? adapted<Quadtrees>(forest, marks, most_level)
                                  : adapted<Octrees>(forest, marks, most_level);
}

bool Forest::can_refine(int dimensions) { return dimensions > 1; }

std::string Forest::library() { return "p4est " P4EST_VERSION; }

#else

std::vector<Leaf> leaves_by_p4est(Forest const& forest, std::vector<std::int8_t> const& /*marks*/, int /*most_level*/) {
  return forest.leaves();
}

bool Forest::can_refine(int /*dimensions*/) { return false; }

std::string Forest::library() { return {}; }

#endif

}  // namespace brisance::grid
