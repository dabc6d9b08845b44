#!/usr/bin/env bash
# p4est 2.2 (Debian 12, libp4est-dev 2.2-3): p4est_balance(..., P4EST_CONNECT_FACE, ...) leaves a forest unbalanced
# across faces when the connectivity names no corners, although faces are all that it has to look across. Four squares
# meet in a point; one is refined to level 5 there. With the corner in the connectivity the square across the point is
# refined to level 3. Without it that square stays whole, level 0 beside level 4 across a common face, and
# p4est_is_balanced(P4EST_CONNECT_FACE), called next, says so. p4est_connectivity_is_valid accepts both, and
# nothing warns.
#
# Why it matters: dimensionally split schemes and finite volumes need the balance across faces only, and whoever writes
# the connectivity of a block-structured mesh by hand leaves out the corners then: the header provides for a number of 0.
# The balance is then wrong where a shock or a crack runs through the common point of four blocks and nowhere else: a
# coarse cell gets more fine neighbours than the code has room for. Connectivities of p4est_connectivity_new_brick have
# their corners.
#
# Output seen (the number of quadrants and the deepest level in each of the four squares):
#   with the corner: valid 1, balanced 1; 16 (5) 13 (4) 13 (4) 10 (3)
#   without it: valid 1, balanced 0; 16 (5) 13 (4) 13 (4) 1 (0)
#
# Needs a C compiler.
set -euo pipefail

mpi=4.1.4-3+b1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

apt-get download -qq libp4est-dev=2.2-3 libp4est-2.2=2.2-3 libp4est-sc-2.2=2.2-3 "libopenmpi-dev=$mpi" \
  "libopenmpi3=$mpi" openmpi-common libhwloc15=2.9.0-1 libblas3=3.11.0-2 liblapack3=3.11.0-2 libgfortran5 libquadmath0 libevent-core-2.1-7 \
  libevent-pthreads-2.1-7 libpmix2 2>/dev/null
for package in ./*.deb; do dpkg -x "$package" unpacked; done
libraries=$PWD/unpacked/usr/lib/x86_64-linux-gnu
export LD_LIBRARY_PATH="$libraries:$libraries/blas:$libraries/lapack:$libraries/openmpi/lib:$libraries/pmix2/lib"
export OPAL_PREFIX="$libraries/openmpi" OPAL_PKGLIBDIR="$libraries/openmpi/lib/openmpi3"
export OPAL_PKGDATADIR="$PWD/unpacked/usr/share/openmpi"
export OMPI_MCA_ess_singleton_isolated=1 OMPI_MCA_btl=self OMPI_MCA_pml=ob1

cat >balance.c <<'END'
#include <p4est.h>
#include <p4est_extended.h>
#include <stdio.h>
#include <string.h>

static p4est_connectivity_t *four_squares(int with_corner) {
  p4est_connectivity_t *brick = p4est_connectivity_new_brick(2, 2, 0, 0);
  if (with_corner) return brick;
  p4est_connectivity_t *faces = p4est_connectivity_new(brick->num_vertices, 4, 0, 0);
  memcpy(faces->vertices, brick->vertices, 3 * (size_t)brick->num_vertices * sizeof(double));
  memcpy(faces->tree_to_vertex, brick->tree_to_vertex, 16 * sizeof(p4est_topidx_t));
  memcpy(faces->tree_to_tree, brick->tree_to_tree, 16 * sizeof(p4est_topidx_t));
  memcpy(faces->tree_to_face, brick->tree_to_face, 16);
  p4est_connectivity_destroy(brick);
  return faces;
}

/* The first square, towards the common point. */
static int towards_point(p4est_t *forest, p4est_topidx_t tree, p4est_quadrant_t *q) {
  (void)forest;
  const p4est_qcoord_t length = P4EST_QUADRANT_LEN(q->level);
  return tree == 0 && q->level < 5 && q->x + length == P4EST_ROOT_LEN && q->y + length == P4EST_ROOT_LEN;
}

int main(int argc, char **argv) {
  sc_MPI_Init(&argc, &argv);
  sc_init(sc_MPI_COMM_SELF, 0, 0, NULL, SC_LP_ERROR);
  p4est_init(NULL, SC_LP_ERROR);
  for (int with_corner = 1; with_corner >= 0; --with_corner) {
    p4est_connectivity_t *squares = four_squares(with_corner);
    p4est_t *forest = p4est_new(sc_MPI_COMM_SELF, squares, 0, NULL, NULL);
    p4est_refine(forest, 1, towards_point, NULL);
    p4est_balance(forest, P4EST_CONNECT_FACE, NULL);
    printf("%s: valid %d, balanced %d;", with_corner ? "with the corner" : "without it",
           p4est_connectivity_is_valid(squares), p4est_is_balanced(forest, P4EST_CONNECT_FACE));
    for (p4est_topidx_t t = 0; t < 4; ++t) {
      p4est_tree_t *tree = p4est_tree_array_index(forest->trees, t);
      printf(" %d (%d)", (int)tree->quadrants.elem_count, (int)tree->maxlevel);
    }
    printf("\n");
    p4est_destroy(forest);
    p4est_connectivity_destroy(squares);
  }
  sc_MPI_Finalize();
  return 0;
}
END
cc -Iunpacked/usr/include -Iunpacked/usr/lib/x86_64-linux-gnu/openmpi/include balance.c -o balance \
  -L"$libraries" -L"$libraries/openmpi/lib" -Wl,-rpath-link,"$LD_LIBRARY_PATH" \
  -Wl,--unresolved-symbols=ignore-in-shared-libs -lp4est -lsc -lmpi
./balance | tee seen.txt

cat >expected.txt <<'END'
with the corner: valid 1, balanced 1; 16 (5) 13 (4) 13 (4) 10 (3)
without it: valid 1, balanced 0; 16 (5) 13 (4) 13 (4) 1 (0)
END
if ! cmp -s seen.txt expected.txt; then
  echo "The behaviour has changed." >&2
  exit 1
fi
